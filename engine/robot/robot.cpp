#include "engine/robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

constexpr std::size_t kEdgesMax = 256;  // in a millisecond: Edges has room for as many

/// To R of a vector in B.
Vector3d in_R(const Vector3d& v_B) {
  return {v_B.x(), -v_B.z(), v_B.y()};
}

/// The board's divider makes another rate of the line's than its name says: 117,647 baud for 115,200.
constexpr std::uint32_t kBoardBaud = 10 * firmware::kClockHz / firmware::kCyclesPerByte;

SerialLineSettings to_board(SerialLineSettings line) {
  line.receiver_baud = kBoardBaud;
  return line;
}
SerialLineSettings from_board(SerialLineSettings line) {
  line.receiver_baud = line.baud;
  line.baud = kBoardBaud;
  return line;
}

PlanarPose planar(const BaseEstimate::Place& place) {
  return {place[0], place[1], place[2]};
}

}  // namespace

Pose base_in_world(const PlanarPose& pose, const Vector3d& p_RB) {
  const double c = pinned::cos(pose.theta), s = pinned::sin(pose.theta);
  const double x = pose.x + c * p_RB.x() - s * p_RB.y(), y = pose.y + s * p_RB.x() + c * p_RB.y();
  return {{x, p_RB.z(), -y}, rotation_from_vector({0, pose.theta, 0})};
}

Robot::Robot(RobotSettings settings, std::unique_ptr<firmware::Board> board)
    : settings_(std::move(settings)),
      board_(std::move(board)),
      plant_(settings_.plant),
      down_(to_board(settings_.line), settings_.seed, settings_.name + " to robot"),
      up_(from_board(settings_.line), settings_.seed, settings_.name + " from robot"),
      tracker_(settings_.tracker, settings_.seed, settings_.name + " tracker"),
      estimate_(place_of(settings_.start), settings_.estimate),
      pilot_(settings_.pilot),
      slip_({}, kCountsPerWheelTurn, kMillisecond) {
  VERISIM_ASSERT(board_ != nullptr);
  edges_.reserve(kEdgesMax);
  plant_.place(settings_.start);
  pilot_.start();
  place_device(0);
}

void Robot::follow(double error_x, double error_z) {
  error_D_ = {error_x, -error_z};
}

void Robot::load(const Wrench& wrench) {
  load_B_ += wrench;
}

void Robot::unplug(bool is_unplugged) {
  down_.plug(!is_unplugged);
  up_.plug(!is_unplugged);
}

void Robot::set_powered(bool on) {
  board_->set_powered(on);
  plant_.set_supplied(on);
}

void Robot::advance(double t) {
  VERISIM_ASSERT(std::isfinite(t));
  ++loads_;
  const auto due = static_cast<std::uint64_t>(t / kMillisecond + 1e-6);
  if (done_ < due) take_load();
  for (; done_ < due; ++done_) millisecond();
  estimate_.advance(t);
  place_device(t);
}

void Robot::hear_tracker() {
  const TrackedBase& tracked = tracker_.advance(plant_.state().pose);
  const double now = static_cast<double>(done_ + 1) * kMillisecond;
  if (tracked.is_new) estimate_.hear(place_of(tracked.pose), now - tracked.age);
}

void Robot::take_load() {
  const double each = 1.0 / std::exchange(loads_, 0);
  reaction_ = {each * in_R(load_B_.force), each * in_R(load_B_.torque), settings_.device};
  load_B_ = {};
}

void Robot::millisecond() {
  hear_tracker();
  const auto& [neutral_x, neutral_y] = settings_.pilot.drive.neutral_D;
  const std::array<double, 2> p_D{neutral_x + error_D_[0], neutral_y + error_D_[1]};
  down_.send(pilot_.advance(p_D, head_ ? head_() : std::nullopt, tracker_.tracked()));
  board_->advance(edges_, down_.advance());
  up_.send(board_->sent());
  pilot_.receive(up_.advance());
  const std::span<const Edge> edges = plant_.advance(board_->duty(), reaction_);
  edges_.assign(edges.begin(), edges.end());
  slipping_.see(slip_.advance(plant_.state().counts), done_);
  const std::array<double, 2> limit_R = pilot_.limit_force_R();
  limit_B_ = {limit_R[0], 0, -limit_R[1]};
}

void Robot::place_device(double t) {
  const PlantState& state = plant_.state();
  const double ahead = t - static_cast<double>(done_) * kMillisecond;
  const double c = pinned::cos(state.pose.theta), s = pinned::sin(state.pose.theta);
  const PlanarTwist& v = state.twist;
  const PlanarPose now{state.pose.x + ahead * (c * v.vx - s * v.vy), state.pose.y + ahead * (s * v.vx + c * v.vy),
                       state.pose.theta + ahead * v.omega};
  X_WB_ = base_in_world(now, settings_.device);
  tracked_X_WB_ = base_in_world(planar(estimate_.place()), settings_.device);
}

void Robot::report(PartNotes& notes) {
  pilot_.report(notes);
  down_.report(notes);
  up_.report(notes);
  tracker_.report(notes);
  slipping_.report(notes);
}

void Robot::declare(Columns& columns) const {
  const std::string state = "/state/robot/" + name() + "/", cost = "/cost/robot/" + name() + "/";
  const auto three = [](const PlanarPose& p) { return std::array{p.x, p.y, p.theta}; };
  columns.add(state + "pose", "m, m, rad", "middle of the wheels on the floor: x, y (the world's -z), heading",
              [this, three] { return three(plant_.state().pose); });
  columns.add(state + "tracked_pose", "m, m, rad", "the same, as the tracker and the estimate from it say",
              [this] { return estimate_.place(); });
  columns.add(state + "tracked", "1", "1: the tracker's last report is not too old",
              [this] { return tracker_.tracked().is_valid; });
  columns.add(state + "error", "m",
              "of the handle from its neutral place, times the device's gain; the robot's x and y",
              [this] { return pilot_.error_R(); });
  columns.add(state + "command", "m/s, m/s, rad/s", "asked of the robot by its server; the robot's x, y, rotation",
              [this] {
                return std::array{pilot_.server().in_force().vx, pilot_.server().in_force().vy,
                                  pilot_.server().in_force().omega};
              });
  columns.add(state + "setpoint", "rpm", "of the motors, as the robot reported last: FL, FR, RL, RR", [this] {
    std::array<double, kWheels> all{};
    for (std::size_t i = 0; i < kWheels; ++i) all[i] = pilot_.server().telemetry().setpoint[i];
    return all;
  });
  columns.add(state + "wheel_velocity", "rad/s", "of the wheels: FL, FR, RL, RR",
              [this] { return plant_.state().wheel_speed; });
  columns.add(state + "pwm", "1", "what the motors are driven by, -255 to 255", [this] {
    std::array<double, kWheels> all{};
    for (std::size_t i = 0; i < kWheels; ++i) all[i] = board_->duty()[i];
    return all;
  });
  columns.add(state + "encoder", "1", "counts of the motors' encoders, 3072 a turn of the wheel", [this] {
    std::array<double, kWheels> all{};
    for (std::size_t i = 0; i < kWheels; ++i) all[i] = static_cast<double>(plant_.state().counts[i]);
    return all;
  });
  columns.add(state + "slip", "m/s", "of each wheel's roller on the floor, along the roller's axle",
              [this] { return plant_.state().slip; });
  columns.add(state + "slips", "1", "1: the four wheels' speeds fit no motion of the base",
              [this] { return slipping_.is_on(); });
  columns.add(state + "supply", "V", "of the battery under load", [this] { return plant_.state().supply_voltage; });
  if (pilot_.walls()) {
    columns.add(state + "room_left", "m",
                "in front of the nearest wall, less what the base may have gone since; -100: nothing is known",
                [this] { return std::max(-100.0, pilot_.walls()->room_left()); });
    columns.add(state + "held_back", "1", "1: walls allow less than was asked for",
                [this] { return pilot_.walls()->is_limiting(); });
  }
  columns.add(cost + "tipping", "1", "substeps of the plant in which a wheel carried nothing, since the beginning",
              [this] { return plant_.tipping(); });
  columns.add(cost + "unsettled", "1", "substeps in which the wheels' forces found no end, since the beginning",
              [this] { return plant_.unsettled(); });
  columns.add(cost + "edges_left_out", "1", "edges of the encoders for which there was no room, since the beginning",
              [this] { return plant_.edges_dropped(); });
  columns.add(cost + "busy_cycles", "1", "of the board's processor since the beginning; host: 0",
              [this] { return board_->load().busy_cycles; });
  columns.add(cost + "edges_lost", "1", "of the encoders, by the board's processor",
              [this] { return board_->load().edges_lost; });
}

}  // namespace verisim::robot

#include "engine/robot/robot_server.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

namespace {

std::uint64_t milliseconds(const char* what, double s, double least) {
  if (!(s >= least && s <= 3600))
    fail(ErrorKind::input, "robot server: {} is {} s but must be from {} to 3600", what, s, least);
  return static_cast<std::uint64_t>(std::llround(s * 1000));
}

bool are_finite(const PlanarTwist& v) {
  return std::isfinite(v.vx) && std::isfinite(v.vy) && std::isfinite(v.omega);
}

}  // namespace

std::int16_t to_wire(double velocity) {
  VERISIM_ASSERT(!std::isnan(velocity));
  constexpr double kMost = std::numeric_limits<std::int16_t>::max(), kLeast = std::numeric_limits<std::int16_t>::min();
  return static_cast<std::int16_t>(std::clamp(std::round(velocity * 1000), kLeast, kMost));
}

RobotServer::RobotServer(const RobotServerSettings& settings)
    : settings_(settings),
      send_ms_(milliseconds("send_period", settings.send_period, 0.001)),
      watchdog_ms_(milliseconds("watchdog", settings.watchdog, 0.001)),
      start_ms_(milliseconds("start_period", settings.start_period, 0.001)),
      silence_ms_(milliseconds("silence", settings.silence, 0.001)),
      gain_(settings.gain) {
  if (!is_not_negative(settings.gain))
    fail(ErrorKind::input, "robot server: gain is {} but must be a finite number, 0 or above; 5 is usual",
         settings.gain);
  if (!is_positive(settings.wheel_speed))
    fail(ErrorKind::input, "robot server: wheel_speed is {} rad/s but must be above 0; 11.45 is usual",
         settings.wheel_speed);
}

void RobotServer::forget() {
  good_ = in_force_ = {};
  gain_ = settings_.gain;
  counts_.rejected += receiver_.received().rejected;
  receiver_ = {};
  telemetry_ = {};
  has_heard_ = false;
  reaches_limit_ = false;
  ignored_ms_ = obeyed_ms_ = 0;
  attempts_ = 0;
}

void RobotServer::start() {
  forget();
  is_running_ = true;
  started_at_ = good_at_ = in_force_at_ = heard_at_ = now_;
}

void RobotServer::stop() {
  ends_ = is_running_;
  kill();
}

void RobotServer::kill() {
  is_running_ = false;
  forget();
}

void RobotServer::set_gain(double gain) {
  if (is_not_negative(gain))
    gain_ = gain;
  else
    ++counts_.refused;
}

PlanarTwist RobotServer::within_reach(const PlanarTwist& velocity) const {
  VERISIM_ASSERT(are_finite(velocity));
  // The fastest wheel's rim [m/s]: no infinity on the way, whatever the velocity.
  const double arm = settings_.geometry.half_base + settings_.geometry.half_track;
  const double largest = std::max({std::abs(velocity.vx), std::abs(velocity.vy), arm * std::abs(velocity.omega)});
  if (largest == 0) return velocity;
  const double sum =
      std::abs(velocity.vx) / largest + std::abs(velocity.vy) / largest + arm * (std::abs(velocity.omega) / largest);
  const double scale = settings_.wheel_speed * settings_.geometry.wheel_radius / sum / largest;
  if (scale >= 1) return velocity;
  return {velocity.vx * scale, velocity.vy * scale, velocity.omega * scale};
}

PlanarTwist RobotServer::wanted(double error_x, double error_y) {
  if (!is_running_) return {};
  const PlanarTwist velocity{gain_ * error_x, gain_ * error_y, 0};
  if (are_finite(velocity)) {
    good_ = within_reach(velocity);
    good_at_ = now_;
    reaches_limit_ = good_.vx != velocity.vx || good_.vy != velocity.vy;
    if (reaches_limit_) ++counts_.saturated;
  } else {
    ++counts_.refused;
  }
  return is_expired(good_at_) ? PlanarTwist() : good_;
}

void RobotServer::command(const PlanarTwist& velocity) {
  if (!is_running_) return;
  if (!are_finite(velocity)) {
    ++counts_.refused;
    return;
  }
  in_force_ = within_reach(velocity);
  in_force_at_ = now_;
  if (in_force_.vx == velocity.vx && in_force_.vy == velocity.vy && in_force_.omega == velocity.omega) return;
  reaches_limit_ = true;
  ++counts_.saturated;
}

template <typename Message>
void RobotServer::put(const Message& message) {
  out_count_ += protocol::encode<protocol::ComputerToRobot>(message, out_.data() + out_count_);
  ++counts_.frames;
}

/// Counts how long the robot's setpoints have been 0 against the command.
bool RobotServer::must_start_again() {
  constexpr double kMoves = 0.02;  // rad/s of a wheel, 12 RPM of its motor: no rounding on the way makes 0 of it
  constexpr std::uint64_t kObeyed = 2000;  // ms
  double fastest = 0;
  for (const double speed : wheel_speeds(settings_.geometry, in_force_)) fastest = std::max(fastest, std::abs(speed));
  const bool is_told = fastest > kMoves && has_heard_ && now_ - heard_at_ < silence_ms_;
  const bool stands = telemetry_.setpoint == std::array<std::int16_t, kWheels>{};
  ignored_ms_ = is_told && stands ? ignored_ms_ + 1 : 0;
  if (stands) obeyed_ms_ = 0;
  if (!stands && ++obeyed_ms_ >= kObeyed) attempts_ = 0;
  if (ignored_ms_ < start_ms_ || attempts_ >= settings_.start_attempts) return false;
  ignored_ms_ = 0;
  ++attempts_;
  return true;
}

std::span<const std::uint8_t> RobotServer::advance() {
  out_count_ = 0;
  if (ends_) put(protocol::EndControl{});
  ends_ = false;
  if (is_running_) {
    const bool is_over = is_expired(in_force_at_) || is_expired(good_at_);
    if (is_over) in_force_ = {};
    if (is_over && !expired_.is_on()) ++counts_.expired;
    const std::uint64_t age = now_ - started_at_;
    const bool starts = must_start_again() || age == 0;
    if (starts) put(protocol::StartControl{});
    counts_.starts += starts ? 1 : 0;
    if (age % send_ms_ == 0) put(Velocity{to_wire(in_force_.vx), to_wire(in_force_.vy), to_wire(in_force_.omega)});
    expired_.see(is_over, now_);
    ignored_.see(ignored_ms_ >= start_ms_ || attempts_ > 0, now_);
    silent_.see(now_ - heard_at_ >= silence_ms_, now_);
    saturated_.see(reaches_limit_, now_);
  }
  running_.see(is_running_, now_);
  refusing_.see(counts_.refused > refused_seen_, now_);
  refused_seen_ = counts_.refused;
  reaches_limit_ = false;
  ++now_;
  return {out_.data(), out_count_};
}

void RobotServer::receive(std::span<const TimedByte> bytes) {
  if (!is_running_) return;
  struct Handler {
    RobotServer& server;
    void operator()(const protocol::CurrentWheelSetpoints& m) { server.telemetry_.setpoint = std::to_array(m.wheels); }
    void operator()(const protocol::CurrentWheelVelocities& m) { server.telemetry_.velocity = std::to_array(m.wheels); }
    void operator()(const protocol::CurrentPWMOutput& m) { server.telemetry_.pwm = std::to_array(m.wheels); }
  } handler{*this};
  const std::uint32_t before = receiver_.received().accepted;
  for (const TimedByte& byte : bytes) receiver_.feed(&byte.value, 1, handler);
  const std::uint32_t accepted = receiver_.received().accepted - before;
  counts_.reports += accepted;
  if (accepted == 0) return;
  heard_at_ = now_;
  has_heard_ = true;
}

Telemetry RobotServer::telemetry() const {
  Telemetry now = telemetry_;
  now.age = has_heard_ ? static_cast<double>(now_ - heard_at_) / 1000 : std::numeric_limits<double>::infinity();
  return now;
}

std::optional<PlanarTwist> RobotServer::reported_command() const {
  constexpr double kPerRpm = pinned::kFullTurn / 60 / 64;  // rad/s of a wheel, through the gear
  if (!has_heard_ || now_ - heard_at_ > 100) return {};
  PerWheel speeds;
  for (std::size_t i = 0; i < kWheels; ++i) speeds[i] = kPerRpm * telemetry_.setpoint[i];
  return twist_of(settings_.geometry, speeds);
}

void RobotServer::report(RobotNotes& notes) {
  for (Spell* spell : {&running_, &refusing_, &expired_, &saturated_, &ignored_, &silent_}) spell->report(notes);
}

}  // namespace verisim::robot

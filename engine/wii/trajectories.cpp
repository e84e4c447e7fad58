#include "engine/wii/trajectories.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace verisim::wii {
namespace {

// Natural head motion (issue, item 3): depth 0.4 to 2 m with 0.11 to 0.9 Hz, sideways 0.1 to 1.3 Hz within 12 degrees
// of the axis, yaw 17, pitch 9, roll 13 degrees peak. Amplitudes fall with frequency, as a head's do.
constexpr std::array kDepth = {Sine{0.60, 0.11, 0.3}, Sine{0.16, 0.37, 1.1}, Sine{0.04, 0.90, 2.0}};  // about 1.2 m
constexpr std::array kSide = {Sine{6.0 * kDegree, 0.10, 0}, Sine{2.0 * kDegree, 0.43, 0.7},
                              Sine{0.5 * kDegree, 1.30, 1.9}};
constexpr std::array kHeight_ = {Sine{5.0 * kDegree, 0.13, 1.3}, Sine{1.5 * kDegree, 0.51, 0.2},
                                 Sine{0.4 * kDegree, 1.10, 2.3}};
constexpr std::array kYaw = {Sine{12 * kDegree, 0.17, 0.5}, Sine{5 * kDegree, 0.60, 1.7}};
constexpr std::array kPitch = {Sine{6 * kDegree, 0.14, 1.0}, Sine{3 * kDegree, 0.70, 0.4}};
constexpr std::array kRoll = {Sine{9 * kDegree, 0.12, 2.1}, Sine{4 * kDegree, 0.55, 0.9}};

constexpr int kTurnSamples = 200;
constexpr double kAside = 5 * kDegree;
/// Powers of the inverse root of x^5 = x + 1, as fractions of 2^64: the most even spread in four dimensions (Roberts
/// 2018).
constexpr std::array<std::uint64_t, 4> kStartSteps = {0xdb4f0b9175ae2165, 0xbbe0563303a4615f, 0xa0f2ec75a1fe1575,
                                                      0x89e182857d9ed688};

Situation level_remote(const Vector3d& p_L, const Quaterniond& R_LH = Quaterniond::Identity()) {
  return {.X_WR = {}, .X_WH = {p_L, R_LH}};
}

Situation natural(double t, bool with_yaw) {
  const double z = 1.2 + sum_of_sines(kDepth, t);
  const Vector3d p{z * pinned::tan(sum_of_sines(kSide, t)), z * pinned::tan(sum_of_sines(kHeight_, t)), z};
  return level_remote(
      p, head_rotation(with_yaw ? sum_of_sines(kYaw, t) : 0, sum_of_sines(kPitch, t), sum_of_sines(kRoll, t)));
}

/// At rest in each of 5 x 3 x 3 places. Dark for 0.15 s before and after each change, so that each is a new beginning.
constexpr int kGridX = 5;
constexpr int kGridY = 3;
constexpr int kGridZ = 3;
constexpr double kGridRest = 0.6;
constexpr double kGridDark = 0.15;
constexpr double kGridDuration = kGridX * kGridY * kGridZ * kGridRest;

Situation grid(double t) {
  const int cell = std::min(static_cast<int>(t / kGridRest), kGridX * kGridY * kGridZ - 1);
  const int column = cell % kGridX - kGridX / 2;
  const int row = cell / kGridX % kGridY - kGridY / 2;
  const int layer = cell / (kGridX * kGridY);
  const double z = 0.6 + 0.7 * layer;
  const double x = 0.1 * z * column;
  const double y = 0.12 * z * row;
  return level_remote({x, y, z});
}

/// Slow enough that a head without one LED can be guessed for half a second, as people do sit.
Situation seated(double t) {
  const std::array depth = {Sine{0.05, 0.15, 0}, Sine{0.01, 0.4, 1}};
  const std::array side = {Sine{0.06, 0.2, 0.4}, Sine{0.01, 0.7, 0}};
  const std::array up = {Sine{0.03, 0.17, 1.4}, Sine{0.005, 0.6, 0}};
  const std::array roll = {Sine{5 * kDegree, 0.2, 0.5}};
  return level_remote({sum_of_sines(side, t), sum_of_sines(up, t), 1 + sum_of_sines(depth, t)},
                      head_rotation(0, 0, sum_of_sines(roll, t)));
}

Situation far(double t) {
  Situation s = seated(t);
  s.X_WH.position.z() += 1;
  return s;
}

Situation tilted(double t) {
  const Vector3d p_R{0.12 * pinned::sin(2 * pinned::kPi * 0.2 * t), 0.05 * pinned::sin(2 * pinned::kPi * 0.31 * t), 1};
  const Pose X_WR = tilted_remote(20 * kDegree, 10 * kDegree);
  return {.X_WR = X_WR, .X_WH = {X_WR * p_R, Quaterniond::Identity()}};
}

/// The remote on a shaky stand: it sways by 4 degrees and shifts by 1 cm.
Situation moving_remote(double t) {
  const double w = 2 * pinned::kPi * 0.3;
  const double shift = 0.01 * pinned::sin(w * t);
  Situation s = level_remote({0.1, 0.05, 1.1});
  s.X_WR = tilted_remote(4 * kDegree * pinned::sin(w * t), 3 * kDegree * pinned::sin(0.7 * w * t));
  s.X_WR.position.x() = shift;
  s.acceleration_W.x() = -w * w * shift;
  return s;
}

Situation upside_down(double t) {
  Situation s = natural(t, false);
  s.X_WR = tilted_remote(0, pinned::kPi);
  return s;
}

/// Out of the image on one side, back, out on the other.
Situation edges(double t) {
  return level_remote({0.5 * pinned::sin(2 * pinned::kPi * 0.2 * t), 0.1 * pinned::sin(2 * pinned::kPi * 0.13 * t), 1});
}

std::vector<Outage> every_two_seconds(int led, double until) {
  std::vector<Outage> outages;
  for (double t = 1; t + 0.5 < until; t += 2) outages.push_back({led, t, t + 0.5});
  return outages;
}

std::vector<Outage> between_cells() {
  std::vector<Outage> outages;
  for (int cell = 0; cell < kGridX * kGridY * kGridZ; ++cell)
    outages.push_back({-1, cell * kGridRest - kGridDark, cell * kGridRest + kGridDark});
  return outages;
}

std::vector<Trajectory> make_trajectories() {
  const double pi2 = 2 * pinned::kPi;
  const auto sweep_x = [=](double t) { return level_remote({0.28 * pinned::sin(pi2 * 0.1 * t), 0, 1}); };
  const auto sweep_z = [=](double t) { return level_remote({0, 0, 1.2 - 0.8 * pinned::cos(pi2 * 0.1 * t)}); };
  return {
      {"static",
       "at rest, 1 m in front",
       5,
       [](double) {
         return level_remote({0, 0, 1});
       },
       {},
       {}},
      {"grid", "at rest in 45 places, 0.6 to 2 m", kGridDuration, grid, between_cells(), {}},
      {"sweep-x", "0.28 m to either side at 1 m", 10, sweep_x, {}, {}},
      {"sweep-z", "0.4 to 2 m in front", 10, sweep_z, {}, {}},
      {"far", "seated, 2 m in front", 20, far, {}, {}},
      {"natural", "natural motion, no yaw", 30, [](double t) { return natural(t, false); }, {}, {}},
      {"natural-yaw", "natural motion, with yaw", 30, [](double t) { return natural(t, true); }, {}, {}},
      {"edges", "out of view on either side", 20, edges, {}, {}},
      {"dropout-one", "seated, one LED dark for 0.5 s every 2 s", 20, seated, every_two_seconds(0, 20), {}},
      {"dropout-both", "seated, all LEDs dark for 0.5 s every 2 s", 20, seated, every_two_seconds(-1, 20), {}},
      {"swap",
       "natural, slots exchanged at 5 and 10 s",
       15,
       [](double t) { return natural(t, false); },
       {},
       {{5, 0, 1}, {10, 0, 1}}},
      {"upside-down", "natural, the remote lies on its buttons", 15, upside_down, {}, {}},
      {"tilted", "remote tilted by 20 and 10 degrees", 10, tilted, {}, {}},
      {"moving-remote", "the remote sways by 4 degrees", 20, moving_remote, {}, {}, true},
  };
}

}  // namespace

Pose tilted_remote(double pitch, double roll) {
  // v_L = Rx(-pitch) Rz(roll) v_R (reference/wii/README.md); without heading L is W.
  return {Vector3d::Zero(), rotation_from_vector({-pitch, 0, 0}) * rotation_from_vector({0, 0, roll})};
}

Quaterniond head_rotation(double yaw, double pitch, double roll) {
  return rotation_from_vector({0, 0, roll}) * rotation_from_vector({0, yaw, 0}) * rotation_from_vector({pitch, 0, 0});
}

double sum_of_sines(std::span<const Sine> sines, double t) {
  double sum = 0;
  for (const Sine& s : sines) sum += s.amplitude * pinned::sin(2 * pinned::kPi * s.frequency * t + s.phase);
  return sum;
}

Trajectory recorded_trajectory(const std::string& name, std::vector<double> t, std::vector<Pose> X_LH) {
  VERISIM_ASSERT(t.size() == X_LH.size());
  if (t.size() < 2) fail(ErrorKind::input, "{}: a motion needs at least two samples; record for longer", name);
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1])) fail(ErrorKind::input, "{}: time does not grow at sample {}; sort the samples", name, i);
  for (std::size_t i = 0; i < X_LH.size(); ++i)
    if (!is_placement(X_LH[i]))
      fail(ErrorKind::input, "{}: sample {} is not a finite pose with a unit quaternion; correct it", name, i);
  Trajectory path;
  path.name = name;
  path.what = "recorded";
  path.of_levelled = true;
  path.duration = t.back() - t.front();
  path.at = [t = std::move(t), X_LH = std::move(X_LH)](double when) {
    const double at = std::clamp(when + t.front(), t.front(), t.back());
    const auto after = std::max<std::ptrdiff_t>(1, std::lower_bound(t.begin(), t.end(), at) - t.begin());
    const auto i = static_cast<std::size_t>(after);
    const double s = (at - t[i - 1]) / (t[i] - t[i - 1]);
    const Pose& a = X_LH[i - 1];
    const Pose& b = X_LH[i];
    return level_remote(a.position + s * (b.position - a.position), slerp(a.rotation, b.rotation, s));
  };
  return path;
}

Trajectory from_start_pose(const Trajectory& path, double yaw_sigma, double pitch_sigma, std::uint64_t seed) {
  VERISIM_ASSERT(is_not_negative(yaw_sigma));
  VERISIM_ASSERT(is_not_negative(pitch_sigma));
  double yaw_square = 0, pitch_square = 0;
  for (int i = 0; i < kTurnSamples; ++i) {
    const Matrix3d R_LH = levelled_pose(path.at(path.duration * i / kTurnSamples)).rotation.toRotationMatrix();
    yaw_square += R_LH(2, 0) * R_LH(2, 0) / kTurnSamples;  // sines of yaw and pitch, nearly
    pitch_square += R_LH(2, 1) * R_LH(2, 1) / kTurnSamples;
  }
  // Multiples of the steps of a Kronecker sequence, within -1 and 1: any few seeds in a row are spread evenly.
  const RandomStream random(0, path.name + "/start");
  const auto even = [&](std::uint64_t k) {
    const double here = random.uniform(k) + static_cast<double>(seed * kStartSteps[k] >> 11U) * 0x1p-53;
    return 2 * (here - std::floor(here)) - 1;
  };
  const auto turn = [&](std::uint64_t k, double sigma, double own_square) {
    return even(k) * std::sqrt(3 * std::max(0.0, sigma * sigma - own_square));
  };
  const Quaterniond R_H = head_rotation(turn(0, yaw_sigma, yaw_square), turn(1, pitch_sigma, pitch_square), 0);
  const Quaterniond R_W = head_rotation(kAside * even(2), kAside * even(3), 0);
  Trajectory there = path;
  there.at = [=, at = path.at](double t) {
    Situation s = at(t);
    s.X_WH = {R_W * s.X_WH.position, (s.X_WH.rotation * R_H).normalized()};
    return s;
  };
  return there;
}

const std::vector<Trajectory>& trajectories() {
  static const std::vector<Trajectory> all = make_trajectories();
  return all;
}

const Trajectory& trajectory(std::string_view name) {
  std::vector<std::string> names;
  for (const Trajectory& t : trajectories()) {
    if (t.name == name) return t;
    names.push_back(t.name);
  }
  const std::string near = nearest_name(std::string(name), names);
  fail(ErrorKind::input, "trajectory '{}' is not known{}; choose one of {}", name,
       near.empty() ? "" : fmt::format(", did you mean '{}'?", near), fmt::join(names, ", "));
}

}  // namespace verisim::wii

#include "engine/robot/drive.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

using Values = std::map<std::string, double>;

struct Parameter {
  const char* name;
  double value;
  const char* unit;
  const char* meaning;
};

constexpr Parameter kParameters[] = {
    {"length", 1, "m", "Of a straight line, a strafe or a side of the square"},
    {"angle", pinned::kFullTurn, "rad", "Of the turn on the spot, to the left"},
    {"radius", 0.5, "m", "Of the circle"},
    {"speed", 0.3, "m/s", "Between starting and stopping; of the wheels' middle, and of its hubs in a turn"},
    {"acceleration", 0.5, "m/s^2", "To start and to stop"},
    {"rest", 0.5, "s", "Before, between and after the legs"},
    {"rate", 100, "Hz", "Samples per second"},
};

/// A part of the path: along `unit`, which moves hubs by 1 m per metre of progress, for `length`.
struct Leg {
  PlanarTwist unit;
  double length = 0;  ///< [m]
};

constexpr MecanumGeometry kGeometry;

/// Turns by 1 rad per l + w of progress: so fast do the wheels' rims run.
Leg turn(double angle) {
  const double lever = kGeometry.half_base + kGeometry.half_track;
  return {{0, 0, 1 / lever}, angle * lever};
}

std::vector<Leg> legs_of(const std::string& path, const Values& v) {
  const double length = v.at("length"), radius = v.at("radius");
  if (path == "straight") return {{{1, 0, 0}, length}};
  if (path == "strafe") return {{{0, 1, 0}, length}};
  if (path == "turn") return {turn(v.at("angle"))};
  if (path == "circle") return {{{1, 0, 1 / radius}, pinned::kFullTurn * radius}};
  VERISIM_ASSERT(path == "square");
  std::vector<Leg> legs;
  for (int side = 0; side < 4; ++side) {
    legs.push_back({{1, 0, 0}, length});
    legs.push_back(turn(pinned::kPi / 2));
  }
  return legs;
}

/// Progress along a leg from rest to rest: a trapezoid of speed, or a triangle where the leg is short.
struct Profile {
  double length, acceleration, speed, rising, duration;

  Profile(double leg, double speed_max, double a)
      : length(leg), acceleration(a), speed(std::min(speed_max, std::sqrt(leg * a))) {
    rising = speed / acceleration;
    duration = length / speed + rising;
  }
  [[nodiscard]] double progress(double t) const {
    if (t <= 0) return 0;
    if (t >= duration) return length;
    if (t < rising) return acceleration * t * t / 2;
    if (t > duration - rising) return length - acceleration * (duration - t) * (duration - t) / 2;
    return speed * (t - rising / 2);
  }
  [[nodiscard]] double rate(double t) const {
    if (t <= 0 || t >= duration) return 0;
    return std::min({acceleration * t, speed, acceleration * (duration - t)});
  }
};

Values resolve(const std::map<std::string, double>& given) {
  Values values;
  std::vector<std::string> names;
  for (const Parameter& p : kParameters) {
    values[p.name] = p.value;
    names.emplace_back(p.name);
  }
  for (const auto& [name, value] : given) {
    if (values.find(name) == values.end()) {
      const std::string near = nearest_name(name, names);
      fail(ErrorKind::usage, "'encoder' has no parameter '{}'{} ({})", name,
           near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(names, ", "));
    }
    if (name == "rest" ? !is_not_negative(value) : !is_positive(value))
      fail(ErrorKind::usage, "{} is {} but must be {}", name, value, name == "rest" ? "0 or above" : "above 0");
    values[name] = value;
  }
  return values;
}

std::string known_path(const std::string& path) {
  const std::vector<std::string> paths = drive_paths();
  if (std::find(paths.begin(), paths.end(), path) != paths.end()) return path;
  const std::string near = nearest_name(path, paths);
  fail(ErrorKind::usage, "there is no path '{}'{}; there are {}", path,
       near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(paths, ", "));
}

/// The whole drive as a function of time.
class Drive {
 public:
  Drive(const std::vector<Leg>& legs, const Values& v) : rest_(v.at("rest")) {
    for (const Leg& leg : legs) parts_.push_back({leg, {leg.length, v.at("speed"), v.at("acceleration")}});
    for (const Part& part : parts_) duration_ += rest_ + part.profile.duration;
    duration_ += rest_;
  }
  [[nodiscard]] double duration() const { return duration_; }

  [[nodiscard]] DriveSample at(double t) const {
    DriveSample sample;
    sample.t = t;
    PerWheel angle{};
    double begin = 0;
    for (const auto& [leg, profile] : parts_) {
      begin += rest_;
      const double way = profile.progress(t - begin), rate = profile.rate(t - begin);
      sample.pose = moved(sample.pose, {leg.unit.vx * way, leg.unit.vy * way, leg.unit.omega * way});
      const PerWheel turned = wheel_speeds(kGeometry, leg.unit);
      for (std::size_t i = 0; i < kWheels; ++i) angle[i] += turned[i] * way;
      if (rate > 0) sample.command = {leg.unit.vx * rate, leg.unit.vy * rate, leg.unit.omega * rate};
      begin += profile.duration;
    }
    for (std::size_t i = 0; i < kWheels; ++i)  // half a count before an edge, as encoders begin
      sample.counts[i] = std::llround(std::floor(angle[i] * kCountsPerWheelTurn / pinned::kFullTurn + 0.5));
    return sample;
  }

 private:
  struct Part {
    Leg leg;
    Profile profile;
  };
  std::vector<Part> parts_;
  double rest_, duration_ = 0;
};

}  // namespace

std::vector<std::string> drive_paths() {
  return {"straight", "strafe", "turn", "square", "circle"};
}

std::string drive_help() {
  std::string help;
  for (const Parameter& p : kParameters) help += fmt::format("\n  {}={:g} {}: {}", p.name, p.value, p.unit, p.meaning);
  return help;
}

DriveTrace synthesize_drive(const std::string& path, const std::map<std::string, double>& parameters) {
  constexpr double kSamplesMax = 1e7;  // 11 values each: 1 GB
  const Values values = resolve(parameters);
  const Drive drive(legs_of(known_path(path), values), values);
  DriveTrace trace;
  trace.rate_hz = values.at("rate");
  const double samples = std::ceil(drive.duration() * trace.rate_hz);
  if (!(samples <= kSamplesMax))
    fail(ErrorKind::usage, "{} s at {} Hz are {} samples; at most {} are possible", drive.duration(), trace.rate_hz,
         samples, kSamplesMax);
  trace.description = path;
  for (const auto& [name, value] : values) trace.description += fmt::format(" {}={}", name, value);
  for (double i = 0; i <= samples; ++i) trace.samples.push_back(drive.at(i / trace.rate_hz));
  return trace;
}

}  // namespace verisim::robot

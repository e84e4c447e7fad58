#include "engine/record/synth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/pose.hpp"
#include "engine/base/random.hpp"

namespace verisim {
namespace {

using Values = std::map<std::string, double>;

/// The handle at one moment.
struct Sample {
  Vector3d position = Vector3d::Zero();  ///< m
  double turn = 0;                       ///< rad about z
  bool button = false;
};

using Motion = std::function<Sample(double t)>;

struct SynthParameter {
  std::string name;
  double value = 0;  ///< default
  std::string units;
  std::string description;
};

struct Synthesizer {
  std::string kind;
  std::string description;
  std::vector<SynthParameter> parameters;
  std::function<Motion(const Values&, std::uint64_t seed)> make;
};

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

Vector3d vector_of(const Values& values, const std::string& prefix) {
  return {values.at(prefix + "x"), values.at(prefix + "y"), values.at(prefix + "z")};
}

std::vector<SynthParameter> vector_parameters(const std::string& prefix, const Vector3d& value,
                                              const std::string& units, const std::string& description) {
  std::vector<SynthParameter> parameters;
  for (int i = 0; i < 3; ++i) {
    const std::string axis = kAxes[static_cast<std::size_t>(i)];
    parameters.push_back({prefix + axis, value[i], units, description + ", " + axis});
  }
  return parameters;
}

std::vector<SynthParameter> joined(std::initializer_list<std::vector<SynthParameter>> lists) {
  std::vector<SynthParameter> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Minimum-jerk progress from 0 to 1 (Flash and Hogan 1985): rest at both ends, peak speed 15/8 of the mean.
double minimum_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

Motion make_sine(const Values& v, std::uint64_t) {
  const Vector3d centre = vector_of(v, ""), phase = vector_of(v, "phase_");
  const Vector3d amplitude[2] = {vector_of(v, "amplitude_"), vector_of(v, "amplitude2_")};
  const Vector3d frequency[2] = {vector_of(v, "frequency_"), vector_of(v, "frequency2_")};
  const double turn_amplitude = v.at("turn_amplitude"), turn_frequency = v.at("turn_frequency");
  return [=](double t) {
    Sample sample{.position = centre};
    for (int n = 0; n < 2; ++n) {
      for (int i = 0; i < 3; ++i) {
        sample.position[i] += amplitude[n][i] * pinned::sin(2 * pinned::kPi * frequency[n][i] * t + phase[i]);
      }
    }
    sample.turn = turn_amplitude * pinned::sin(2 * pinned::kPi * turn_frequency * t);
    return sample;
  };
}

Motion make_reach(const Values& v, std::uint64_t) {
  const Vector3d from = vector_of(v, ""), to = vector_of(v, "to_");
  const double wait = v.at("wait"), time = v.at("time");
  if (time <= 0) fail(ErrorKind::usage, "time is {} s but must be above 0", time);
  return [=](double t) {
    const double there = minimum_jerk((t - wait) / time), back = minimum_jerk((t - 2 * wait - time) / time);
    return Sample{.position = from + (there - back) * (to - from)};
  };
}

// Eight sines per axis at random frequencies of the band, each with a random phase: no state, any t directly.
Motion make_tremor(const Values& v, std::uint64_t seed) {
  constexpr int kSines = 8;
  struct Sine {
    double frequency, phase;
  };
  std::array<std::array<Sine, kSines>, 3> sines{};
  for (std::size_t i = 0; i < 3; ++i) {
    const RandomStream random(seed, std::string("tremor ") + kAxes[i]);
    for (std::uint64_t k = 0; k < kSines; ++k) {
      const double place = (static_cast<double>(k) + random.uniform(2 * k)) / kSines;  // one in each eighth of the band
      sines[i][k] = {v.at("frequency") + v.at("bandwidth") * (place - 0.5),
                     2 * pinned::kPi * random.uniform(2 * k + 1)};
    }
  }
  const Vector3d centre = vector_of(v, "");
  const double amplitude = v.at("rms") * std::sqrt(2.0 / kSines);
  return [=](double t) {
    Sample sample{.position = centre};
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Sine& s : sines[i]) {
        sample.position[static_cast<int>(i)] += amplitude * pinned::sin(2 * pinned::kPi * s.frequency * t + s.phase);
      }
    }
    return sample;
  };
}

Motion make_insertion(const Values& v, std::uint64_t seed) {
  const Vector3d start = vector_of(v, ""), axis = vector_of(v, "axis_");
  const double depth = v.at("depth"), speed = v.at("speed"), dwell = v.at("dwell"), grasp_at = v.at("grasp_at");
  if (!(axis.norm() > 0)) fail(ErrorKind::usage, "axis_x, axis_y and axis_z are all 0; give the insertion a direction");
  if (!(speed > 0) || !(depth > 0))
    fail(ErrorKind::usage, "speed is {} m/s and depth {} m; both must be above 0", speed, depth);
  if (dwell < 0) fail(ErrorKind::usage, "dwell is {} s but must not be negative", dwell);
  const Vector3d along = axis / axis.norm();
  Values tremor{{"x", 0}, {"y", 0}, {"z", 0}, {"rms", v.at("tremor")}, {"frequency", 10}, {"bandwidth", 4}};
  const Motion shake = make_tremor(tremor, seed);
  const double leg = depth / speed, period = 2 * (leg + dwell);
  return [=](double t) {
    const double phase = t - period * std::floor(t / period);  // rest above, down, rest below, up
    double travel = 0;
    if (phase >= dwell) travel = std::min((phase - dwell) * speed, depth);
    if (phase > 2 * dwell + leg) travel = std::max(depth - (phase - 2 * dwell - leg) * speed, 0.0);
    return Sample{.position = start + travel * along + shake(t).position, .button = t >= grasp_at};
  };
}

Motion make_step(const Values& v, std::uint64_t) {
  const Vector3d before = vector_of(v, ""), jump = vector_of(v, "step_");
  const double at = v.at("at");
  return [=](double t) { return Sample{.position = t < at ? before : before + jump}; };
}

const std::vector<Synthesizer>& table() {
  const auto start = [](const Vector3d& at) { return vector_parameters("", at, "m", "Where it starts"); };
  static const std::vector<SynthParameter> clock = {{"duration", 10, "s", "Length"},
                                                    {"rate", 1000, "Hz", "Samples per second"}};
  static const std::vector<Synthesizer> all = {
      {"sine", "a sum of two sines per axis",
       joined({clock,
               start({0, 0, 0}),
               vector_parameters("amplitude_", {0.05, 0, 0}, "m", "Amplitude"),
               vector_parameters("frequency_", {1, 1, 1}, "Hz", "Frequency"),
               vector_parameters("amplitude2_", {0, 0, 0}, "m", "Amplitude of the second sine"),
               vector_parameters("frequency2_", {2, 2, 2}, "Hz", "Frequency of the second sine"),
               vector_parameters("phase_", {0, 0, 0}, "rad", "Phase of both"),
               {{"turn_amplitude", 0, "rad", "Rotation about z"}, {"turn_frequency", 1, "Hz", "Of that rotation"}}}),
       make_sine},
      {"reach", "to a point and back, with minimum jerk",
       joined({clock,
               start({0, 0, 0}),
               vector_parameters("to_", {0.1, 0, 0}, "m", "Where it goes"),
               {{"time", 1, "s", "Length of the motion"}, {"wait", 0.5, "s", "Rest before and after it"}}}),
       make_reach},
      {"tremor", "a hand that holds still as well as it can",
       joined({clock,
               start({0, 0, 0}),
               {{"rms", 0.0003, "m", "Root mean square, each axis"},
                {"frequency", 10, "Hz", "Middle of the band"},
                {"bandwidth", 4, "Hz", "Width of the band"}}}),
       make_tremor},
      {"insertion", "down and up along an axis, again and again",
       joined({clock,
               start({0, 0, 0.3}),
               vector_parameters("axis_", {0, 0, -1}, "1", "Direction of insertion"),
               {{"depth", 0.4, "m", "Way along the axis"},
                {"speed", 0.2, "m/s", "On the way"},
                {"dwell", 0.2, "s", "Rest at both ends"},
                {"tremor", 0, "m", "Root mean square, each axis, 8 to 12 Hz"},
                {"grasp_at", 0, "s", "When the button goes down"}}}),
       make_insertion},
      {"step", "a jump at one moment",
       joined({clock,
               start({0, 0, 0}),
               vector_parameters("step_", {0.01, 0, 0}, "m", "Height of the jump"),
               {{"at", 1, "s", "When it jumps"}}}),
       make_step}};
  return all;
}

const Synthesizer& find(const std::string& kind) {
  for (const Synthesizer& s : table()) {
    if (s.kind == kind) return s;
  }
  const std::string near = nearest_name(kind, synthesizers());
  fail(ErrorKind::usage, "there is no synthesizer '{}'{}; there are {}", kind,
       near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(synthesizers(), ", "));
}

Values resolve(const Synthesizer& synthesizer, const std::map<std::string, double>& given) {
  Values values;
  std::vector<std::string> names;
  for (const SynthParameter& p : synthesizer.parameters) {
    values[p.name] = p.value;
    names.push_back(p.name);
  }
  for (const auto& [name, value] : given) {
    if (values.find(name) == values.end()) {
      const std::string near = nearest_name(name, names);
      fail(ErrorKind::usage, "'{}' has no parameter '{}'{} ({})", synthesizer.kind, name,
           near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(names, ", "));
    }
    if (!std::isfinite(value)) fail(ErrorKind::usage, "{} is {} but must be finite", name, value);
    values[name] = value;
  }
  return values;
}

std::size_t count_samples(const Values& values) {
  constexpr double kSamplesMax = 1e8;  // 9 values each: 7 GB
  const double samples = values.at("duration") * values.at("rate");
  if (values.at("rate") <= 0 || samples < 1 || samples > kSamplesMax) {
    fail(ErrorKind::usage, "duration {} s at rate {} Hz is {} samples; 1 to {} are possible", values.at("duration"),
         values.at("rate"), samples, kSamplesMax);
  }
  return static_cast<std::size_t>(std::round(samples)) + 1;  // both ends
}

}  // namespace

std::vector<std::string> synthesizers() {
  std::vector<std::string> kinds;
  for (const Synthesizer& s : table()) kinds.push_back(s.kind);
  return kinds;
}

std::string synthesizer_help() {
  std::string help;
  for (const Synthesizer& s : table()) {
    help += (help.empty() ? "" : "\n") + s.kind + ", " + s.description + ":";
    for (const SynthParameter& p : s.parameters)
      help += fmt::format("\n  {}={:g} {}: {}", p.name, p.value, p.units, p.description);
  }
  return help;
}

Trace synthesize(const std::string& kind, const std::map<std::string, double>& parameters, std::uint64_t seed) {
  const Synthesizer& synthesizer = find(kind);
  const Values values = resolve(synthesizer, parameters);
  const std::size_t samples = count_samples(values);
  const Motion motion = synthesizer.make(values, seed);
  Trace trace;
  trace.kind = "haptic";
  trace.rate_hz = values.at("rate");
  trace.source = "verisim trace synth " + kind;
  for (const auto& [name, value] : values) trace.source += fmt::format(" {}={}", name, value);
  trace.source += fmt::format(" seed={}", seed);
  trace.columns = {"t", "px", "py", "pz", "qx", "qy", "qz", "qw"};
  const bool has_button = kind == "insertion";
  if (has_button) trace.columns.emplace_back("button");
  trace.values.reserve(samples * trace.columns.size());
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / trace.rate_hz;
    const Sample s = motion(t);
    const double turn[2] = {pinned::sin(s.turn / 2), pinned::cos(s.turn / 2)};
    trace.values.insert(trace.values.end(),
                        {t, s.position.x(), s.position.y(), s.position.z(), 0.0, 0.0, turn[0], turn[1]});
    if (has_button) trace.values.push_back(s.button ? 1 : 0);
  }
  return trace;
}

}  // namespace verisim

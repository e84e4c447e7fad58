#include "engine/wii/validate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/quantile.hpp"
#include "engine/wii/sensed_run.hpp"
#include "engine/wii/validation_figures.hpp"

namespace verisim::wii {
namespace {

constexpr int kTimedBlock = 50;  // updates per clock reading: a reading costs as much as an update

std::vector<SensorCase> make_sensor_cases() {
  RemoteSettings noisy;
  noisy.pixel_noise = 0.3;

  RemoteSettings wiimote = noisy;
  wiimote.subpixel_error = 0.1;
  wiimote.half_power_angle = 30 * kDegree;
  wiimote.intensity_min = 0.02;
  wiimote.balls = {{.centre = {0, 0, 0.11}, .radius = 0.09, .on_head = true}};
  wiimote.slot_rule = SlotRule::first_free;
  wiimote.accelerometer_bits = 10;
  wiimote.accelerometer_noise = 0.005;
  wiimote.accelerometer_limit = 3.6;
  wiimote.jitter = 0.1;
  wiimote.loss = 0.01;

  RemoteSettings low_sensitivity = wiimote;
  low_sensitivity.subpixels = 4;
  low_sensitivity.accelerometer_bits = 8;

  RemoteSettings low_battery = wiimote;
  low_battery.battery = 0.15;
  low_battery.intensity_min = 0.05;

  RemoteSettings shaky = noisy;
  shaky.accelerometer_noise = 0.01;
  RemoteSettings coarse = noisy;
  coarse.accelerometer_bits = 8;

  RemoteSettings lamp = noisy;
  lamp.slot_rule = SlotRule::first_free;
  lamp.lamps = {{.p_W = {0.35, 0.3, 1.6}, .begin = 1}};
  return {
      {"ideal", "exact 43 x 32 degree pinhole, whole pixels", {}},
      {"noisy", "ideal with 0.3 pixel of noise", noisy},
      {"wiimote", "noisy, 10 bit accelerometer, emission cones, slots reordered, jitter, 1 % of reports lost", wiimote},
      {"low-sensitivity", "wiimote with half of the subpixels and 8 bit accelerometer", low_sensitivity},
      {"low-battery", "wiimote with LEDs at 15 % of their power", low_battery},
      {"lamp", "noisy with a lamp in view from 1 s on", lamp},
      {"accelerometer", "noisy, and the accelerometer too: 0.01 g", shaky},
      {"8-bit", "noisy with an accelerometer of 8 bits: steps of 0.04 g", coarse},
  };
}

/// What a tracker's name in the options means.
struct Contender {
  const TrackerEntry& entry;
  LedLayout leds;
};
Contender contender(std::string_view name, Trackers known) {
  const bool triangle = name.ends_with("/3");
  const TrackerEntry& entry = find_tracker(triangle ? name.substr(0, name.size() - 2) : name, known);
  return {entry, triangle ? LedLayout::triangle() : entry.leds};
}

double median_update_ns(Tracker& tracker, const std::vector<Sensed>& all) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> blocks;
  for (std::size_t i = 0; i + kTimedBlock <= all.size(); i += kTimedBlock) {
    const auto begin = Clock::now();
    for (std::size_t j = i; j < i + kTimedBlock; ++j)
      (void)tracker.update(all[j].report.t, all[j].report.channels, all[j].remote);
    blocks.push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin).count() / kTimedBlock);
  }
  return blocks.empty() ? 0 : quantile(blocks, 0.5);
}

}  // namespace

const std::vector<SensorCase>& sensor_cases() {
  static const std::vector<SensorCase> all = make_sensor_cases();
  return all;
}

const SensorCase& sensor_case(const std::string& name) {
  std::vector<std::string> names;
  for (const SensorCase& sensor : sensor_cases()) {
    if (sensor.name == name) return sensor;
    names.push_back(sensor.name);
  }
  fail(ErrorKind::input, "sensor '{}' is not known; choose one of {}", name, fmt::join(names, ", "));
}

std::vector<std::string> default_trackers(Trackers known) {
  std::vector<std::string> trackers = tracker_names(known);
  for (const TrackerEntry& entry : known)
    if (entry.judged_with_triangle) trackers.push_back(fmt::format("{}/3", entry.name));
  return trackers;
}

bool suits_glasses(const std::string& tracker, const Trajectory& path, const ValidationOptions& options) {
  const std::optional<LedLayout> leds = first_of(options.set_up, path.own).leds;
  if (!leds) return true;
  return !tracker.ends_with("/3") && find_tracker(tracker, options.known).leds_min <= leds->count;
}

ValidationRow validate_one(const std::string& tracker, const Trajectory& path, const SensorCase& sensor,
                           const ValidationOptions& options, std::vector<ErrorSample>* history) {
  const Contender who = contender(tracker, options.known);
  TrackerSettings settings = options.tracker;
  const SetUp set_up = first_of(options.set_up, path.own);
  if (set_up.leds && tracker.ends_with("/3"))
    fail(ErrorKind::input, "tracker {}: has glasses of its own, but {} names others; leave out the /3 or the LEDs",
         tracker, path.own.leds ? path.name : "the set-up");
  if (set_up.leds)
    settings.leds = *set_up.leds;
  else if (settings.leds.count < who.leds.count)
    settings.leds = who.leds;
  const RemoteSettings remote = remote_settings(sensor.settings, path, settings.leds, set_up);
  settings.fov = remote.fov;
  if (who.entry.remotes == 2) settings.X_R1R2 = second_remote();
  const Trajectory begun =
      options.start_poses ? from_start_pose(path, settings.yaw_sigma, settings.pitch_sigma, options.seed) : path;
  const std::vector<Sensed> all =
      sense_run(remote, placed(begun, set_up), who.entry.remotes, options.seed, set_up.latency.value_or(0));

  const std::unique_ptr<Tracker> judged = make_tracker(who.entry.name, settings, options.known);
  ValidationFigures figures;
  for (const Sensed& s : all) {
    const Report& report = judged->update(s.report.t, s.report.channels, s.remote);
    if (s.remote != 0) continue;
    figures.add(s.report, report);
    if (history != nullptr) history->push_back(error_of(s.report, report));
  }
  ValidationRow row = figures.result();
  row.tracker = tracker;
  row.trajectory = path.name;
  row.sensor = sensor.name;
  if (options.measure_time)
    row.update_ns = median_update_ns(*make_tracker(who.entry.name, settings, options.known), all);
  return row;
}

namespace {

ValidationRow validate_seeds(const std::string& tracker, const Trajectory& path, const SensorCase& sensor,
                             const ValidationOptions& options) {
  ValidationOptions one = options;
  std::vector<ValidationRow> rows;
  for (int k = 0; k < options.seeds; ++k) {
    one.seed = options.seed + static_cast<std::uint64_t>(k);
    rows.push_back(validate_one(tracker, path, sensor, one));
    one.measure_time = false;  // once is enough
  }
  return options.seeds == 1 ? rows.front() : mean_of_seeds(rows);
}

}  // namespace

std::vector<ValidationRow> validate(const ValidationOptions& options) {
  VERISIM_ASSERT(options.seeds >= 1);
  const std::vector<std::string> trackers =
      options.trackers.empty() ? default_trackers(options.known) : options.trackers;
  std::vector<Trajectory> paths = options.recorded;
  if (paths.empty() && options.trajectories.empty()) paths = trajectories();
  for (const std::string& name : options.trajectories) paths.push_back(trajectory(name));
  const std::vector<std::string> sensors =
      options.sensors.empty() ? std::vector<std::string>{"ideal", "wiimote"} : options.sensors;

  std::vector<ValidationRow> rows;
  for (const std::string& sensor : sensors)
    for (const Trajectory& path : paths)
      for (const std::string& tracker : trackers)
        if (!options.trackers.empty() || suits_glasses(tracker, path, options))
          rows.push_back(validate_seeds(tracker, path, sensor_case(sensor), options));
  return rows;
}

}  // namespace verisim::wii

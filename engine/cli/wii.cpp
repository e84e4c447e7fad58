#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/geometry/write_file.hpp"
#include "engine/wii/coverage.hpp"
#include "engine/wii/place.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::cli {
namespace {

using nlohmann::ordered_json;

// ---- validate

ordered_json json_of(const wii::ErrorFigures& f) {
  return {
      {"rms", f.rms}, {"p95", f.p95}, {"max", f.max}, {"rms_axis", {f.rms_axis.x(), f.rms_axis.y(), f.rms_axis.z()}}};
}

ordered_json json_of(const wii::ValidationRow& r) {
  return {{"sensor", r.sensor},
          {"trajectory", r.trajectory},
          {"tracker", r.tracker},
          {"reports", r.reports},
          {"valid", r.valid},
          {"position_m", json_of(r.position)},
          {"orientation_deg", json_of(r.orientation)},
          {"availability", r.availability},
          {"false_validity", r.false_validity},
          {"latency_s", r.latency},
          {"nees", r.nees},
          {"nees_upper", r.nees_upper},
          {"consistent", r.consistent},
          {"within_95", r.within_95},
          {"reacquired", r.reacquired},
          {"longest_return_s", r.longest_return},
          {"update_ns", r.update_ns}};
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& n : all) names.push_back(n.name);
  return names;
}

/// Trackers, and each that can with three LEDs.
std::vector<std::string> contenders() {
  std::vector<std::string> names = wii::tracker_names();
  for (const std::string& name : wii::tracker_names()) names.push_back(name + "/3");
  return names;
}

template <typename Named>
std::string help_of(const std::vector<Named>& all) {
  std::string text;
  for (const Named& n : all) text += fmt::format("\n  {:<16}{}", n.name, n.what);
  return text;
}

void add_validate(CLI::App& wii_command, int& exit_code) {
  struct Options {
    wii::ValidationOptions validation;
    std::string out;
    bool json = false;
  };
  auto* command = wii_command.add_subcommand("validate", "Every tracker against the virtual Wii Remote, as a table");
  auto o = std::make_shared<Options>();
  wii::ValidationOptions& v = o->validation;
  command->add_option("--tracker", v.trackers, "Only these (repeatable); NAME/3: with three LEDs")
      ->take_all()
      ->check(CLI::IsMember(contenders()));
  command->add_option("--trajectory", v.trajectories, "Only these (repeatable)")
      ->take_all()
      ->check(CLI::IsMember(names_of(wii::trajectories())));
  command->add_option("--sensor", v.sensors, "Only these (repeatable; else ideal and wiimote)")
      ->take_all()
      ->check(CLI::IsMember(names_of(wii::sensor_cases())));
  command->add_option("--seed", v.seed, "Seed of the sensor's random streams");
  command->add_option("-o,--out", o->out, "Also write every figure to this CSV");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->footer("Trajectories:" + help_of(wii::trajectories()) + "\nSensors:" + help_of(wii::sensor_cases()) +
                  "\nExample: verisim wii validate --tracker scaat --sensor wiimote -o scaat.csv");
  command->callback([=, &exit_code] {
    const std::vector<wii::ValidationRow> rows = wii::validate(o->validation);
    if (!o->out.empty()) write_file(o->out, wii::csv_of(rows));
    if (o->json) {
      ordered_json j;
      j["rows"] = ordered_json::array();
      for (const wii::ValidationRow& r : rows) j["rows"].push_back(json_of(r));
      std::printf("%s\n", j.dump().c_str());
    } else {
      std::printf("%s", wii::table_of(rows).c_str());
    }
    exit_code = 0;
  });
}

// ---- place

struct PlaceCommand {
  std::string trace;
  std::vector<double> head = {0, 0, 1};
  std::vector<double> screen = {0, 0, 0};
  std::vector<double> spread = {0.15, 0.05, 0.15};
  std::vector<double> room_min = {-0.5, -0.3, -0.2};
  std::vector<double> room_max = {0.5, 0.5, 0.2};
  std::vector<double> fov;  ///< degrees; empty: the trace's, or 43 x 32
  std::vector<double> range = {0.4, 2};
  int count = 1000;
  std::uint64_t samples = 200'000;
  std::uint64_t seed = 1;
  bool json = false;
};

Vector3d vector_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

wii::PlaceOptions place_options(const PlaceCommand& c) {
  wii::PlaceOptions options;
  if (!c.trace.empty()) {
    const wii::Recording recording = read_wii_file(c.trace, {.allow_gaps = true});
    if (recording.truth.empty())
      fail(ErrorKind::input, "{}: no columns px … qw; a trace must know the head's poses to place a remote for them",
           c.trace);
    options.heads = recording.truth;
    options.tracker = recording.settings;
  } else {
    options.heads = wii::modelled_heads(vector_of(c.head), vector_of(c.screen), vector_of(c.spread), c.count, c.seed);
  }
  if (!c.fov.empty()) options.tracker.fov = {c.fov[0] * wii::kDegree, c.fov[1] * wii::kDegree};
  options.room_min = vector_of(c.room_min);
  options.room_max = vector_of(c.room_max);
  return options;
}

/// Eq. 2.1 and 2.2 beside what the virtual remote sees (R7).
ordered_json coverage_of(const PlaceCommand& c, const wii::TrackerSettings& tracker) {
  const double spacing = (tracker.leds.p_H[0] - tracker.leds.p_H[1]).norm();
  const double d1 = c.range[0];
  const double d2 = c.range[1];
  if (!(d1 > 0) || !(d2 > d1) || wii::trackable_area(tracker.fov, spacing, d1) == 0)
    fail(ErrorKind::usage, "--range {} {}: must grow, and the LEDs must fit into the view at its beginning", d1, d2);
  const wii::Counted area = wii::count_trackable_area(tracker.fov, spacing, d2, c.samples, c.seed);
  const wii::Counted volume = wii::count_trackable_volume(tracker.fov, spacing, d1, d2, c.samples, c.seed);
  return {{"range_m", {d1, d2}},
          {"area_m2", wii::trackable_area(tracker.fov, spacing, d2)},
          {"area_counted_m2", area.value},
          {"area_standard_error_m2", area.standard_error},
          {"volume_as_printed_m3", wii::trackable_volume_as_printed(tracker.fov, spacing, d1, d2)},
          {"volume_m3", wii::trackable_volume(tracker.fov, spacing, d1, d2)},
          {"volume_counted_m3", volume.value},
          {"volume_standard_error_m3", volume.standard_error}};
}

void run_place(const PlaceCommand& c) {
  const wii::PlaceOptions options = place_options(c);
  const ordered_json coverage = coverage_of(c, options.tracker);
  const wii::Placement best = wii::best_place(options);
  const Vector3d& p = best.X_WR.position;
  if (c.json) {
    const ordered_json j = {{"position_m", {p.x(), p.y(), p.z()}},
                            {"heading_deg", best.heading / wii::kDegree},
                            {"pitch_deg", best.pitch / wii::kDegree},
                            {"covered", best.covered},
                            {"expected_error_m", best.error},
                            {"heads", options.heads.size()},
                            {"coverage", coverage}};
    std::printf("%s\n", j.dump().c_str());
    return;
  }
  std::printf("place      %.3f %.3f %.3f m, heading %.1f, pitch %.1f deg\n", p.x(), p.y(), p.z(),
              best.heading / wii::kDegree, best.pitch / wii::kDegree);
  std::printf("sees       %.1f %% of %zu head poses, expected error %.2f cm\n", 100 * best.covered,
              options.heads.size(), 100 * best.error);
  const auto figure = [&](const char* key) { return coverage[key].get<double>(); };
  std::printf("eq. 2.1    %.5f m2 at %.2f m; counted %.5f +- %.5f\n", figure("area_m2"), c.range[1],
              figure("area_counted_m2"), figure("area_standard_error_m2"));
  std::printf("eq. 2.2    %.5f m3 as printed, %.5f corrected; counted %.5f +- %.5f\n", figure("volume_as_printed_m3"),
              figure("volume_m3"), figure("volume_counted_m3"), figure("volume_standard_error_m3"));
}

void add_place(CLI::App& wii_command, int& exit_code) {
  auto* command = wii_command.add_subcommand("place", "The place and tilt of a remote that see most of given heads");
  auto o = std::make_shared<PlaceCommand>();
  command->add_option("--heads", o->trace, "Wii trace with true poses; else heads are modelled");
  command->add_option("--head", o->head, "Middle of the modelled heads, m (+y up)")->expected(3);
  command->add_option("--screen", o->screen, "What they face, m")->expected(3);
  command->add_option("--spread", o->spread, "Standard deviation of their places, m")->expected(3);
  command->add_option("--count", o->count, "How many heads to model")->check(CLI::PositiveNumber);
  command->add_option("--room-min", o->room_min, "Lower corner of where the remote may stand, m")->expected(3);
  command->add_option("--room-max", o->room_max, "Upper corner, m")->expected(3);
  command->add_option("--fov", o->fov, "Field of view, degrees (else the trace's, or 43 32)")
      ->expected(2)
      ->check(CLI::Range(1.0, 170.0));
  command->add_option("--range", o->range, "Distances for eq. 2.1 and 2.2, m")->expected(2);
  command->add_option("--samples", o->samples, "Heads in the Monte-Carlo count")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of heads and count");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->footer(
      "Example: verisim wii place --head 0 1.2 1 --screen 0 1.2 0 --room-min -0.6 0.7 -0.3 --room-max 0.6 1.7 0");
  command->callback([=, &exit_code] {
    run_place(*o);
    exit_code = 0;
  });
}

}  // namespace

void add_wii(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("wii", "The head trackers: validate them, place a remote, track a trace, speak VRPN");
  command->require_subcommand(1);
  add_validate(*command, exit_code);
  add_place(*command, exit_code);
  add_wii_track(*command, exit_code);
  add_wii_serve(*command, exit_code);
  add_wii_listen(*command, exit_code);
}

}  // namespace verisim::cli

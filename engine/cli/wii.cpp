#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/wii/coverage.hpp"
#include "engine/wii/place.hpp"

namespace verisim::cli {
namespace {

struct PlaceCommand {
  std::string trace;
  std::vector<double> head = {0, 0, 1};
  std::vector<double> screen = {0, 0, 0};
  std::vector<double> screen_size = {0.6, 0.35};
  std::vector<std::vector<double>> obstacles;  ///< corners of boxes
  std::vector<double> at;                      ///< a place to evaluate: x y z, heading, pitch
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

/// Error(usage) for an option that would be ignored.
void refuse_idle_options(const CLI::App& command, const PlaceCommand& c) {
  const auto refuse = [&](std::initializer_list<const char*> names, const char* because) {
    for (const char* name : names)
      if (command.count(name) > 0) fail(ErrorKind::usage, "{}: {}; leave it out", name, because);
  };
  if (!c.trace.empty())
    refuse({"--head", "--spread", "--count"}, "is of modelled heads, and --heads gives recorded ones");
  if (!c.trace.empty() && command.count("--screen") == 0)
    refuse({"--screen-size"}, "where the screen stands is not known: --heads needs --screen, too");
  if (!c.at.empty()) refuse({"--room-min", "--room-max"}, "--at gives the place, nothing is looked for");
}

Vector3d vector_of(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

wii::PlaceOptions place_options(const PlaceCommand& c, bool with_screen) {
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
  for (const double side : c.screen_size)
    if (!(side >= 0) || !std::isfinite(side))
      fail(ErrorKind::usage, "--screen-size {} {}: must be sides in m; 0 0 for no screen", c.screen_size[0],
           c.screen_size[1]);
  if (c.screen_size[0] > 0 && c.screen_size[1] > 0 && with_screen)
    options.obstacles.push_back(
        wii::screen_at(vector_of(c.screen), wii::middle_of(options.heads), c.screen_size[0], c.screen_size[1]));
  for (const std::vector<double>& box : c.obstacles) {
    const Vector3d low(box[0], box[1], box[2]), high(box[3], box[4], box[5]);
    if (!low.allFinite() || !high.allFinite() || !(low.array() <= high.array()).all())
      fail(ErrorKind::usage, "--obstacle {}: the first corner must be the lower one", fmt::join(box, " "));
    options.obstacles.push_back({{(low + high) / 2, Quaterniond::Identity()}, (high - low) / 2});
  }
  options.room_min = vector_of(c.room_min);
  options.room_max = vector_of(c.room_max);
  return options;
}

/// Eq. 2.1 and 2.2 beside what the virtual remote sees (R7).
Json coverage_of(const PlaceCommand& c, const wii::TrackerSettings& tracker) {
  const double spacing = (tracker.leds.p_H[0] - tracker.leds.p_H[1]).norm();
  const double d1 = c.range[0];
  const double d2 = c.range[1];
  wii::check_settings(tracker);
  if (!(d1 > 0) || !(d2 > d1) || !std::isfinite(d2) || wii::trackable_area(tracker.fov, spacing, d1) == 0)
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

Json place_json(const wii::Placement& place) {
  const Vector3d& p = place.X_WR.position;
  return {{"position_m", {p.x(), p.y(), p.z()}},
          {"heading_deg", place.heading / wii::kDegree},
          {"pitch_deg", place.pitch / wii::kDegree},
          {"covered", place.covered},
          {"expected_error_m", place.covered > 0 ? Json(place.error) : Json()}};
}

/// Heads by why they are not seen from a place: numbers from 0, as in the trace or as modelled.
std::map<std::string_view, std::vector<std::size_t>> lost_from(const wii::PlaceOptions& options,
                                                               const wii::Placement& place) {
  std::map<std::string_view, std::vector<std::size_t>> heads;
  const std::vector<wii::Lost> lost = wii::lost_heads(options, place.X_WR);
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (lost[i] != wii::Lost::no) heads[wii::name_of(lost[i])].push_back(i);
  return heads;
}

void print_places(const wii::PlaceOptions& options, const std::vector<wii::Placement>& places) {
  std::printf("%8s %8s %8s %8s %8s %9s %9s\n", "x m", "y m", "z m", "heading", "pitch", "seen %", "error cm");
  for (const wii::Placement& place : places) {
    const Vector3d& p = place.X_WR.position;
    std::printf("%8.3f %8.3f %8.3f %8.1f %8.1f %9.1f %9.2f\n", p.x(), p.y(), p.z(), place.heading / wii::kDegree,
                place.pitch / wii::kDegree, 100 * place.covered, 100 * place.error);
  }
  constexpr std::size_t kShown = 8;
  for (const auto& [why, heads] : lost_from(options, places.front())) {
    std::printf("from the first %zu of %zu heads are %.*s:", heads.size(), options.heads.size(),
                static_cast<int>(why.size()), why.data());
    for (std::size_t i = 0; i < std::min(kShown, heads.size()); ++i) std::printf(" %zu", heads[i]);
    std::printf(heads.size() > kShown ? " ...\n" : "\n");
  }
}

void run_place(const CLI::App& command, const PlaceCommand& c) {
  refuse_idle_options(command, c);
  const wii::PlaceOptions options = place_options(c, c.trace.empty() || command.count("--screen") > 0);
  const Json coverage = coverage_of(c, options.tracker);
  std::vector<wii::Placement> places;
  if (c.at.empty()) {
    places = wii::good_places(options);
  } else {
    if (!std::all_of(c.at.begin(), c.at.end(), [](double x) { return std::isfinite(x); }))
      fail(ErrorKind::usage, "--at {}: must be finite numbers", fmt::join(c.at, " "));
    wii::check_place(options);
    places = {wii::judge_place(options, vector_of(c.at), c.at[3] * wii::kDegree, c.at[4] * wii::kDegree)};
  }
  if (c.json) {
    Json j = place_json(places.front());
    j["heads"] = options.heads.size();
    j["lost"] = Json::object();
    for (const auto& [why, heads] : lost_from(options, places.front())) j["lost"][std::string(why)] = heads;
    j["places"] = Json::array();
    for (const wii::Placement& place : places) j["places"].push_back(place_json(place));
    j["coverage"] = coverage;
    std::printf("%s\n", json_text(j).c_str());
    return;
  }
  print_places(options, places);
  const auto figure = [&](const char* key) { return coverage[key].get<double>(); };
  std::printf("eq. 2.1    %.5f m2 at %.2f m; counted %.5f +- %.5f\n", figure("area_m2"), c.range[1],
              figure("area_counted_m2"), figure("area_standard_error_m2"));
  std::printf("eq. 2.2    %.5f m3 as printed, %.5f corrected; counted %.5f +- %.5f\n", figure("volume_as_printed_m3"),
              figure("volume_m3"), figure("volume_counted_m3"), figure("volume_standard_error_m3"));
}

void add_place(CLI::App& wii_command, int& exit_code) {
  auto* command =
      wii_command.add_subcommand("place", "Places of a remote that see most of given heads, and see them best");
  auto o = std::make_shared<PlaceCommand>();
  command->add_option("--heads", o->trace, "Wii trace with true poses; else heads are modelled");
  command->add_option("--head", o->head, "Middle of the modelled heads, m (+y up)")->expected(3);
  command->add_option("--screen", o->screen, "What they face, m; nothing is seen through it")->expected(3);
  command->add_option("--screen-size", o->screen_size, "Its width and height, m; 0 0: it hides nothing")->expected(2);
  command
      ->add_option("--obstacle", o->obstacles, "Lower and upper corner of a box that hides what is behind (repeatable)")
      ->expected(6);
  command->add_option("--at", o->at, "Evaluate this place: x y z, m, heading and pitch, degrees")->expected(5);
  command->add_option("--spread", o->spread, "Standard deviation of their places, m")->expected(3);
  command->add_option("--count", o->count, "How many heads to model")->check(CLI::PositiveNumber);
  command->add_option("--room-min", o->room_min, "Lower corner of where the remote may stand, m")->expected(3);
  command->add_option("--room-max", o->room_max, "Upper corner, m")->expected(3);
  command->add_option("--fov", o->fov, "Field of view, degrees (else the trace's, or 43 32)")
      ->expected(2)
      ->check(CLI::Range(1.0, 170.0));
  command->add_option("--range", o->range, "Distances for eq. 2.1 and 2.2, m")->expected(2);
  command->add_option("--samples", o->samples, "Heads in the Monte-Carlo count")->check(CLI::PositiveNumber);
  add_seed_option(
      *command, [o](std::uint64_t seed) { o->seed = seed; }, "Seed of heads and count (0 to 2^64 - 1)");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->footer(
      "Example: verisim wii place --head 0 1.2 1 --screen 0 1.2 0 --room-min -0.6 0.7 -0.3 --room-max 0.6 1.7 0");
  command->callback([=, &exit_code] {
    run_place(*command, *o);
    exit_code = 0;
  });
}

}  // namespace

void add_wii(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "wii", "The head trackers: validate them, judge your own, place a remote, track a trace, speak VRPN");
  command->require_subcommand(1);
  add_wii_validate(*command, exit_code);
  add_wii_judge(*command, exit_code);
  add_place(*command, exit_code);
  add_wii_track(*command, exit_code);
  add_wii_serve(*command, exit_code);
  add_wii_listen(*command, exit_code);
}

}  // namespace verisim::cli

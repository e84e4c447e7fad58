#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/cli/wii_rows.hpp"
#include "engine/cli/wii_set_up.hpp"
#include "engine/record/output_place.hpp"
#include "engine/wii/validate.hpp"
#include "engine/wii/validation_plot.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

struct ValidateOptions {
  wii::ValidationOptions validation;
  std::vector<std::string> motions;
  SetUpOptions set_up;
  OutOptions out;
  bool json = false;
  bool markdown = false;
};

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

/// FILE.csv with every figure, FILE.svg with all of them at a glance, and FILE-TRAJECTORY-SENSOR.svg over time for each
/// trajectory that was asked for by name.
void write_files(const ValidateOptions& o, const std::vector<wii::ValidationRow>& rows,
                 const std::vector<FileIdentity>& inputs) {
  write_row_files(o.out, rows, inputs);
  std::vector<wii::Trajectory> paths = o.validation.recorded;
  for (const std::string& name : o.validation.trajectories) paths.push_back(wii::trajectory(name));
  for (const wii::Trajectory& path : paths) {
    std::vector<std::string> done;
    for (const wii::ValidationRow& r : rows) {
      if (r.trajectory != path.name || std::find(done.begin(), done.end(), r.sensor) != done.end()) continue;
      done.push_back(r.sensor);
      std::vector<wii::ErrorHistory> histories;
      for (const wii::ValidationRow& same : rows) {
        if (same.trajectory != path.name || same.sensor != r.sensor) continue;
        histories.push_back({same.tracker, {}});
        wii::ValidationOptions quick = o.validation;
        quick.measure_time = false;
        (void)wii::validate_one(same.tracker, path, wii::sensor_case(r.sensor), quick, &histories.back().samples);
      }
      write_text(fmt::format("{}-{}-{}.svg", stem_of(o.out), path.name, r.sensor),
                 wii::history_plot(path.name + ", " + r.sensor, histories), o.out.force, inputs);
    }
  }
}

/// Says which trackers are left out where none were named and the glasses are the user's, or a motion's.
void say_who_is_left_out(const wii::ValidationOptions& v) {
  if (!v.trackers.empty()) return;
  const std::vector<wii::Trajectory>& paths = v.recorded.empty() ? wii::trajectories() : v.recorded;
  for (const std::string& tracker : wii::default_trackers(v.known))
    for (const wii::Trajectory& path : paths)
      if (!wii::suits_glasses(tracker, path, v)) {
        std::fprintf(stderr, "note: %s is left out: the LEDs that are named do not suit it\n", tracker.c_str());
        break;
      }
}

void run_validate(ValidateOptions& o) {
  std::vector<FileIdentity> inputs;
  for (const std::string& file : o.motions) o.validation.recorded.push_back(read_motion(file, inputs));
  o.validation.set_up = o.set_up.set_up();
  say_who_is_left_out(o.validation);
  if (!o.out.path.empty()) check_row_files(o.out, inputs);
  const std::vector<wii::ValidationRow> rows = wii::validate(o.validation);
  if (!o.out.path.empty()) write_files(o, rows, inputs);
  if (o.json) {
    Json j;
    j["rows"] = Json::array();
    for (const wii::ValidationRow& r : rows) j["rows"].push_back(row_json(r));
    std::printf("%s\n", json_text(j).c_str());
  } else {
    std::printf("%s", (o.markdown ? wii::markdown_of(rows) : wii::table_of(rows)).c_str());
  }
}

}  // namespace

void add_wii_validate(CLI::App& wii_command, int& exit_code) {
  auto* command = wii_command.add_subcommand("validate", "Every tracker against the virtual Wii Remote, as a table");
  auto o = std::make_shared<ValidateOptions>();
  wii::ValidationOptions& v = o->validation;
  command->add_option("--tracker", v.trackers, "Only these (repeatable); NAME/3: with three LEDs")
      ->take_all()
      ->check(CLI::IsMember(contenders()));
  command->add_option("--trajectory", v.trajectories, "Only these (repeatable)")
      ->take_all()
      ->check(CLI::IsMember(names_of(wii::trajectories())));
  command
      ->add_option("--motion", o->motions,
                   "Recorded motion of a head: a trace with poses in levelled coordinates (repeatable)")
      ->take_all();
  command->add_option("--sensor", v.sensors, "Only these (repeatable; else ideal and wiimote)")
      ->take_all()
      ->check(CLI::IsMember(names_of(wii::sensor_cases())));
  command
      ->add_option("--seeds", v.seeds,
                   "Mean over so many seeds, with its 95 % interval; plots over time are of the first")
      ->check(CLI::Range(1, 100000));
  command->add_flag("--start-poses", v.start_poses,
                    "Each seed begins from a pose of its own: up to 5 degrees aside, turned as far as trackers assume");
  o->set_up.add(*command);
  add_seed_option(
      *command, [&v](std::uint64_t seed) { v.seed = seed; }, "Seed of the sensor's random streams (0 to 2^64 - 1)");
  add_out_options(*command, o->out,
                  "Every figure to this CSV, a plot of all beside it (.svg), and one over time for each trajectory or "
                  "motion that is named; only such tables and plots are replaced");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->add_flag("--markdown", o->markdown, "Position rms and availability alone, as a Markdown table");
  command->footer("Trajectories:" + help_of(wii::trajectories()) + "\nSensors:" + help_of(wii::sensor_cases()) +
                  "\nExample: verisim wii validate --tracker scaat --sensor wiimote -o scaat.csv");
  command->callback([=, &exit_code] {
    run_validate(*o);
    exit_code = 0;
  });
}

}  // namespace verisim::cli

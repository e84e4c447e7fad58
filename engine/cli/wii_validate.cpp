#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/record/output_place.hpp"
#include "engine/session/json_text.hpp"
#include "engine/simulation/inputs.hpp"
#include "engine/wii/validate.hpp"
#include "engine/wii/validation_plot.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ValidateOptions {
  wii::ValidationOptions validation;
  std::vector<std::string> motions;
  OutOptions out;
  bool json = false;
  bool markdown = false;
};

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
          {"nees_lower", r.nees_lower},
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

/// A motion of any trace that has poses (columns px ... qw): a head's, in levelled coordinates of the remote.
wii::Trajectory read_motion(const std::string& file, std::vector<FileIdentity>& opened) {
  Inputs inputs = Inputs::live(".", {file});
  const Trace trace = parse_trace(file, inputs.read(file), "", {.allow_gaps = true});
  opened.insert(opened.end(), inputs.opened().begin(), inputs.opened().end());
  std::vector<int> columns;
  for (const char* name : {"px", "py", "pz", "qx", "qy", "qz", "qw"}) columns.push_back(trace.column(name));
  if (std::find(columns.begin(), columns.end(), -1) != columns.end())
    fail(ErrorKind::input, "{}: no columns px ... qw; a motion is a trace with poses", file);
  std::vector<double> t;
  std::vector<Pose> X_LH;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const auto value = [&](std::size_t i) { return trace.at(row, static_cast<std::size_t>(columns[i])); };
    t.push_back(trace.at(row, 0));
    X_LH.push_back({{value(0), value(1), value(2)}, Quaterniond(value(6), value(3), value(4), value(5)).normalized()});
  }
  return wii::recorded_trajectory(fs::path(file).stem().string(), std::move(t), std::move(X_LH));
}

std::string stem_of(const ValidateOptions& o) {
  return fs::path(o.out.path).replace_extension().string();
}

/// Before anything is computed. The plots over time are looked at when they are written.
void check_files(const ValidateOptions& o, const std::vector<FileIdentity>& inputs) {
  if (fs::path(o.out.path).extension() == ".svg")
    fail(ErrorKind::usage, "-o {}: names the table, beside which the plot has this name; let it end in .csv",
         o.out.path);
  (void)check_output({o.out.path, OutputKind::text, o.out.force, beginning_of(wii::csv_of({}))}, inputs);
  const std::string plot = beginning_of(wii::overview_plot({}));
  (void)check_output({stem_of(o) + ".svg", OutputKind::text, o.out.force, plot}, inputs);
}

/// FILE.csv with every figure, FILE.svg with all of them at a glance, and FILE-TRAJECTORY-SENSOR.svg over time for each
/// trajectory that was asked for by name.
void write_files(const ValidateOptions& o, const std::vector<wii::ValidationRow>& rows,
                 const std::vector<FileIdentity>& inputs) {
  write_text(o.out.path, wii::csv_of(rows), o.out.force, inputs);
  const std::string stem = stem_of(o);
  write_text(stem + ".svg", wii::overview_plot(rows), o.out.force, inputs);
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
      write_text(fmt::format("{}-{}-{}.svg", stem, path.name, r.sensor),
                 wii::history_plot(path.name + ", " + r.sensor, histories), o.out.force, inputs);
    }
  }
}

void run_validate(ValidateOptions& o) {
  std::vector<FileIdentity> inputs;
  for (const std::string& file : o.motions) o.validation.recorded.push_back(read_motion(file, inputs));
  if (!o.out.path.empty()) check_files(o, inputs);
  const std::vector<wii::ValidationRow> rows = wii::validate(o.validation);
  if (!o.out.path.empty()) write_files(o, rows, inputs);
  if (o.json) {
    ordered_json j;
    j["rows"] = ordered_json::array();
    for (const wii::ValidationRow& r : rows) j["rows"].push_back(json_of(r));
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

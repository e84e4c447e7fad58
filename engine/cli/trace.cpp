#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_synth.hpp"
#include "engine/record/output_place.hpp"
#include "engine/record/synth.hpp"
#include "engine/record/trace.hpp"
#include "engine/robot/drive.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::cli {
namespace {

std::string content_of(const std::string& file) {
  return Inputs::live(".", {file}).read(file);
}

Json describe(const Trace& trace) {
  Json j;
  const std::size_t n = trace.rows();
  j["kind"] = trace.kind;
  if (trace.rate_hz > 0) j["rate_hz"] = trace.rate_hz;
  j["source"] = trace.source;
  for (const auto& [key, value] : trace.extra) j[key] = value;
  j["samples"] = n;
  j["duration_s"] = trace.at(n - 1, 0) - trace.at(0, 0);
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0;
  for (std::size_t i = 1; i < n; ++i) {
    const double step = trace.at(i, 0) - trace.at(i - 1, 0);
    shortest = std::min(shortest, step);
    longest = std::max(longest, step);
  }
  if (n > 1) {
    j["measured_rate_hz"] = static_cast<double>(n - 1) / j["duration_s"].get<double>();
    j["shortest_step_s"] = shortest;
    j["longest_step_s"] = longest;
  }
  for (std::size_t c = 1; c < trace.columns.size(); ++c) {
    double low = trace.at(0, c);
    double high = low;
    for (std::size_t i = 0; i < n; ++i) {
      low = std::min(low, trace.at(i, c));
      high = std::max(high, trace.at(i, c));
    }
    j["columns"][trace.columns[c]] = {{"min", low}, {"max", high}};
  }
  return j;
}

void print_trace_info(const Json& j) {
  for (const auto& [name, value] : j.items()) {
    if (name == "columns") continue;
    std::printf("%-20s%s\n", name.c_str(),
                shown(value.is_string() ? value.get<std::string>() : json_text(value)).c_str());
  }
  std::printf("%-20s%14s%14s\n", "column", "min", "max");
  for (const auto& [name, range] : j["columns"].items())
    std::printf("%-20s%14.6g%14.6g\n", shown(name).c_str(), range["min"].get<double>(), range["max"].get<double>());
}

void add_info(CLI::App& trace, int& exit_code) {
  struct Options {
    std::string file;
    bool json = false;
    TraceLimits limits;
  };
  auto* command = trace.add_subcommand("info", "Kind, rate, gaps and ranges of a trace");
  auto o = std::make_shared<Options>();
  command->add_option("TRACE", o->file, "Trace, CSV or HDF5")->required();
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->add_flag("--resort", o->limits.resort, "Sort the samples by time first");
  command->add_flag("--allow-gaps", o->limits.allow_gaps, "Accept gaps longer than 0.1 s");
  command->footer("Example: verisim trace info peg.csv");
  command->callback([=, &exit_code] {
    const Json report = describe(parse_trace(o->file, content_of(o->file), "", o->limits));
    if (o->json)
      std::printf("%s\n", json_text(report).c_str());
    else
      print_trace_info(report);
    exit_code = 0;
  });
}

void add_convert(CLI::App& trace, int& exit_code) {
  struct Options {
    std::string in;
    OutOptions out;
    std::vector<std::string> maps;
    ConvertOptions convert;
    TraceLimits limits;
  };
  auto* command = trace.add_subcommand("convert", "A foreign CSV, or a trace in the other format, to a trace");
  auto o = std::make_shared<Options>();
  command->add_option("FILE", o->in, "Foreign CSV, or a trace")->required();
  add_out_options(*command, o->out, "Trace to write, .csv or .h5; only a trace is replaced")->required();
  command->add_option("--kind", o->convert.kind, "haptic, wii or encoder");
  command
      ->add_option("--map", o->maps, "TARGET=COLUMN*SCALE+OFFSET, COLUMN a name or a number from 1; TARGET=:CONSTANT")
      ->take_all();
  command->add_option("--rate", o->convert.rate_hz, "Samples per second: time is row / rate");
  command->add_option("--time", o->convert.time_column, "Column with the time, shifted to begin at 0");
  command->add_option("--time-scale", o->convert.time_scale, "Seconds per unit of the time column");
  command->add_option("--every", o->convert.every, "Take every n-th row")->check(CLI::PositiveNumber);
  command->add_option("--skip", o->convert.skip_rows, "Rows before the column names or the first number");
  command->add_flag("--cumulative", o->convert.cumulative, "Encoder columns are increments: sum them up");
  command->add_option("--source", o->convert.source, "Who recorded what with what");
  command->add_flag("--resort", o->limits.resort, "Sort the samples of a trace by time first");
  command->add_flag("--allow-gaps", o->limits.allow_gaps, "Accept gaps longer than 0.1 s in a trace");
  command->footer(
      "Example: verisim trace convert q1a_rigid.csv -o rigid.csv --time t_s --every 2 --map px=x_m_rad*0.075");
  command->callback([=, &exit_code] {
    Inputs inputs = Inputs::live(".", {o->in});
    const std::string& content = inputs.read(o->in);
    const std::string out = check_output({o->out.path, OutputKind::trace, o->out.force, {}}, inputs.opened());
    if (o->maps.empty()) {
      write_trace(out, parse_trace(o->in, content, "", o->limits));
    } else {
      for (const std::string& map : o->maps) o->convert.mappings.push_back(parse_mapping(map));
      if (o->convert.source.empty()) o->convert.source = std::filesystem::path(o->in).filename().string();
      write_trace(out, convert_csv(o->in, content, o->convert));
    }
    exit_code = 0;
  });
}

/// The drive of a mecanum base as a trace: counts, commands and true poses.
Trace encoder_trace(const std::string& path, const std::map<std::string, double>& parameters) {
  const robot::DriveTrace drive = robot::synthesize_drive(path, parameters);
  Trace trace;
  trace.kind = "encoder";
  trace.rate_hz = drive.rate_hz;
  trace.source = "verisim trace synth encoder --path " + drive.description;
  trace.columns = {"t", "e0", "e1", "e2", "e3", "vx", "vy", "omega", "x", "y", "theta"};
  trace.values.reserve(drive.samples.size() * trace.columns.size());
  for (const auto& [t, counts, command, pose] : drive.samples) {
    trace.values.push_back(t);
    for (const std::int64_t count : counts) trace.values.push_back(static_cast<double>(count));
    trace.values.insert(trace.values.end(), {command.vx, command.vy, command.omega, pose.x, pose.y, pose.theta});
  }
  return trace;
}

struct SynthOptions {
  std::string kind;
  std::string path;
  OutOptions out;
  std::vector<std::string> sets;
  VirtualRunOptions wii;
  std::uint64_t seed = 1;
};

/// Error(usage) for an option that the kind does not know.
void check_options_of_kind(const CLI::App& command, const SynthOptions& o) {
  if (o.kind != "wii") refuse_virtual_remote(command, false, "'" + o.kind + "' has none, only wii has");
  if (o.kind != "encoder" && !o.path.empty())
    fail(ErrorKind::usage, "--path {}: '{}' has none; only encoder has", o.path, o.kind);
  if (o.kind == "wii" && !o.sets.empty())
    fail(ErrorKind::usage, "--set {}: 'wii' has none; its options are in the help", o.sets.front());
}

/// What the trace was made from, so that it can be made again: the options that were given, but not where it goes.
std::string written_options(const CLI::App& command) {
  std::string text = "verisim trace synth wii";
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_positional() || option->check_name("--out") ||
        option->check_name("--force"))
      continue;
    text += fmt::format(" {} {}", option->get_name(), fmt::join(option->results(), " "));
  }
  return text;
}

void synth(SynthOptions& o, const CLI::App& command) {
  std::map<std::string, double> parameters;
  for (const auto& [key, value] : split_pairs("--set", o.sets)) {
    char* end = nullptr;
    parameters[key] = std::strtod(value.c_str(), &end);
    if (end == value.c_str() || *end != '\0')
      fail(ErrorKind::usage, "--set {}={}: {} is not a number", key, value, value);
  }
  std::vector<std::string> kinds = synthesizers();
  kinds.emplace_back("encoder");
  kinds.emplace_back("wii");
  if (std::find(kinds.begin(), kinds.end(), o.kind) == kinds.end()) {
    const std::string near = nearest_name(o.kind, kinds);
    fail(ErrorKind::usage, "there is no synthesizer '{}'{}; there are {}", o.kind,
         near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(kinds, ", "));
  }
  check_options_of_kind(command, o);
  std::vector<FileIdentity> inputs;
  const auto make = [&] {
    if (o.kind == "encoder") return encoder_trace(o.path.empty() ? "straight" : o.path, parameters);
    if (o.kind != "wii") return synthesize(o.kind, parameters, o.seed);
    o.wii.seed = o.seed;
    return wii_trace_of(run_virtually(o.wii, inputs), written_options(command));
  };
  const OutputPlace place{o.out.path, OutputKind::trace, o.out.force, {}};
  (void)check_output(place);  // before the work
  const Trace made = make();
  write_trace(check_output(place, inputs), made);  // what was read is known only now
}

void add_synth(CLI::App& trace, int& exit_code) {
  auto* command = trace.add_subcommand("synth", "Makes a trace from a formula");
  auto o = std::make_shared<SynthOptions>();
  command
      ->add_option(
          "KIND", o->kind,
          "What to make: " + synthesizer_help() +
              "\nwii, of a virtual Wii Remote that sees a head, with the true poses (trajectories and sensors: "
              "wii validate --help)\nencoder, of a mecanum base that drives along --path without slip:" +
              robot::drive_help())
      ->required();
  add_out_options(*command, o->out, "Trace to write, .csv or .h5; only a trace is replaced")->required();
  command->add_option("--set", o->sets, "KEY=NUMBER: a parameter of the kind")->take_all();
  command->add_option("--path", o->path,
                      fmt::format("Of encoder: {} (default: straight)", fmt::join(robot::drive_paths(), ", ")));
  o->wii.add(*command);
  add_seed_option(
      *command, [o](std::uint64_t seed) { o->seed = seed; }, "Seed of its random streams (0 to 2^64 - 1)");
  command->footer(
      "Example: verisim trace synth insertion -o insert.csv --set depth=0.3\n"
      "          verisim trace synth wii --trajectory natural --sensor wiimote -o head.csv\n"
      "          verisim trace synth encoder --path square -o square.csv --set length=2");
  command->callback([=, &exit_code] {
    synth(*o, *command);
    exit_code = 0;
  });
}

}  // namespace

void add_trace(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("trace", "Looks at, converts and synthesizes traces");
  command->require_subcommand(1);
  add_info(*command, exit_code);
  add_convert(*command, exit_code);
  add_synth(*command, exit_code);
}

}  // namespace verisim::cli

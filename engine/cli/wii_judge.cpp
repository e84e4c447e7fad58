#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/line_program.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/cli/wii_poses.hpp"
#include "engine/cli/wii_rows.hpp"
#include "engine/cli/wii_synth.hpp"
#include "engine/cli/wii_wire.hpp"
#include "engine/record/output_place.hpp"
#include "engine/wii/judge.hpp"
#include "engine/wii/validation_plot.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

struct JudgeCommand {
  std::string poses;  ///< a file, or NAME@HOST
  std::string program;
  std::string trace;
  VirtualRunOptions virtual_run;
  TraceLimits limits;
  std::string columns;
  std::string alignment = "none";
  std::string time_offset = "none";
  std::string name;
  double patience = 10;
  WireOptions wire;
  OutOptions out;
  bool json = false;
  bool markdown = false;
};

/// What the tracker is fed, or was, with the truth beside it.
struct Samples {
  std::string trajectory, sensor;
  std::vector<wii::SensedReport> reports;
};

Samples samples_of(const JudgeCommand& c, const CLI::App& command, std::vector<FileIdentity>& opened) {
  if (c.trace.empty()) {
    VirtualRun run = run_virtually(c.virtual_run, opened);
    return {run.trajectory, run.sensor, std::move(run.samples)};
  }
  refuse_virtual_remote(command, true, "--trace " + c.trace + " is what was seen");
  const wii::Recording recording = read_wii_file(c.trace, c.limits, &opened);
  if (recording.truth.empty())
    fail(ErrorKind::input, "{}: no columns px ... qw; a tracker can only be judged where the true poses are known",
         c.trace);
  Samples samples{fs::path(c.trace).stem().string(), "recorded", {}};
  for (std::size_t i = 0; i < recording.t.size(); ++i)
    samples.reports.push_back(
        {recording.t[i], recording.channels[i], recording.truth[i], wii::leds_by_count(recording.channels[i])});
  return samples;
}

std::vector<wii::Report> ask_program(const JudgeCommand& c, const std::vector<wii::SensedReport>& samples) {
  LineProgram program(c.program);
  std::vector<wii::Report> reports;
  for (const wii::SensedReport& s : samples) {
    const std::string answer = program.ask(fmt::format("{},{}", s.t, fmt::join(s.channels, ",")), c.patience);
    reports.push_back(parse_pose_line(fmt::format("'{}', line {}", c.program, reports.size() + 1), answer));
  }
  return reports;
}

wii::TimeOffset time_offset_of(const std::string& text) {
  using Of = wii::TimeOffset::Kind;
  if (text == "none") return {Of::given, 0};
  if (text == "start") return {Of::start, 0};
  if (text == "found") return {Of::found, 0};
  char* end = nullptr;
  const double seconds = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !std::isfinite(seconds))
    fail(ErrorKind::usage, "--time-offset {}: must be none, start, found or a number of seconds", text);
  return {Of::given, seconds};
}

wii::Alignment alignment_of(const std::string& text) {
  if (text == "yaw") return wii::Alignment::yaw;
  return text == "se3" ? wii::Alignment::se3 : wii::Alignment::none;
}

std::string alignment_text(const std::string& alignment, const Pose& X_TE) {
  if (alignment == "none") return "none";
  const Vector3d w = vector_from_rotation(X_TE.rotation) / wii::kDegree;
  const Vector3d& p = X_TE.position;
  return fmt::format("{}: turned by ({:.2f} {:.2f} {:.2f}) deg, shifted by ({:.4f} {:.4f} {:.4f}) m", alignment, w.x(),
                     w.y(), w.z(), p.x(), p.y(), p.z());
}

void print(const JudgeCommand& c, const wii::Judgement& j, std::size_t samples) {
  if (c.json) {
    Json out;
    out["rows"] = Json::array({row_json(j.row)});  // bare braces: g++ and clang++ differ
    const Vector3d& p = j.X_TE.position;
    const auto& q = j.X_TE.rotation.coeffs();
    out["alignment"] = c.alignment;
    out["aligned_by"] = {p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]};
    out["time_offset_s"] = j.offset;
    out["time_offset_better_s"] = j.offset_better ? Json(*j.offset_better) : nullptr;
    out["outside"] = j.outside;
    out["unanswered"] = j.unanswered;
    out["samples"] = samples;
    std::printf("%s\n", json_text(out).c_str());
    return;
  }
  std::printf("%s", (c.markdown ? wii::markdown_of({j.row}) : wii::table_of({j.row})).c_str());
  std::printf("alignment    %s\n", alignment_text(c.alignment, j.X_TE).c_str());
  const std::string better = j.offset_better
                                 ? fmt::format("positions fit best {:+.1f} ms from there", 1000 * *j.offset_better)
                                 : std::string("the head moves too little to find a better one");
  std::printf("time offset  %+.1f ms added to the tracker's times; %s\n", 1000 * j.offset, better.c_str());
  std::printf("samples      %zu, %d of them unanswered; %d reports beside no sample\n", samples, j.unanswered,
              j.outside);
}

void write_files(const JudgeCommand& c, const wii::Judgement& j, const std::vector<FileIdentity>& inputs) {
  write_row_files(c.out, {j.row}, inputs);
  write_text(stem_of(c.out) + "-time.svg",
             wii::history_plot(fmt::format("{}, {}", j.row.trajectory, j.row.sensor), {{j.row.tracker, j.history}}),
             c.out.force, inputs);
}

enum class Source { file, program, wire };

/// Error(usage) for an option that says nothing of this source.
void check_options_of(Source source, const JudgeCommand& c, const CLI::App& command) {
  const auto refuse = [&](bool is_of_another, const CLI::Option& option, const char* whose) {
    if (is_of_another) fail(ErrorKind::usage, "{}: is of {} alone; leave it out", option.get_name(), whose);
  };
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    if (option->get_group() == "Wire") refuse(source != Source::wire, *option, "a tracker NAME@HOST");
    if (option->check_name("--columns")) refuse(source != Source::file, *option, "a file of poses");
    if (option->check_name("--patience"))
      refuse(source == Source::file, *option, "a program and of a tracker NAME@HOST");
    if (option->check_name("--allow-gaps") || option->check_name("--resort"))
      refuse(c.trace.empty(), *option, "--trace");
  }
}

Source source_of(const JudgeCommand& c) {
  if (c.poses.empty() == c.program.empty())
    fail(ErrorKind::usage, "wii judge: name a file of poses, a tracker NAME@HOST, or --program CMD; one of them");
  if (!c.program.empty()) return Source::program;
  return c.poses.find('@') != std::string::npos && !fs::exists(c.poses) ? Source::wire : Source::file;
}

void judge(const JudgeCommand& c, const CLI::App& command) {
  const Source source = source_of(c);
  check_options_of(source, c, command);
  std::vector<FileIdentity> inputs;
  const Samples samples = samples_of(c, command, inputs);
  if (!c.out.path.empty()) check_row_files(c.out, inputs);
  wii::JudgeOptions options;
  options.time_offset = time_offset_of(c.time_offset);
  options.alignment = alignment_of(c.alignment);
  options.trajectory = samples.trajectory;
  options.sensor = samples.sensor;
  std::vector<wii::Report> reports;
  if (source == Source::program) {
    options.name = fs::path(c.program.substr(0, c.program.find(' '))).filename().string();
    reports = ask_program(c, samples.reports);
  } else if (source == Source::wire) {
    options.name = c.poses;
    reports = hear_tracker(c.poses, c.wire, c.patience, samples.reports);
  } else {
    options.name = fs::path(c.poses).filename().string();
    reports = read_poses(c.poses, c.columns, inputs);
  }
  if (!c.name.empty()) options.name = c.name;
  const wii::Judgement j = wii::judge(samples.reports, reports, options);
  if (!c.out.path.empty()) write_files(c, j, inputs);
  print(c, j, samples.reports.size());
}

}  // namespace

void add_wii_judge(CLI::App& wii_command, int& exit_code) {
  auto* command = wii_command.add_subcommand("judge", "A tracker of your own, by the measures of wii validate");
  auto o = std::make_shared<JudgeCommand>();
  command->add_option("POSES", o->poses,
                      "What it reported: wii track's CSV, TUM (t x y z qx qy qz qw), any CSV by --columns; or "
                      "Tracker0@HOST[:PORT], which is listened to while the remote plays for it over VRPN");
  command->add_option("--program", o->program,
                      "Or a command that is fed lines 't,battery,gx,…,s4' and answers each with 't,valid,px,…,qw'");
  command->add_option("--trace", o->trace,
                      "What it was fed: a wii trace with true poses (as many LEDs count as in view as blobs)");
  command->add_option("--columns", o->columns, "Names in the CSV: 't=time px=x py=y …', optionally valid=…");
  command
      ->add_option("--align", o->alignment,
                   "Bring its coordinates onto the truth's: none, yaw (a turn about up, a "
                   "shift), se3 (any turn, a shift)")
      ->check(CLI::IsMember({"none", "yaw", "se3"}));
  command->add_option("--time-offset", o->time_offset,
                      "Added to its times: none, start (its first report is at the first sample), found (where "
                      "positions fit best), or seconds");
  command->add_option("--name", o->name, "Of the row");
  command->add_option("--patience", o->patience, "Give up after so many seconds without an answer")->check(seconds());
  o->virtual_run.add(*command);
  add_seed_option(
      *command, [o](std::uint64_t seed) { o->virtual_run.seed = seed; }, "Seed of the virtual remote (0 to 2^64 - 1)");
  o->wire.add(*command);
  command->add_flag("--allow-gaps", o->limits.allow_gaps, "Accept gaps longer than 0.1 s in the trace");
  command->add_flag("--resort", o->limits.resort, "Sort the samples of the trace by time first");
  add_out_options(*command, o->out,
                  "Every figure to this CSV, plots beside it: FILE.svg, and FILE-time.svg over time; only such tables "
                  "and plots are replaced");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->add_flag("--markdown", o->markdown, "Position rms and availability alone, as a Markdown table");
  command->footer(
      "Example: verisim trace synth wii --trajectory natural -o head.csv\n"
      "         verisim wii judge poses.txt --trace head.csv --align yaw\n"
      "         verisim wii judge Tracker0@localhost:3884 --trajectory natural --serve-port 3883\n"
      "         (the other side reads WiiMote0@localhost:3883)\n"
      "         verisim wii judge --program './my_tracker' --trajectory natural --sensor noisy");
  command->callback([=, &exit_code] {
    judge(*o, *command);
    exit_code = 0;
  });
}

}  // namespace verisim::cli

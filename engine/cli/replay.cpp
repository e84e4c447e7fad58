#include <cstdio>
#include <memory>
#include <set>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/measure.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/stored_facts.hpp"
#include "engine/cli/stored_run.hpp"
#include "engine/contact/query.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/session.hpp"
#include "engine/session/summary.hpp"

namespace verisim::cli {
namespace {

void check_contents(const RunFile& file) {
  for (const InputFile& input : file.header().files) {
    if (!input.embedded)
      fail(ErrorKind::input,
           "{} was recorded with --no-embed: its content is not in the run file, so it cannot be replayed", input.name);
    if (sha256(input.content) != input.sha256)
      fail(ErrorKind::check_failed,
           "/inputs/files/{}: its content is not what its sha256 says; the run file is damaged", input.name);
  }
}

/// What a replay depends on is looked at before it starts: the inputs, how the run was called, what rows mean.
bool is_needed_to_replay(const std::string& altered) {
  return altered.starts_with("/inputs") || altered.starts_with("attribute 'invocation'") ||
         altered.starts_with("attribute 'format_version'");
}

/// Of pairs that keep their voxels' contacts format 1 told those of which one body alone had no b-rep.
bool is_later_than_format_1(const Event& event) {
  static const std::set<std::string> kinds = {"near",    "tunnelling", "energy",  "late contact", "gravity",
                                              "sinking", "voxels",     "overlap", "rounding"};
  if (kinds.count(event.kind) != 0) return true;
  const auto says = [&](const char* words) { return event.text.find(words) != std::string::npos; };
  return event.kind == "hybrid" && says("stay with the voxels") && !says("has no b-rep: its contacts with '");
}

void say_if_from_elsewhere(const RunFile& file) {
  if (is_from_here(file)) return;
  const auto text = [&](const char* name) {
    const auto found = file.header().attributes.find(name);
    const bool there = found != file.header().attributes.end() && std::holds_alternative<std::string>(found->second);
    return there ? shown(std::get<std::string>(found->second)) : std::string("unknown");
  };
  std::fprintf(stderr, "notice: written by verisim %s (commit %s), this is %s (commit %s)\n", text("version").c_str(),
               text("commit").c_str(), VERISIM_VERSION, commit().c_str());
}

struct Replay {
  std::string path;
  bool verify = false, measure = false;
};

std::vector<MeasuredPair> measured(const Replay& asked, const RunFile& file, std::vector<MeasuredBody> bodies,
                                   const SimulateOptions& o) {
  if (!asked.measure) return {};
  return measure_run(file, std::move(bodies), ProgressLine(!o.quiet));
}

void tell(const Replay& asked, const RunFile& file, const std::string& hash, const std::vector<MeasuredPair>& measured,
          const SimulateOptions& o) {
  if (o.json) {
    Json report = {{"run_file", asked.path}, {"frames", file.rows()}, {"state_hash", hash}, {"verified", asked.verify}};
    if (asked.measure) report["measured"] = json_of(measured);
    std::printf("%s\n", json_text(report).c_str());
  } else if (!o.quiet) {
    std::printf("%s: %zu frames simulated again, state hash %s%s\n", asked.path.c_str(), file.rows(), hash.c_str(),
                !asked.verify ? ""
                : file.format_version() < 2
                    ? ", every value of /state and /events equal"
                    : ", every value of /state, /cost and /events, every attribute and figure equal");
    if (asked.measure) std::fputs(table_of(measured).c_str(), stdout);
  }
}

void say_if_left_open(const RunFile& file, const std::string& path) {
  if (!file.recovered()) return;
  std::fprintf(stderr, "notice: %s was left open by a killed run and %s\n", path.c_str(),
               file.closed_in_place() ? "has been closed" : "stays so: its folder cannot be written");
}

int replay(const Replay& asked, const SimulateOptions& o) {
  const std::string& path = asked.path;
  const bool verify = asked.verify;
  use_simd_target(o.simd);
  const RunFile file(path);
  say_if_left_open(file, path);
  say_if_from_elsewhere(file);
  const bool is_format_1 = file.format_version() < 2;
  const auto differs = [&](const std::string& difference) {
    if (!difference.empty()) fail(ErrorKind::check_failed, "{}: {}", path, difference);
  };
  // Format 1 had no checksums; a file that has some is no such file, whatever it says.
  const bool has_checksums = !is_format_1 || file.header().attributes.count("checksums") != 0;
  const std::vector<std::string> altered = verify && has_checksums ? file.altered() : std::vector<std::string>();
  for (const std::string& what : altered)
    if (is_needed_to_replay(what)) differs(what);
  check_contents(file);
  const ScenarioOptions options = options_from_header(file.header());
  auto inputs = std::make_unique<Inputs>(Inputs::stored(file.header().files, file.header().models));
  std::vector<MeasuredBody> bodies;
  Session session = open_session(options, std::move(inputs), o.threads, true, [&](const Scene& scene) {
    if (asked.measure) bodies = measured_bodies(scene);
  });
  Simulation& simulation = *session.simulation;

  Schema schema;
  simulation.describe(schema);
  const std::unique_ptr<StoredRun> stored = verify ? std::make_unique<StoredRun>(file, simulation) : nullptr;
  if (verify && is_format_1)
    std::fprintf(
        stderr,
        "notice: %s is of format 1: its states and attributes are compared; its hashes, work counts and summary "
        "are of other things\n",
        path.c_str());
  std::vector<std::byte> row(schema.row_bytes());
  std::vector<Event> events;
  for (std::size_t i = 0; i < file.rows(); ++i) {
    simulation.step();
    simulation.write_row(row.data());
    for (const Event& event : simulation.events())
      if (!is_format_1 || !is_later_than_format_1(event)) events.push_back(event);
    simulation.clear_events();
    if (!verify) continue;
    differs(stored->difference_in_frame(i, row, simulation));
  }
  if (!is_format_1 && !file.summary().empty())  // else it was killed before its end
    for (const Event& event : simulation.last_events()) events.push_back(event);
  const std::string hash = to_hex(simulation.state_hash());
  if (verify) {
    // The pairs that are near at the start belong to the first frame.
    if (file.rows() > 0) differs(stored->difference_in_pairs(simulation));
    differs(difference_in_events(file, events, simulation.time()));
    differs(difference_in_attributes(file, session));
    differs(difference_in_summary(file, session));
    if (!altered.empty()) differs(altered.front());
  }
  tell(asked, file, hash, measured(asked, file, std::move(bodies), o), o);
  return 0;
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("replay", "Simulates again from the run file alone");
  auto asked = std::make_shared<Replay>();
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("RUN.h5", asked->path, "Run file")->required();
  command->add_flag(
      "--verify", asked->verify,
      "Compare every row, event, attribute and figure, and the checksums of what cannot be computed again; name "
      "the first frame, field or attribute that differs (exit 1)");
  command->add_flag(
      "--measure", asked->measure,
      "Measure the true overlap of every pair that came near, in every frame, from the recorded poses "
      "and the shapes alone, beside the recorded penetration: a line per pair with the frames in which "
      "either was largest and in which they differ most; --json has every frame. Meshes are measured twice: between "
      "their triangles and between the surfaces that their faces were recovered as");
  add_speed_options(*command, options->threads, options->simd);
  command->add_flag("--json", options->json, "One JSON object on stdout");
  command->add_flag("--quiet", options->quiet, "Say nothing");
  command->footer(
      "Example: verisim replay runs/peg_in_hole.h5 --verify\n"
      "         verisim replay runs/peg_in_hole.h5 --verify --measure");
  command->callback([=, &exit_code] { exit_code = replay(*asked, *options); });
}

}  // namespace verisim::cli

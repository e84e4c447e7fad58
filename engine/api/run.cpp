#include <verisim/run.hpp>

#include <filesystem>
#include <memory>

#include "engine/api/failures.hpp"
#include "engine/base/text.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/recorded_run.hpp"
#include "engine/session/warnings.hpp"

namespace verisim {

struct Frame::Implementation {
  const Simulation& simulation;
  std::vector<std::string> bodies;

  [[nodiscard]] std::size_t index_of(const std::string& body) const {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i] == body) return i;
    throw Failure(static_cast<int>(ErrorKind::usage), unknown_name("body", body, bodies));
  }
};

std::uint64_t Frame::number() const {
  return implementation_.simulation.frame();
}
double Frame::time() const {
  return implementation_.simulation.time();
}
const std::vector<std::string>& Frame::bodies() const {
  return implementation_.bodies;
}
std::array<double, 7> Frame::pose(const std::string& body) const {
  const Pose X = implementation_.simulation.body_pose(implementation_.index_of(body));
  const Quaterniond& q = X.rotation;
  return {X.position.x(), X.position.y(), X.position.z(), q.x(), q.y(), q.z(), q.w()};
}
std::array<double, 6> Frame::velocity(const std::string& body) const {
  const auto [v, w] = implementation_.simulation.body_twist(implementation_.index_of(body));
  return {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}
std::array<double, 6> Frame::contact_wrench(const std::string& body) const {
  const auto [f, t] = implementation_.simulation.body_force(implementation_.index_of(body));
  return {f.x(), f.y(), f.z(), t.x(), t.y(), t.z()};
}

namespace {

/// What the command line refuses of its arguments: it would be cut at a NUL, or end in the run file and in messages.
void check_texts(const RunRequest& request) {
  if (request.scenario.empty()) fail(ErrorKind::usage, "scenario: is empty; name a Lua file");
  check_line("scenario", request.scenario);
  check_line("out", request.out);
  for (const auto& [name, value] : request.parameters) {
    check_line("a parameter's name", name);
    if (const std::string fault = value_fault(value); !fault.empty())
      fail(ErrorKind::usage, "{} {}: '{}'; write it as UTF-8", name, fault, shown(value, 60));
  }
  for (const auto& [name, source] : request.binds) {
    check_line("a bind's name", name);
    check_line("bind " + name, source);
  }
}

RunOutcome outcome_of(const RecordedRun& run) {
  RunOutcome outcome;
  outcome.end = run.figures.end;
  outcome.error = run.loop.error;
  outcome.outcome = run.figures.outcome;
  outcome.state_hash = run.figures.state_hash;
  outcome.frames = run.figures.frames;
  outcome.simulated_s = run.figures.simulated_s;
  for (const Measure& measure : run.figures.measures) outcome.measures[measure.name] = measure.value;
  outcome.warnings = run.loop.warnings;
  if (const std::string fallback = fallback_warning(run.figures); !fallback.empty())
    outcome.warnings.push_back(fallback);
  outcome.json = to_json(run.figures);
  outcome.out = run.figures.run_file;
  return outcome;
}

RunOutcome run_to_its_end(const RunRequest& request) {
  check_texts(request);
  if (request.threads == 0) fail(ErrorKind::usage, "threads: 0; at least one is wanted");
  ScenarioOptions options;
  options.path = end_of_links(request.scenario);
  options.sets = request.parameters;
  options.binds = request.binds;
  options.seed = request.seed;
  options.duration = request.duration;
  const std::shared_ptr<PreparedStore> store = prepared_parts(request.prepared);
  auto inputs = std::make_unique<Inputs>(
      Inputs::live(std::filesystem::path(options.path).parent_path().string(), named_paths(options), store));
  std::vector<std::string> warnings;
  options.print = request.print ? request.print : [](const std::string& /*line*/) {};
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  std::vector<std::string> bodies;
  Session session = open_session(options, std::move(inputs), request.threads, true, [&](const Scene& scene) {
    for (const BodyDescription& body : scene.bodies) bodies.push_back(body.name);
  });
  for (const Event& event : session.simulation->events())
    if (is_warning(event) || event.kind == "warning") warnings.push_back(event.text);
  const Frame::Implementation frame{*session.simulation, std::move(bodies)};
  RecordOptions record{.file = request.out, .another_name = request.another_name, .force = request.force};
  if (request.each_frame) record.after_frame = [&] { return request.each_frame(Frame(frame)); };
  const RecordedRun run = record_run(session, record);
  if (run.loop.end == LoopEnd::io_failed || run.loop.end == LoopEnd::refused)
    fail(static_cast<ErrorKind>(exit_code_of(run.loop.end)), "{}", run.loop.error);
  if (const std::string damage = damage_warning(store.get()); !damage.empty()) warnings.push_back(damage);
  RunOutcome outcome = outcome_of(run);
  outcome.warnings.insert(outcome.warnings.begin(), warnings.begin(), warnings.end());
  return outcome;
}

}  // namespace

RunOutcome run(const RunRequest& request) {
  return with_failures([&] { return run_to_its_end(request); });
}

std::string version() {
  return VERISIM_VERSION;
}

}  // namespace verisim

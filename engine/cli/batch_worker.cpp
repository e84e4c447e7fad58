#include "engine/cli/batch_worker.hpp"
#include "engine/base/json.hpp"

#include <cctype>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/batch/conditions.hpp"
#include "engine/batch/folder.hpp"
#include "engine/cli/measure.hpp"
#include "engine/cli/memory_wanted.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/recorded_run.hpp"
#include "engine/session/warnings.hpp"
#include "engine/simulation/frame_cost.hpp"

namespace verisim::cli {
namespace {

using batch::Answer;
using batch::Cell;
using batch::IndexColumn;

constexpr const char* kRunFile = "run_file";  // of a run's figures the one that is neither computed nor measured

Cell cell_of(const RunFigure::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return batch::cell_of(*count);
  if (const auto* flag = std::get_if<bool>(&value)) return std::int64_t{*flag ? 1 : 0};
  return {};
}

const char* type_of(const RunFigure::Value& value) {
  if (std::holds_alternative<std::string>(value)) return "TEXT";
  return std::holds_alternative<double>(value) ? "REAL" : "INTEGER";
}

bool is_in_timing(const RunFigure& figure) {
  return figure.only_once && std::string(figure.name) != kRunFile;
}

/// A figure's columns: of times three.
template <typename Take>
void for_each_column(const RunFigure& figure, const RunFigures& run, const Take& take) {
  const RunFigure::Value value = figure.value(run);
  if (const auto* times = std::get_if<RunFigures::Times>(&value)) {
    for (const auto& [name, ns] : {std::pair{"p50", times->p50}, {"p99", times->p99}, {"max", times->max}})
      take(std::string(figure.name) + "." + name, RunFigure::Value(std::uint64_t{ns}));
  } else {
    take(figure.name, value);
  }
}

void add_own_columns(batch::Layout& layout, bool measure) {
  layout.figures.push_back(
      {"insertion_s", "REAL", "s", "simulated time at which the outcome became inserted or assembled and stayed so"});
  layout.figures.push_back(
      {"warnings", "INTEGER", "1", "warnings of the scene and of its frames, errors of frame actions among them"});
  layout.figures.push_back({"warning", "TEXT", "", "the first of them"});
  if (measure)
    for (const IndexColumn& c :
         {IndexColumn{"overlap_m", "REAL", "m", "deepest true overlap of two bodies, by the ruler, from poses alone"},
          {"overlap_bound_m", "REAL", "m", "the true overlap is at most so much deeper"},
          {"overlap_pair", "TEXT", "", "the two bodies"},
          {"overlap_unmeasured", "TEXT", "", "a pair that the ruler cannot measure, and why"}})
      layout.figures.push_back(c);
  for (std::size_t kind = 1; kind < kConstraintKindNames.size(); ++kind)
    layout.figures.push_back({std::string("constraints.") + kConstraintKindNames[kind], "INTEGER", "1",
                              "frames in which a pair stood under this constraint"});
  for (const CostCounter& counter : kCostCounters)
    layout.figures.push_back({std::string("cost.") + counter.name, "INTEGER", counter.unit,
                              std::string(counter.meaning) + "; summed over all frames"});
}

void add_process_columns(batch::Layout& layout) {
  for (const IndexColumn& c : {IndexColumn{"process_s", "REAL", "s", "wall clock from the process's start to its end"},
                               {"user_s", "REAL", "s", "processor time of the run's process, in the program"},
                               {"system_s", "REAL", "s", "processor time of the run's process, in the system"},
                               {"memory_bytes", "INTEGER", "B", "the most memory that the process had resident"},
                               {"answered", "INTEGER", "1", "0: what ended the run would not have to end it again"}})
    layout.timing.push_back(c);
  for (const IndexColumn& c : batch::condition_columns()) layout.timing.push_back(c);
}

bool is_taken(const std::vector<std::string>& names, const std::string& name) {
  const auto lower = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
  };
  for (const std::string& known : names)
    if (lower(known) == lower(name)) return true;
  return false;
}

/// What the ruler finds, over all pairs and frames.
void add_overlap(Answer& answer, const std::string& file, std::vector<MeasuredBody> bodies) {
  const RunFile recorded(file);
  double deepest = -1;
  for (const MeasuredPair& pair : measure_run(recorded, std::move(bodies), ProgressLine(false))) {
    const std::string name = pair.first + " ~ " + pair.second;
    if (!pair.why_not.empty()) {
      answer.figures["overlap_unmeasured"] = name + ": " + pair.why_not;
      continue;
    }
    const MeasuredPair::Measured& by = pair.measured.front();
    for (std::size_t frame = 0; frame < by.overlap.size(); ++frame) {
      if (by.overlap[frame] <= deepest) continue;
      deepest = by.overlap[frame];
      answer.figures["overlap_m"] = by.overlap[frame];
      answer.figures["overlap_bound_m"] = by.bound[frame];
      answer.figures["overlap_pair"] = name;
    }
  }
}

void add_figures(Answer& answer, const Session& session, const RunFigures& figures, const FrameCost& cost) {
  for (const RunFigure& figure : run_figures())
    for_each_column(figure, figures, [&](const std::string& name, const RunFigure::Value& value) {
      (is_in_timing(figure) ? answer.timing : answer.figures)[name] = cell_of(value);
    });
  if (figures.outcome == "inserted" || figures.outcome == "assembled")
    answer.figures["insertion_s"] = session.scenario->outcome_since();
  for (std::size_t kind = 1; kind < kConstraintKindNames.size(); ++kind)
    answer.figures[std::string("constraints.") + kConstraintKindNames[kind]] = std::int64_t{0};
  for (const auto& [name, frames] : figures.constraints) answer.figures["constraints." + name] = batch::cell_of(frames);
  for (const CostCounter& counter : kCostCounters)
    answer.figures[std::string("cost.") + counter.name] = batch::cell_of(cost.*counter.count);
  answer.measures = figures.measures;
}

std::string status_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::done:
      return "done";
    case LoopEnd::diverged:
      return "diverged";
    default:
      return "failed";
  }
}

Answer refusal(const Error& error) {
  if (error.kind() == ErrorKind::io || error.kind() == ErrorKind::interrupted) throw error;
  Answer answer;
  answer.status = error.kind() == ErrorKind::diverged ? "diverged" : "failed";
  answer.error = shown(error.what());
  // Lua's memory is bounded by the sandbox, whose text says so.
  const auto says = [&](const char* text) { return answer.error.find(text) != std::string::npos; };
  if (says(" MiB of memory")) answer.status = "memory";
  // What the process had too little of: with more of it there may be another answer.
  if (!says("out of memory") && !says("Cannot allocate memory")) return answer;
  answer.status = "memory";
  answer.answered = false;
  return answer;
}

Answer out_of_memory() {
  Answer answer;
  answer.status = "memory";
  answer.error = out_of_memory_text();
  answer.answered = false;
  return answer;
}

/// What the run found of its prepared parts: the worker's own look-ups, for its store came from the batch unused.
std::string state_of(const PreparedStore* store) {
  if (store == nullptr) return "off";
  if (store->missed() == 0) return store->found() == 0 ? "unused" : "warm";
  return store->found() == 0 ? "cold" : "partly";
}

/// How many warnings the run gave, and the first: those of the scene, then those of its frames.
void add_warnings(Answer& answer, const std::vector<std::string>& of_scene, const LoopResult& of_frames) {
  const std::uint64_t count = of_scene.size() + of_frames.warning_count;
  answer.figures["warnings"] = batch::cell_of(count);
  if (count > 0) answer.figures["warning"] = shown(of_scene.empty() ? of_frames.first_warning : of_scene.front());
}

/// Parameters as the run used them: precision = "auto" chooses some, and some are overruled.
void add_parameters(Answer& answer, const Session& session) {
  const auto parameters = parse_json(session.scenario->parameters_in_effect_json());
  for (const auto& [name, value] : parameters.items()) answer.parameters[name] = batch::cell_of(value);
}

/// @param inputs  what the run reads; the session's once that is open
Answer computed(const BatchRunOptions& options, const ScenarioOptions& scenario, std::uint64_t run,
                std::unique_ptr<Inputs>& inputs, Session& session) {
  const bool recorded = options.measure || options.keep != BatchRunOptions::Keep::summary;
  const std::string file = options.folder + "/" + batch::Folder::run_file(run);
  inputs = std::make_unique<Inputs>(
      Inputs::live(std::filesystem::path(scenario.path).parent_path().string(), named_paths(scenario), options.store));
  std::vector<MeasuredBody> bodies;
  session = open_session(scenario, std::move(inputs), options.threads, false, [&](const Scene& scene) {
    if (options.measure) bodies = measured_bodies(scene);
  });
  std::vector<std::string> warnings;
  for (const Event& event : session.simulation->events())
    if (is_any_warning(event)) warnings.push_back(event.text);
  FrameCost cost;
  RecordedRun made = record_run(session, {.file = recorded ? file : "", .force = true, .after_frame = [&] {
                                            for (const CostCounter& counter : kCostCounters)
                                              cost.*counter.count += session.simulation->cost().*counter.count;
                                            return true;
                                          }});
  if (made.loop.end == LoopEnd::io_failed) fail(ErrorKind::io, "{}", made.loop.error);
  Answer answer;
  answer.status = status_of(made.loop.end);
  answer.error = shown(made.loop.error);
  add_figures(answer, session, made.figures, cost);
  add_parameters(answer, session);
  add_warnings(answer, warnings, made.loop);
  print_warnings(made.loop.warnings);
  if (options.measure) add_overlap(answer, file, std::move(bodies));
  warn_of_damage(options.store.get());
  return answer;
}

}  // namespace

batch::Layout layout_of_runs(const std::vector<ParameterDeclaration>& declared, bool measure) {
  batch::Layout layout;
  std::vector<std::string> taken = {"run", "seed", "status", "error"};
  for (const RunFigure& figure : run_figures())
    for_each_column(figure, {}, [&](const std::string& name, const RunFigure::Value& value) {
      (is_in_timing(figure) ? layout.timing : layout.figures)
          .push_back({name, type_of(value), figure.unit, figure.meaning});
    });
  add_own_columns(layout, measure);
  add_process_columns(layout);
  for (const auto& columns : {layout.figures, layout.timing})
    for (const IndexColumn& c : columns) taken.push_back(c.name);
  for (const ParameterDeclaration& p : declared) {
    std::string name = p.name;
    while (is_taken(taken, name)) name = "parameter." + name;
    taken.push_back(name);
    layout.parameters.push_back({name, p.type == "number" ? "REAL" : "TEXT", p.unit, p.meaning});
  }
  return layout;
}

void remove_run_files(const BatchRunOptions& options, std::uint64_t run) {
  const std::string file = options.folder + "/" + batch::Folder::run_file(run);
  std::error_code ignored;
  for (const char* suffix : {"", ".part"}) std::filesystem::remove(file + suffix, ignored);
}

Answer answer_of_run(const BatchRunOptions& options, const ScenarioOptions& scenario, std::uint64_t run) {
  Answer answer;
  std::unique_ptr<Inputs> inputs;
  Session session;
  try {
    answer = computed(options, scenario, run, inputs, session);
  } catch (const Error& error) {
    answer = refusal(error);
  } catch (const std::bad_alloc&) {
    answer = out_of_memory();
  } catch (const std::length_error&) {  // more than any memory could hold
    answer = out_of_memory();
  }
  answer.timing["cache"] = state_of(options.store.get());
  // Of a run that was refused, too: what it read may have been changed since the batch began.
  if (const Inputs* read = session.inputs ? session.inputs.get() : inputs.get())
    for (const InputFile& input : read->files()) answer.inputs[input.name] = input.sha256;
  return answer;
}

}  // namespace verisim::cli

#include "engine/cli/tradeoff_sweep.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/random.hpp"
#include "engine/base/text.hpp"
#include "engine/batch/distribution.hpp"
#include "engine/cli/options.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/session.hpp"
#include "engine/simulation/frame_cost.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;
using tradeoff::Kind;
using tradeoff::Table;

/// The dials by the names that the project's own scenarios use, and what they are without one.
struct Dial {
  const char* parameter;
  const char* what;
};
constexpr Dial kDials[] = {{"voxelsize", "the voxel size"},          {"spacing", "the spacing of points"},
                           {"integrator", "the integrator"},         {"timestep", "the time step"},
                           {"hybrid", "the hybrid method"},          {"contact", "the contact method"},
                           {"alignment", "the measure of alignment"}};
constexpr double kStepRatio = 2;  // of the truth's steps, by which its order is observed

/// Dials whose smaller value is the finer one.
constexpr const char* kFinerIsSmaller[] = {"voxelsize", "spacing", "timestep"};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The same bodies, untouched.
std::vector<tradeoff::BodyMotion> without_force(const tradeoff::Motion& motion) {
  std::vector<tradeoff::BodyMotion> bodies = motion.bodies;
  for (tradeoff::BodyMotion& body : bodies) body.wrench.clear();
  return bodies;
}

}  // namespace

/// What is known of one repetition.
struct Sweep::Repetition {
  std::uint64_t number = 0;
  Trial trial;
  tradeoff::Motion motion;
};

/// How a truth's force depends on its step.
struct Sweep::StepStudy {
  std::uint64_t seed = 0;
  std::string failed;  ///< a coarser step could not be run
  tradeoff::Convergence found;
  bool has_force = false;
};

/// What the repetitions of one setting gave.
struct Sweep::Measured {
  std::string failed;
  std::vector<double> contact_us, frame_us;
  std::vector<std::uint64_t> cost;
  std::uint64_t frames = 0;
  double simulated_s = 0, all_us = 0;
  std::vector<tradeoff::Errors> errors;
  std::vector<std::uint64_t> seeds;
};

Sweep::Sweep(const SweepRequest& request) : request_(request) {
  scenario_.path = end_of_links(request.scenario);
  scenario_.sets = split_pairs("--set", request.sets);
  scenario_.binds = split_pairs("--bind", request.binds);
  scenario_.duration = request.duration;
  scenario_.ignores_precision = true;
  store_ = prepared_parts(!request.no_cache);
  constexpr double kHour = 3600;
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  limits_.time_s = request.time_limit_s.value_or(kHour);
  limits_.memory_bytes =
      request.memory_limit_mb > 0 ? request.memory_limit_mb * kMebibyte : batch::physical_memory() / 10 * 8;
  if (request.vary.empty())
    fail(ErrorKind::usage,
         "nothing is varied: the sweep is empty; write --vary KEY=V1,V2; {} has parameters that "
         "'verisim run {} --parameters' lists",
         request.scenario, request.scenario);
  Inputs inputs = Inputs::live(fs::path(scenario_.path).parent_path().string(), named_paths(scenario_));
  DeclaredParameters parameters(scenario_, inputs);
  declared_ = parameters.all();
  scenario_sha256_ = sha256(inputs.read(fs::path(scenario_.path).filename().string()));
  batch::DesignRequest design;
  design.vary = request.vary;
  for (const auto& [key, value] : scenario_.sets) design.set_keys.push_back(key);
  design.repeat = 1;
  design.seed = request.seed;
  const auto value_of = [&](const std::string& option, const std::string& key, const std::string& text) {
    return batch::cell_of(parse_json(parameters.value_of(key, text, option)));
  };
  design_ = batch::make_design(design, value_of);
  if (design_.runs() < 2)
    fail(ErrorKind::usage, "one setting only: there is nothing to trade; give --vary two values or more");
  truth_sets_ = split_pairs("--truth", request.truth);
  std::map<std::string, batch::Cell> truth_values;
  for (const auto& [key, text] : truth_sets_) truth_values[key] = value_of("--truth", key, text);
  if (truth_sets_.empty())
    make_truth();
  else
    say_where_truth_is_not_finer(truth_values);
  say_what_the_truth_has_of_its_own();
  if (request.threads != 1) notes_.push_back(fmt::format("times are of runs of {} threads each", request.threads));
  say_what_is_not_reached();
}

/// hybrid=exact at a tenth of the step and the finest of each dial.
void Sweep::make_truth() {
  constexpr double kTenth = 0.1;
  truth_step_scale_ = kTenth;
  for (const batch::Axis& axis : design_.axes) {
    const batch::Value* finest = nullptr;
    for (const char* dial : kFinerIsSmaller)
      if (axis.key == dial)
        for (const batch::Value& value : axis.values)
          if (std::holds_alternative<double>(value.cell) &&
              (finest == nullptr || std::get<double>(value.cell) < std::get<double>(finest->cell)))
            finest = &value;
    if (finest != nullptr) truth_sets_.emplace_back(axis.key, finest->text);
  }
  for (const ParameterDeclaration& p : declared_) {
    if (p.type != "string") continue;
    if (p.name == "hybrid") truth_sets_.emplace_back("hybrid", "exact");
    if (p.name == "contact") truth_sets_.emplace_back("contact", "voxmap");
    if (p.name == "integrator") truth_sets_.emplace_back("integrator", "implicit");
  }
}

std::string Sweep::truth_text() const {
  std::vector<std::string> words;
  for (const auto& [key, text] : truth_sets_) words.push_back(key + "=" + text);
  if (truth_step_scale_ != 1) words.push_back(fmt::format("{:g} of the scenario's step", truth_step_scale_));
  return joined(words) + (request_.truth.empty() ? " (by default)" : " (as --truth says)");
}

/// The named dials that no parameter of the scenario reaches.
void Sweep::say_what_is_not_reached() {
  std::vector<std::string> missing;
  for (const Dial& dial : kDials) {
    const auto found = std::find_if(declared_.begin(), declared_.end(),
                                    [&](const ParameterDeclaration& p) { return p.name == dial.parameter; });
    if (found == declared_.end()) missing.push_back(fmt::format("{} ('{}')", dial.what, dial.parameter));
  }
  if (!missing.empty())
    notes_.push_back(fmt::format("no parameter of {} reaches {}; declare it in params{{}} to vary it",
                                 fs::path(scenario_.path).filename().string(), joined(missing)));
}

/// A truth that a user names is taken as it is. Where it is not finer than what it judges, an error of 0 says that two
/// settings agree, not that they are right.
void Sweep::say_where_truth_is_not_finer(const std::map<std::string, batch::Cell>& truth) {
  for (const std::string dial : kFinerIsSmaller) {
    const auto declared =
        std::find_if(declared_.begin(), declared_.end(), [&](const ParameterDeclaration& p) { return p.name == dial; });
    const bool is_step = dial == "timestep";
    if (declared == declared_.end()) {
      if (is_step)
        notes_.emplace_back("the truth's step is that of the settings: no parameter 'timestep' makes it finer");
      continue;
    }
    const auto number = [](const batch::Cell& cell) {
      const auto* const value = std::get_if<double>(&cell);
      return value == nullptr ? 0.0 : *value;  // 0: not a length or time of its own, as spacing = 0 in our scenes
    };
    const double usual = number(batch::cell_of(parse_json(declared->value_json)));
    const auto named = truth.find(dial);
    const double of_truth = named == truth.end() ? usual : number(named->second);
    double finest = usual;
    for (const batch::Axis& axis : design_.axes)
      if (axis.key == dial) {
        finest = number(axis.values.front().cell);
        for (const batch::Value& value : axis.values) finest = std::min(finest, number(value.cell));
      }
    if (of_truth <= 0 || finest <= 0 || of_truth < finest || (of_truth == finest && !is_step)) continue;
    notes_.push_back(
        fmt::format("the truth's {0} ({1:g}) is not finer than that of the settings that it judges "
                    "({2:g}): an error against it is a difference; name a finer one with --truth {0}=…",
                    dial, of_truth, finest));
  }
}

/// Of what is varied and no dial, as a size of the scene, the truth has one value: an error against it is then no
/// setting's.
void Sweep::say_what_the_truth_has_of_its_own() {
  const bool is_default = request_.truth.empty();
  for (const batch::Axis& axis : design_.axes) {
    const auto is_axis = [&](const auto& named) { return axis.key == named.first; };
    const bool is_dial =
        std::any_of(std::begin(kDials), std::end(kDials), [&](const Dial& d) { return axis.key == d.parameter; });
    const bool is_compared = std::any_of(std::begin(kFinerIsSmaller), std::end(kFinerIsSmaller),
                                         [&](const char* dial) { return axis.key == dial; });
    if (std::any_of(truth_sets_.begin(), truth_sets_.end(), is_axis) || is_compared || (is_dial && is_default))
      continue;
    for (const ParameterDeclaration& p : declared_)
      if (p.name == axis.key)
        notes_.push_back(
            fmt::format("the truth's {0} is {1}, the scenario's own, for all settings: where they have another, what "
                        "that changes in the scene is an error, too; {2}",
                        axis.key, shown(p.value_json, 40),
                        is_dial ? fmt::format("name one with --truth {}=…", axis.key)
                                : fmt::format("sweep it apart: --set {}=… in place of --vary", axis.key)));
  }
}

TrialSetting Sweep::setting_of(std::size_t setting, std::uint64_t repetition) const {
  TrialSetting trial{.scenario = scenario_, .store = store_, .threads = request_.threads};
  trial.scenario.seed = batch::seed_of_repetition(request_.seed, repetition);
  const batch::Point point = design_.point(setting);
  const std::vector<std::string> keys = design_.keys();
  for (std::size_t i = 0; i < keys.size(); ++i) trial.scenario.sets.emplace_back(keys[i], point.values[i].text);
  return trial;
}

TrialSetting Sweep::truth_of(std::uint64_t repetition, double step_scale) const {
  TrialSetting trial{.scenario = scenario_, .store = store_, .threads = request_.threads};
  trial.scenario.step_scale = step_scale;
  trial.scenario.seed = batch::seed_of_repetition(request_.seed, repetition);
  auto& sets = trial.scenario.sets;
  for (const auto& [key, text] : truth_sets_) {
    std::erase_if(sets, [&key = key](const auto& set) { return set.first == key; });
    sets.emplace_back(key, text);
  }
  return trial;
}

std::string Sweep::in_a_process(const std::function<std::string()>& work) {
  batch::Workers workers(1, limits_, [&](std::uint64_t /*run*/) { return work(); });
  workers.begin(0);
  while (true) {
    constexpr double kLook = 1;  // s
    const std::vector<batch::WorkerEnd> ends = workers.wait(kLook);
    if (was_interrupted()) fail(ErrorKind::interrupted, "interrupted");
    if (ends.empty()) continue;
    const batch::WorkerEnd& end = ends.front();
    if (end.exit_code == 0) return end.answer;
    const bool has_words = end.exit_code > 0 && !end.out_of_memory && !end.timed_out && !end.last_words.empty();
    fail(ErrorKind::input, "{}", has_words ? shown(end.last_words) : batch::why_no_answer(end, limits_));
  }
}

void Sweep::say_progress() {
  ++runs_done_;
  const std::uint64_t all = request_.repeat * (design_.runs() + 1);
  line_->say(fmt::format("  {} of {} runs", runs_done_, all));
}

Sweep::Repetition Sweep::run_truth(std::uint64_t number) {
  Repetition repetition{.number = number, .trial = {}, .motion = {}};
  const TrialSetting truth = truth_of(number, truth_step_scale_);
  try {
    repetition.trial = trial_from(in_a_process([&] { return bytes_of(run_trial(truth, true)); }));
    repetition.motion = motion_from(in_a_process(
        [&] { return bytes_of(run_driven(truth, repetition.trial.tracks, repetition.trial.simulated_s)); }));
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    fail(ErrorKind::input, "the truth fails ({}; repetition {}): {}; name another with --truth", truth_text(), number,
         error.what());
  }
  say_progress();
  return repetition;
}

void Sweep::run_setting(std::size_t setting, const Repetition& repetition, Measured& measured) {
  const TrialSetting trial_setting = setting_of(setting, repetition.number);
  try {
    const Trial trial = trial_from(in_a_process([&] { return bytes_of(run_trial(trial_setting, false)); }));
    const tradeoff::Motion motion = motion_from(in_a_process(
        [&] { return bytes_of(run_driven(trial_setting, repetition.trial.tracks, repetition.trial.simulated_s)); }));
    measured.frame_us.push_back(trial.frame_us);
    measured.contact_us.push_back(trial.contact_us > 0 ? trial.contact_us : trial.frame_us);
    measured.frames += trial.frames;
    measured.simulated_s += trial.simulated_s;
    measured.all_us += trial.mean_us * static_cast<double>(trial.frames);
    measured.seeds.push_back(*trial_setting.scenario.seed);
    measured.cost.resize(kCostCounters.size());
    for (std::size_t i = 0; i < kCostCounters.size(); ++i) measured.cost[i] += trial.cost[i];
    measured.errors.push_back(
        tradeoff::errors_of(repetition.motion, motion, trial.outcome != repetition.trial.outcome));
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    measured.failed = fmt::format("seed {}: {}", *trial_setting.scenario.seed, error.what());
  }
  say_progress();
}

/// The same motion at four, two and one of the truth's steps.
Sweep::StepStudy Sweep::study_step(const Repetition& repetition) {
  StepStudy study{.seed = batch::seed_of_repetition(request_.seed, repetition.number), .failed = {}, .found = {}};
  study.has_force = tradeoff::force_difference(repetition.motion, {.bodies = without_force(repetition.motion)}) > 0;
  if (!study.has_force) return study;
  try {
    const auto at = [&](double scale) {
      const TrialSetting truth = truth_of(repetition.number, truth_step_scale_ * scale);
      return motion_from(in_a_process(
          [&] { return bytes_of(run_driven(truth, repetition.trial.tracks, repetition.trial.simulated_s)); }));
    };
    const tradeoff::Motion coarse = at(kStepRatio * kStepRatio), middle = at(kStepRatio);
    study.found = tradeoff::convergence_of(tradeoff::force_difference(coarse, middle),
                                           tradeoff::force_difference(middle, repetition.motion), kStepRatio);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    study.failed = error.what();
  }
  return study;
}

/// What is known of the truth's own error, of all repetitions.
void Sweep::tell_convergence(const std::vector<StepStudy>& studies, Table& table) {
  std::size_t touched = 0, converging = 0, failed = 0;
  double error = 0, apart = 0;
  std::string unresolved;
  Json list = Json::array();
  for (const StepStudy& study : studies) {
    const tradeoff::Convergence& c = study.found;
    const std::size_t number = list.size();
    Json one = {{"repetition", number}, {"seed", study.seed}, {"contact", study.has_force}};
    touched += study.has_force ? 1 : 0;
    if (!study.failed.empty()) {
      ++failed;
      one["failed"] = study.failed;
    } else if (study.has_force) {
      converging += c.converges ? 1 : 0;
      (c.converges ? error : apart) = std::max(c.converges ? error : apart, c.error);
      if (!c.converges)
        unresolved += fmt::format("{}{} (order {:.1f})", unresolved.empty() ? "" : ", ", number, c.order);
      one["coarse_N"] = c.coarse;
      one["fine_N"] = c.fine;
      one["order"] = std::isfinite(c.order) ? Json(c.order) : Json();
      one["converges"] = c.converges;
      one["error_N"] = c.converges ? Json(c.error) : Json();
    }
    list.push_back(std::move(one));
  }
  const Json json = {{"what", "contact force, rms over windows of 10 ms"},
                     {"ratio", kStepRatio},
                     {"repetitions", list},
                     {"converging", converging},
                     {"error_N", converging > 0 ? Json(error) : Json()}};
  table.convergence_json = json_text(json);
  if (touched == 0) {
    table.convergence = "it has no contact: every force is an error";
    return;
  }
  table.convergence =
      fmt::format("its force converges in the step in {} of {} repetitions with contact", converging, touched);
  if (converging > 0) table.convergence += fmt::format(", its own error there is at most {:.2g} N", error);
  if (failed > 0) table.convergence += fmt::format("; in {} a coarser step could not be run", failed);
  if (converging + failed < touched)
    table.convergence += fmt::format(
        "; in repetition {} it does not: what happens there hangs on the step, as where an edge is caught and two "
        "blows "
        "follow each other within a step; it and its double differ by up to {:.2g} N, and force errors below that say "
        "nothing of these repetitions",
        unresolved, apart);
}

tradeoff::Row Sweep::row_of(std::size_t setting, const Measured& measured) const {
  tradeoff::Row row;
  const batch::Point point = design_.point(setting);
  const std::vector<std::string> keys = design_.keys();
  for (std::size_t i = 0; i < keys.size(); ++i) row.parameters[keys[i]] = batch::json_of(point.values[i].cell);
  row.failed = measured.failed;
  if (!row.failed.empty()) return row;
  row.time_us = tradeoff::interval_of(measured.contact_us);
  row.frame_us = tradeoff::interval_of(measured.frame_us);
  row.frames = measured.frames;
  for (std::size_t i = 0; i < kCostCounters.size(); ++i) row.cost.emplace_back(kCostCounters[i].name, measured.cost[i]);
  row.step_s = measured.simulated_s / static_cast<double>(measured.frames);
  row.mean_us = measured.all_us / static_cast<double>(measured.frames);
  for (std::size_t i = 0; i < measured.seeds.size(); ++i)
    row.trials.push_back({measured.seeds[i], measured.contact_us[i], measured.errors[i]});
  row.work_us = tradeoff::counted_work_us(row.cost, row.frames);
  for (std::size_t kind = 0; kind < tradeoff::kKinds.size(); ++kind)
    row.errors[kind] = tradeoff::spread_of(measured.errors, kind);
  return row;
}

Table Sweep::table(Kind by) {
  const InterruptScope until_no_process_works;
  line_ = std::make_unique<ProgressLine>(!request_.quiet);
  Table table;
  std::vector<Measured> measured(design_.runs());
  std::vector<StepStudy> studies;
  for (std::uint64_t number = 0; number < request_.repeat; ++number) {
    const Repetition repetition = run_truth(number);
    studies.push_back(study_step(repetition));
    std::vector<std::size_t> order(measured.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const RandomStream lot(request_.seed, fmt::format("tradeoff turn {}", number));
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(lot.uniform(i) * static_cast<double>(i))]);
    for (const std::size_t setting : order)
      if (measured[setting].failed.empty()) run_setting(setting, repetition, measured[setting]);
  }
  line_->say("");
  table.scenario = fs::path(scenario_.path).filename().string();
  table.scenario_sha256 = scenario_sha256_;
  table.version = VERISIM_VERSION;
  table.commit = commit();
  table.cpu = cpu_model();
  table.compiler = compiler();
  table.seed = request_.seed;
  table.repeat = request_.repeat;
  table.duration = request_.duration;
  const std::vector<std::string> keys = design_.keys();
  for (const ParameterDeclaration& p : declared_)
    if (std::find(keys.begin(), keys.end(), p.name) == keys.end()) table.fixed[p.name] = parse_json(p.value_json);
  table.truth = truth_text();
  table.by = by;
  table.notes = notes_;
  for (std::size_t i = 0; i < measured.size(); ++i) table.rows.push_back(row_of(i, measured[i]));
  tell_convergence(studies, table);
  tradeoff::find_dominated(table.rows, by);
  return table;
}

}  // namespace verisim::cli

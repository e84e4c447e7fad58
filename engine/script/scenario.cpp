#include "engine/script/scenario.hpp"
#include "engine/base/json.hpp"

#include "engine/script/script_state.hpp"

namespace verisim {

struct Scenario::Implementation {
  Implementation(const ScenarioOptions& options, Inputs& inputs) : state(options, inputs) {}
  script::ScriptState state;
};

namespace {

/// Why the script ended; nothing: at its end.
std::optional<script::LuaFailure> run_script(script::ScriptState& state, Inputs& inputs, std::uint64_t limit) {
  lua_State* L = state.lua();
  const std::string& content = inputs.read(state.name());
  state.allow(limit);
  auto failure = state.load(L, state.name(), content);
  if (!failure) failure = state.call(L, 0, 0);
  return failure;
}

}  // namespace

Scenario::Scenario(const ScenarioOptions& options, Inputs& inputs)
    : implementation_(std::make_unique<Implementation>(options, inputs)) {
  auto failure = run_script(implementation_->state, inputs, options.instruction_limit);
  if (const std::optional<script::PrecisionChoice> choice = implementation_->state.precision) {
    ScenarioOptions chosen = options;
    chosen.ignores_precision = true;
    chosen.sets.insert(chosen.sets.end(), choice->sets.begin(), choice->sets.end());
    implementation_ = std::make_unique<Implementation>(chosen, inputs);
    implementation_->state.event("precision", choice->event);
    for (const std::string& notice : choice->notices) implementation_->state.notice(notice);
    failure = run_script(implementation_->state, inputs, options.instruction_limit);
  }
  inputs.end_of_scene();
  if (failure) throw Error(failure->kind, failure->text);
  implementation_->state.finish();
}

Scenario::~Scenario() = default;

Scene Scenario::take_scene() {
  VERISIM_ASSERT(!implementation_->state.scene_taken);
  implementation_->state.scene_taken = true;
  return implementation_->state.scene;  // a copy: the words go on reading names, densities and rates
}

void Scenario::attach(Simulation& simulation) {
  VERISIM_ASSERT(implementation_->state.scene_taken);
  implementation_->state.attach(simulation);
}
std::string Scenario::parameters_json() const {
  return implementation_->state.parameters_json;
}
std::string Scenario::parameters_in_effect_json() const {
  const script::ScriptState& state = implementation_->state;
  VERISIM_ASSERT(state.simulation != nullptr);
  Json json = parse_json(state.parameters_json);
  // A parameter is the dial of its name only if the script gave the engine its value.
  const auto overrule = [&](const char* name, const Json& asked, const Json& acts, const Json& told) {
    if (json.contains(name) && json[name] == asked && asked != acts) json[name] = told;
  };
  if (state.asked_duration && state.options.duration)
    overrule("duration", *state.asked_duration, *state.options.duration, nullptr);
  if (state.asked_seed && state.options.seed) overrule("seed", *state.asked_seed, *state.options.seed, nullptr);
  if (state.simulation->is_implicit() && state.scene.parameters.integrator != Integrator::implicit)
    overrule("integrator", "semi-implicit", "implicit", "implicit");
  return json_text(json);
}
const std::string& Scenario::outcome() const {
  return implementation_->state.outcome;
}
double Scenario::outcome_since() const {
  return implementation_->state.outcome_since;
}
bool Scenario::finished() const {
  return implementation_->state.finished;
}
const std::vector<Measure>& Scenario::measures() const {
  return implementation_->state.measures;
}
std::vector<std::string> Scenario::notices() const {
  return implementation_->state.notices;
}

}  // namespace verisim

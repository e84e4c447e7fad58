#include "engine/script/scenario.hpp"

#include "engine/script/script_state.hpp"

namespace verisim {

struct Scenario::Implementation {
  Implementation(const ScenarioOptions& options, Inputs& inputs) : state(options, inputs) {}
  script::ScriptState state;
};

Scenario::Scenario(const ScenarioOptions& options, Inputs& inputs)
    : implementation_(std::make_unique<Implementation>(options, inputs)) {
  script::ScriptState& state = implementation_->state;
  lua_State* L = state.lua();
  const std::string& content = inputs.read(state.name());
  state.allow(options.instruction_limit);
  auto failure = state.load(L, state.name(), content);
  if (!failure) failure = state.call(L, 0, 0);
  if (failure) throw Error(ErrorKind::input, failure->text);
  state.finish();
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
const std::string& Scenario::outcome() const {
  return implementation_->state.outcome;
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

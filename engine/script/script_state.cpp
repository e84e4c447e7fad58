#include "engine/script/script_state.hpp"

#include <algorithm>
#include <cstdio>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

std::string file_name_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

/// Every folder on the way to a file is looked at, 2 us each; a folder's name has at least two bytes.
void charge_look_up(lua_State* L, const std::string& name) {
  constexpr std::uint64_t kLookUp = 1000, kPerByte = 50;
  Sandbox::charge(L, kLookUp + kPerByte * name.size());
}

}  // namespace

ScriptState::ScriptState(const ScenarioOptions& scenario_options, Inputs& scenario_inputs)
    : Sandbox(file_name_of(scenario_options.path), scenario_options.memory_limit),
      options(scenario_options),
      inputs(scenario_inputs) {
  lua_State* L = lua();
  scene.parameters.hybrid_by_default = scene.parameters.integrator_by_default = true;
  if (options.seed) scene.parameters.seed = *options.seed;
  add_parameter_words(L);
  add_scene_words(L);
  add_node_words(L);
  add_body_words(L);
  add_brep_words(L);
  add_device_words(L);
  add_filter_words(L);
  add_wii_words(L);
  add_robot_words(L);
  add_simulation_words(L);
  add_action_words(L);
  add_file_words(L);
  add_vector_words(L);
  add_matrix_words(L);
  add_drawing_words(L);
}

bool ScriptState::has_file(lua_State* L, const std::string& name) {
  charge_look_up(L, name);
  return inputs.exists(name);
}

const std::string& ScriptState::read_file(lua_State* L, const std::string& name) {
  charge_look_up(L, name);
  const std::string& content = inputs.read(name);
  charge(L, content.size());
  return content;
}

int ScriptState::run_file(lua_State* L, const std::string& file) {
  const int top = lua_gettop(L);
  const std::string& content = read_file(L, file);
  if (const auto failure = load(L, file, content)) {
    // The message has the place already; raise_text would put another before it.
    push_text(L, failure->text);
    lua_error(L);
  }
  lua_call(L, 0, LUA_MULTRET);
  return lua_gettop(L) - top;
}

void ScriptState::finish() {
  VERISIM_ASSERT(scene.devices.empty() && scene.companions.empty() && scene.grasps.empty());
  VERISIM_ASSERT(masses.size() == scene.bodies.size());
  check_sets();
  declaring.clear();
  if (options.seed) scene.parameters.seed = *options.seed;
  if (options.duration) scene.parameters.duration = options.duration;
  name_devices(devices);
  scene.parameters.timestep *= options.step_scale;
  bind_devices();
  for (const DevicePointer& device : devices) scene.devices.push_back(make_device(*device, scene.parameters.seed));
  finish_companions();
  for (const auto& grasp : grasps) {
    const DeviceNode& device = *grasp.first;
    scene.grasps.push_back(
        {.device = at_place(device.place, [&] { return device_index(device); }), .body = grasp.second});
  }
}

void ScriptState::check_sets() const {
  if (options.sets.empty() || parameters_place) return;  // params{} itself checks against what it declares
  const auto& [key, value] = options.sets.front();
  fail(ErrorKind::input, "--set {}={}: {} declares no parameters; add params{{ {} = … }} to it", key, value, name(),
       key);
}

void ScriptState::bind_devices() {
  std::vector<DeviceNode*> named;
  std::vector<std::string> names;
  for (const auto& device : devices)
    for (DeviceNode* node : named_in(*device)) {
      named.push_back(node);
      names.push_back(node->name);
    }
  for (const auto& node : companions) {
    if (std::find(names.begin(), names.end(), node->name) != names.end())
      fail(ErrorKind::input, "{}: there is a device '{}' already; give the {} another name=", node->place, node->name,
           node->word);
  }
  for (const auto& [wanted, source] : options.binds) {
    if (bind_companion(wanted, source)) continue;
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
      fail(ErrorKind::input, "--bind {}={}: {} has no device '{}'{}", wanted, source, name(), wanted,
           suggestion(wanted, names));
    DeviceNode& node = *named[static_cast<std::size_t>(found - names.begin())];
    if (!node.drivable)
      fail(ErrorKind::input,
           "--bind {}={}: '{}' is driven by the scenario itself; bind a device of Devices.Sensable or Devices.Haption",
           wanted, source, wanted);
    const std::string place = fmt::format("--bind {}={}", wanted, source);
    if (node.inner)
      fail(ErrorKind::input,
           "{}: device '{}' is driven already by the scenario; drop the --bind or the scenario's source", place,
           wanted);
    auto bound = std::make_shared<DeviceNode>();
    bound->name = bound->made_as = node.name;
    bound->default_name = "replay";
    bound->place = place;
    bound->make =
        at_place(place, [&, trace = source] { return replay_of(inputs, trace, TraceLimits{}.max_gap, false); });
    node.inner = std::move(bound);
  }
}

void ScriptState::add_companion(lua_State* L, std::shared_ptr<CompanionNode> node) {
  VERISIM_ASSERT(node != nullptr);
  for (const auto& other : companions)
    if (other->name == node->name)
      raise(L, "{}: there is a {} '{}' already; give each a name=", node->word, other->word, node->name);
  companions.push_back(std::move(node));
}

bool ScriptState::bind_companion(const std::string& wanted, const std::string& source) {
  const auto found =
      std::find_if(companions.begin(), companions.end(), [&](const auto& node) { return node->name == wanted; });
  if (found == companions.end()) return false;
  (*found)->bind(source);
  (*found)->place = fmt::format("--bind {}={}", wanted, source);
  return true;
}

void ScriptState::finish_companions() {
  for (const auto& node : companions) {
    scene.companions.push_back(at_place(node->place, [&] { return node->make(inputs, scene.parameters.seed); }));
    VERISIM_ASSERT(scene.companions.back() != nullptr);
  }
}

std::size_t ScriptState::device_index(const DeviceNode& wanted) const {
  for (std::size_t i = 0; i < devices.size(); ++i)
    for (const DeviceNode* node = devices[i].get(); node != nullptr; node = node->inner.get())
      if (node == &wanted) return i;
  fail(ErrorKind::input, "this device grasps a body but was never added; call addDevice(device) first");
}

void ScriptState::attach(Simulation& running) {
  VERISIM_ASSERT(simulation == nullptr);
  VERISIM_ASSERT(running.body_count() == scene.bodies.size());  // words know bodies by their numbers
  VERISIM_ASSERT(running.dt() == scene.parameters.timestep);
  simulation = &running;
  for (const auto& [kind, text] : early_events_) simulation->add_event(kind, text);
  early_events_.clear();
  simulation->add_clock(1 / simulation->dt(), [this](double) {
    for (const auto& counter : counters) counter->collisions += simulation->body_contacts(counter->body);
  });
  simulation->add_clock(scene.parameters.frame_rate, [this](double) { frame(); });
}

// VR JuggLua's order: the run buffer, then the actions; what a chunk adds as an action runs in the same frame.
void ScriptState::frame() {
  std::vector<std::pair<std::string, std::string>> chunks;
  chunks.swap(run_buffer);  // chunks that a chunk adds wait for the next frame
  for (const auto& [chunk_name, text] : chunks) let_go(kNodeBytes + text.size());
  for (const auto& [chunk_name, text] : chunks) {
    allow(kFrameWork);
    std::optional<LuaFailure> failure = load(lua(), chunk_name, text);
    if (!failure) failure = call(lua(), 0, 0);
    if (failure) report_failure("a chunk of the run buffer failed", *failure);
  }
  actions.update(scene.parameters.frame_rate);
}

void ScriptState::notice(const std::string& whole_text) {
  std::string text = shown(whole_text);
  if (notices.size() >= kNoticesMax)
    text = fmt::format("{}: more than {} notices; the rest is left out", name(), kNoticesMax);
  if (!told_.insert(text).second) return;
  notices.push_back(text);
  if (simulation != nullptr) event("warning", text);  // before that, whoever reads notices() writes the events
}

void ScriptState::event(const std::string& kind, const std::string& whole_text) {
  VERISIM_ASSERT(!kind.empty());
  const std::string text = shown(whole_text);  // the run file keeps less; a script may say anything
  if (simulation != nullptr) {
    simulation->add_event(kind, text);
    return;
  }
  if (early_events_.size() >= kEarlyEventsMax)
    fail(ErrorKind::input, "{}: more than {} events while the scene is built; look for a loop that never ends", name(),
         kEarlyEventsMax);
  early_events_.emplace_back(kind, text);
}

void ScriptState::report_failure(const std::string& what, const LuaFailure& failure) {
  event("script error", fmt::format("{} ({})", failure.text, what));
  const std::string text = fmt::format("{} ({}; the simulation goes on)", failure.text, what);
  if (options.warn)
    options.warn(text);
  else
    std::fprintf(stderr, "warning: %s\n", shown(text).c_str());
}

void ScriptState::print(const std::string& line) {
  event("print", line);
  if (options.print)
    options.print(line);
  else
    std::fprintf(stderr, "%s\n", shown_lines(line).c_str());
}

double ScriptState::random() {
  return RandomStream(scene.parameters.seed, random_name_).uniform(randoms_drawn_++);
}

void ScriptState::seed_random(double seed) {
  random_name_ = fmt::format("script {}", seed);
  randoms_drawn_ = 0;
}

}  // namespace verisim::script

// The state on which the words of a scenario act: the scene while it is built, then the running simulation. One per
// script; every word gets it by ScriptState::of(L).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/record/trace.hpp"
#include "engine/script/assembly_node.hpp"
#include "engine/script/companion_node.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/frame_actions.hpp"
#include "engine/script/parameters.hpp"
#include "engine/script/precision.hpp"
#include "engine/script/sandbox.hpp"
#include "engine/script/scenario.hpp"
#include "engine/simulation/declaring.hpp"

namespace verisim::script {

/// Work units that each action, and each chunk of the run buffer, may spend in one script frame.
inline constexpr std::uint64_t kFrameWork = 10'000'000;

/// Work units for a line of /events, which is stored outside Lua's memory.
inline constexpr std::uint64_t kEventWork = 500;
/// What a small object that the engine keeps for the script takes at most, bytes.
inline constexpr std::size_t kNodeBytes = 512;
/// Most lines of /events before the simulation runs, most different notices, most measures.
inline constexpr std::size_t kEarlyEventsMax = 20'000;
inline constexpr std::size_t kNoticesMax = 1000;
inline constexpr std::size_t kMeasuresMax = 1000;
/// Largest number of frame actions at one time.
inline constexpr std::size_t kActionsMax = 1000;

struct BodyHandle {
  std::size_t index;  ///< in Scene::bodies
};

/// CollisionCounter(body): colliding voxel pairs of its body, summed over the frames since the last reset.
struct CollisionCounter {
  std::size_t body = 0;
  std::uint64_t collisions = 0;
};

struct FrameActionHandle {
  std::uint64_t id;
};

/// Placeholder for a material, a light, a font …: every member and every call of it is again a placeholder.
struct Drawing {};

class ScriptState : public Sandbox {
 public:
  ScriptState(const ScenarioOptions& options, Inputs& inputs);
  static ScriptState& of(lua_State* L) { return static_cast<ScriptState&>(Sandbox::of(L)); }

  /// Is there such a file? A script pays for each look at the disk, found or not.
  [[nodiscard]] bool has_file(lua_State* L, const std::string& name);
  /// Its content. Error(input): no such file.
  [[nodiscard]] const std::string& read_file(lua_State* L, const std::string& name);
  /// Runs a file of the scenario on L and leaves its results. Error(input): no such file. Lua errors pass through.
  int run_file(lua_State* L, const std::string& name);
  /// Once, after the script: unknown --set keys, --bind, devices, grasps; completes `scene`. Error(input).
  /// @pre not called before
  void finish();
  /// @pre the simulation is of `scene`; not attached before
  void attach(Simulation& simulation);

  /// Records a warning or an ignored option once, for stderr (by the caller of Scenario::notices) and /events.
  void notice(const std::string& text);
  /// @pre the kind is not empty
  void event(const std::string& kind, const std::string& text);
  /// Runs one piece of the running scene's script; a failure becomes an event and the simulation goes on.
  void report_failure(const std::string& what, const LuaFailure& failure);

  /// The description of a body while the scene is built. @pre it is one of scene.bodies
  [[nodiscard]] BodyDescription& described_body(std::size_t body) {
    VERISIM_ASSERT(body < scene.bodies.size());
    return scene.bodies[body];
  }
  [[nodiscard]] double time() const { return simulation == nullptr ? 0 : simulation->time(); }

  // Sandbox
  void print(const std::string& line) override;
  [[nodiscard]] double clock() const override { return time(); }
  [[nodiscard]] double random() override;
  void seed_random(double seed) override;
  void stop() override { finished = true; }

  const ScenarioOptions options;
  Inputs& inputs;
  Scene scene;
  bool scene_taken = false;
  std::vector<DevicePointer> devices;                      ///< in the order of addDevice
  std::vector<std::shared_ptr<CompanionNode>> companions;  ///< in the order of their words
  std::vector<std::pair<DevicePointer, std::size_t>> grasps;
  std::vector<std::shared_ptr<CollisionCounter>> counters;
  Simulation* simulation = nullptr;  ///< null while the scene is built

  FrameActions actions{*this};
  std::vector<std::pair<std::string, std::string>> run_buffer;  ///< chunk name, text
  std::vector<std::string> search_path;

  std::optional<std::string> parameters_place;  ///< FILE:LINE of params{}
  std::string parameters_json = "{}";
  std::optional<double> asked_duration,
      asked_seed;  ///< as the script has them: --duration and --seed may say otherwise
  std::vector<std::string> parameter_names;
  std::vector<ParameterDeclaration> parameters;  ///< in the same order
  bool parameters_only = false;                  ///< the script ends at params{}
  std::string set_option = "--set";              ///< where values come from, for errors
  bool parameters_known = false;                 ///< it came through params{}

  std::optional<PrecisionChoice> precision;  ///< what precision = "auto" chose: the script has to be run again with it

  std::string outcome;
  double outcome_since = 0;  ///< simulated time at which that was first said [s]
  bool finished = false;
  std::vector<Measure> measures;
  std::vector<std::string> notices;
  std::vector<double> masses;                  ///< of described bodies, kg
  std::map<std::size_t, Declaring> declaring;  ///< bodies whose voxels the script goes through; until finish()

  /// Raises if a companion of that name is there. @pre it is not null
  void add_companion(lua_State* L, std::shared_ptr<CompanionNode> node);
  /// Index in scene.devices of the chain that `node` is part of. Error(input) if it was never added.
  [[nodiscard]] std::size_t device_index(const DeviceNode& node) const;
  /// Error(input) if --set names something and the script declares no parameters.
  void check_sets() const;

 private:
  void bind_devices();
  [[nodiscard]] bool bind_companion(const std::string& wanted, const std::string& source);
  void finish_companions();
  void frame();

  std::set<std::string> told_;
  std::vector<std::pair<std::string, std::string>> early_events_;
  std::string random_name_ = "script";
  std::uint64_t randoms_drawn_ = 0;
};

/// Runs `make` and puts `place` before the text of an Error that it throws.
template <typename Make>
auto at_place(const std::string& place, const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    throw Error(error.kind(), place + ": " + error.what());
  }
}

/// What --set key=text makes of a declared parameter, as JSON. Error(input). @pre no script runs; work is allowed
[[nodiscard]] std::string read_set_value(ScriptState& state, const std::string& key, const std::string& text);

// The words, by subject: words_*.cpp.
void add_parameter_words(lua_State* L);   ///< params, parameter, mm, deg, outcome, measure
void add_scene_words(lua_State* L);       ///< defineSimulationParameters, addObject
void add_node_words(lua_State* L);        ///< Model, modelParts, Transform, Group, MatrixTransform, Solid
void add_body_words(lua_State* L);        ///< what addObject returns
void add_brep_words(lua_State* L);        ///< FeatureSet, BoundaryFeature, Plane, Cylinder …
void add_device_words(lua_State* L);      ///< Devices, addDevice, grasp
void add_hand_word(lua_State* L);         ///< Devices.Hand, into the table at the top of the stack
void add_filter_words(lua_State* L);      ///< what wraps devices: placement, bubble, navigation
void add_wii_words(lua_State* L);         ///< WiiHead
void add_robot_words(lua_State* L);       ///< Robot, VRPNRemoteBase
void add_simulation_words(lua_State* L);  ///< simulation, CollisionCounter
void add_action_words(lua_State* L);      ///< Actions, runbuf
void add_file_words(lua_State* L);        ///< require, dofile, runfile, vrjLua
void add_vector_words(lua_State* L);      ///< osg.Vec3, osg.Quat, AngleAxis, Axis, Degrees, Vec …
void add_matrix_words(lua_State* L);      ///< osg.Matrix
void add_drawing_words(lua_State* L);     ///< what only draws or sounds; last, so that it replaces nothing

/// Of a body, to the table on top of the stack: foreachSurfaceVoxel, addFeatureSet, getFeatureSet.
void add_declaring_methods(lua_State* L);

}  // namespace verisim::script

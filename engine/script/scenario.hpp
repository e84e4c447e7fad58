// A scenario: a Lua script that describes a scene and acts on it while it runs. Lua 5.1, sandboxed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/run_figures.hpp"
#include "engine/simulation/inputs.hpp"
#include "engine/simulation/scene.hpp"
#include "engine/simulation/simulation.hpp"

namespace verisim {

struct ScenarioOptions {
  std::string path;  ///< of the script, as the command line gives it
  std::vector<std::pair<std::string, std::string>>
      sets;  ///< --set KEY=VALUE: VALUE is a Lua expression; a bare word is a string
  std::vector<std::pair<std::string, std::string>> binds;  ///< --bind NAME=SOURCE
  std::optional<std::uint64_t> seed;                       ///< --seed, --duration win over the script
  std::optional<double> duration;
  double step_scale = 1;  ///< the time step is so much of what the script says: a finer run of the same, as a reference
  bool ignores_precision = false;  ///< precision = "auto" chooses nothing: settings are tried one by one
  std::size_t memory_limit = std::size_t{256} << 20;  ///< bytes of Lua memory
  std::uint64_t instruction_limit = 200'000'000;      ///< while building; and per script frame 10'000'000
  std::function<void(const std::string&)> print{};    ///< receives what the script prints; empty: stderr does
  std::function<void(const std::string&)> warn{};     ///< receives failures of its actions; empty: stderr does
};

class Scenario {
 public:
  /// Runs the script: builds the scene. Error(input) with file and line for a script error, unknown parameter (lists
  /// them, suggests the nearest), time or memory limit, a file outside the scenario's folder. Error(io) if it asked for
  /// something that the system lacks: a file handle, a library of verisim-cad.
  Scenario(const ScenarioOptions& options, Inputs& inputs);
  ~Scenario();

  /// The scene as described. @pre not taken before
  [[nodiscard]] Scene take_scene();
  /// Binds the script's objects to the running simulation and registers its frame clock (60 Hz of simulated time).
  /// @pre the simulation is of take_scene()'s scene; not attached before
  void attach(Simulation& simulation);

  [[nodiscard]] std::string parameters_json() const;  ///< all params{} as resolved
  /// The same, but what something overrules: null where --duration or --seed does, and of `integrator` the one that
  /// acts, which `exact` chooses. @pre attached
  [[nodiscard]] std::string parameters_in_effect_json() const;
  [[nodiscard]] const std::string& outcome() const;  ///< outcome("…"); empty if none was said
  [[nodiscard]] double outcome_since() const;        ///< simulated time at which it became that [s]
  [[nodiscard]] bool finished() const;  ///< the script asked to stop (outcome with stop, simulation:stop())
  [[nodiscard]] const std::vector<Measure>& measures() const;
  [[nodiscard]] std::vector<std::string> notices() const;  ///< warnings and ignored options, each once

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace verisim

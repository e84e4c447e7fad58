// Robot{ … } as a script describes it: a base that devices may stand on. Devices are made before companions; whichever
// of them asks first has it made.
#pragma once

#include <memory>
#include <string>

#include "engine/base/moving_base.hpp"
#include "engine/robot/robot.hpp"
#include "engine/script/companion_node.hpp"
#include "engine/script/head_node.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

struct RobotNode : CompanionNode {
  robot::RobotSettings settings;
  std::string board = "host";    ///< "host" or "avr"
  std::string server = "Robot";  ///< by which VRPNRemoteBase names it
  std::string tracker;           ///< by which TrackedTransform names its tracker
  std::string trace;             ///< an encoder trace that it follows instead; empty: none
  HeadPointer head;              ///< whose line of sight it keeps out of; null: none

  std::shared_ptr<robot::Robot> robot;   ///< null until made, and if a trace moves it
  std::shared_ptr<MovingBase> base;      ///< null until made
  std::shared_ptr<Companion> companion;  ///< the same

  void bind(const std::string& source) override { trace = source; }
  [[nodiscard]] std::shared_ptr<Companion> make(Inputs& inputs, std::uint64_t seed) override;
  /// The base, made at the first call.
  [[nodiscard]] std::shared_ptr<MovingBase> base_of(Inputs& inputs, std::uint64_t seed);
};
using RobotPointer = std::shared_ptr<RobotNode>;

template <>
inline constexpr const char* kTypeName<RobotPointer> = "Robot";

class ScriptState;
/// The base whose tracker has this name; null: no robot's has. @pre devices have their names
[[nodiscard]] std::shared_ptr<MovingBase> base_tracked_by(ScriptState& state, const std::string& tracker,
                                                          std::uint64_t seed);

}  // namespace verisim::script

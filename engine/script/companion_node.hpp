// What runs beside the loop, as a script describes it. Its word makes a node; ScriptState::finish makes the companion,
// when seed and bindings are known. Nothing in script but its word knows which companion that is.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/base/companion.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::script {

struct CompanionNode {
  CompanionNode() = default;
  virtual ~CompanionNode() = default;
  CompanionNode(const CompanionNode&) = delete;
  CompanionNode& operator=(const CompanionNode&) = delete;

  std::string word;   ///< of the script, for messages: "WiiHead"
  std::string name;   ///< no device and no other companion has it
  std::string place;  ///< FILE:LINE of the word, or the --bind

  /// --bind NAME=SOURCE: from now on a trace drives it.
  virtual void bind(const std::string& source) = 0;
  /// Never returns null. Error(input) for a description that cannot be made.
  [[nodiscard]] virtual std::shared_ptr<Companion> make(Inputs& inputs, std::uint64_t seed) = 0;
};

}  // namespace verisim::script

// WiiHead{ … } as a script describes it.
#pragma once

#include <memory>
#include <string>

#include "engine/record/trace.hpp"
#include "engine/script/companion_node.hpp"
#include "engine/wii/head.hpp"

namespace verisim::script {

struct HeadNode : CompanionNode {
  std::string tracker = "scaat";
  std::string trace;                         ///< a wii trace; empty: virtual_remote
  TraceLimits limits;                        ///< of the trace
  wii::VirtualSourceOptions virtual_remote;  ///< name and seed are filled in by make
  Pose X_WL;                                 ///< where the remote stands, levelled
  std::shared_ptr<wii::Head> head;           ///< null until make

  void bind(const std::string& source) override { trace = source; }
  [[nodiscard]] std::shared_ptr<Companion> make(Inputs& inputs, std::uint64_t seed) override;
};
using HeadPointer = std::shared_ptr<HeadNode>;

}  // namespace verisim::script

// What an operator has seen, felt and done in the last frames: it acts on what was a reaction time ago.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/contract.hpp"
#include "engine/base/pose.hpp"

namespace verisim {

/// One frame of it.
struct View {
  Pose watched;         ///< what is to be brought to the goal, virtual world
  Pose handle;          ///< the virtual handle
  Pose own;             ///< the hand itself, device coordinates
  Vector3d felt_force;  ///< N, at the hand
};

/// No allocation after construction.
class Views {
 public:
  static constexpr std::size_t kFramesMax = 4096;
  Views() : views_(kFramesMax) {}
  void add(const View& view) { views_[count_++ % kFramesMax] = view; }
  /// That of `frames` calls of add before the last; of the first while there were fewer.
  /// @pre one was added; frames < kFramesMax
  [[nodiscard]] const View& before(std::size_t frames) const {
    VERISIM_ASSERT(count_ > 0);
    VERISIM_ASSERT(frames < kFramesMax);
    return views_[(frames < count_ ? count_ - 1 - frames : 0) % kFramesMax];
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<View> views_;
  std::size_t count_ = 0;
};

}  // namespace verisim

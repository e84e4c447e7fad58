// The hybrid method of every pair, and whether it acts in this frame: scripts may switch a body's off and on.
#pragma once

#include <memory>
#include <vector>

#include "engine/simulation/hybrid_method.hpp"
#include "engine/simulation/stages/contacts.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class PairMethods {
 public:
  /// Makes them. Adds to `events` where a method was asked for and cannot act.
  PairMethods(const World& world, const Contacts& contacts, std::vector<Event>& events);

  /// Which of them act in this frame.
  void choose(const World& world);
  /// Null: the voxels' penalty alone.
  [[nodiscard]] PairMethod* acting(std::size_t link) const { return acting_[link]; }
  [[nodiscard]] LookUps look_ups(std::size_t link) const {
    return acting_[link] != nullptr ? acting_[link]->look_ups() : LookUps{};
  }
  /// Does any pair have a method that searches for precise contacts?
  [[nodiscard]] bool any_precise() const { return any_precise_; }

 private:
  std::vector<std::unique_ptr<PairMethod>> methods_;
  std::vector<PairMethod*> acting_;
  bool any_precise_ = false;
};

}  // namespace verisim

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
  /// Between frames: makes the pair's.
  void add_link(const World& world, const Contacts& contacts, std::size_t link);
  /// Of the pair, whether it can act or not.
  [[nodiscard]] static Hybrid asked_of(const World& world, std::size_t link);
  /// Adds to `events` if a method was asked for and cannot act on the pair, or not everywhere.
  static void tell(const World& world, std::size_t link, std::vector<Event>& events);

  /// Which of them act in this frame.
  void choose(const World& world);
  /// Has a script switched off the method of one of the two?
  [[nodiscard]] static bool is_switched_off(const World& world, std::size_t link);
  /// Null: the voxels' penalty alone.
  [[nodiscard]] PairMethod* acting(std::size_t link) const { return of_[link].acts ? of_[link].method.get() : nullptr; }
  /// The search for precise contacts that acts in this frame; null: none.
  [[nodiscard]] exact::ExactLink* searching(std::size_t link) const {
    return of_[link].acts ? of_[link].precise : nullptr;
  }
  /// Are the pair's voxels to be asked?
  [[nodiscard]] bool needs_voxels(std::size_t link) const { return !of_[link].acts || of_[link].needs_voxels; }
  [[nodiscard]] LookUps look_ups(std::size_t link) const {
    return of_[link].acts && of_[link].needs_voxels ? of_[link].method->look_ups() : LookUps{};
  }
  /// Does the pair's method search for precise contacts?
  [[nodiscard]] bool is_precise(std::size_t link) const { return of_[link].precise != nullptr; }

 private:
  /// What never changes of a method stands beside it: of a heap's thousand pairs most are only asked for that.
  struct OfPair {
    std::unique_ptr<PairMethod> method;  ///< null: the voxels' penalty alone
    exact::ExactLink* precise = nullptr;
    bool needs_voxels = true;
    bool acts = false;
  };
  std::vector<OfPair> of_;
};

}  // namespace verisim

// What the contacts of each pair of bodies have given and taken, and an event where they create energy.
//
// The work of a pair in a step is that of its wrenches, as applied, on its two bodies, along the displacement that
// makes it the change of their kinetic energy (StepWork::moved); summed over pairs it is the ledger's. Since the pair
// last began to touch, the contacts have been given some of it and have given some back. What they give back of what
// they were given is elastic and no creation. What they give beyond that is: of a passive contact the sum never exceeds
// 0 (Hannaford and Ryu's observer, 2002, per pair and per touch). When a pair parts, nothing is stored any more, and
// what had not been given back was lost.
//
// Told is a step that creates more than 1 uJ and more than 1 % of what the pair's bodies have: their kinetic energy,
// and that of the springs that hold them. Less is what steps of voxels and of time cost everywhere.
#pragma once

#include <vector>

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/stages/reactions.hpp"

namespace verisim {

class PairEnergy {
 public:
  /// J, and fraction of the pair's energy.
  static constexpr double kLeast = 1e-6, kFraction = 0.01;

  void add_link() { links_.emplace_back(); }  ///< between frames
  /// After a step: notes the first time that a pair does so.
  void watch(const World& world, const Contacts& contacts, const ExactResponse& exact, const Reactions& reactions,
             const Motion& motion, Notes& notes);
  /// J, given by the pair's contacts since they last began to touch, less what they were given.
  [[nodiscard]] double given(std::size_t link) const { return links_[link].given; }

 private:
  struct OfLink {
    double given = 0;
    std::uint64_t touched_in = kNone;  ///< frame
    bool told = false;
  };
  std::vector<OfLink> links_;
};

}  // namespace verisim

// Broad phase: which pairs of bodies are near each other in the coming frame, and which of them nobody has seen
// together before.
//
// It looks at the end of a frame for the next one, and a little wider than contacts need, so that what a pair that
// comes near has to have is made between frames.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/index_set.hpp"
#include "engine/contact/broad_phase.hpp"
#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

using NearPair = std::pair<std::uint32_t, std::uint32_t>;  ///< bodies, first < second

class Neighbours {
 public:
  explicit Neighbours(const World& world);

  /// From the poses of bodies that move, or did when it last looked: writes World::near_links. No allocation.
  void look_around(World& world);
  /// Before that, at the end of a step: notes a body under precise contact that went farther in it than was looked
  /// ahead for. One that it met for the first time is found a step late. Once for each body.
  void watch(const World& world, Notes& notes);
  /// A script put a body elsewhere: the next time all are looked at.
  void look_anew() { anew_ = true; }
  /// The box along the world's axes around a body, as large as its voxels reach.
  [[nodiscard]] const Bounds& box(std::size_t body) const { return boxes_[body]; }
  /// Pairs that came near and have no link, or one without a number; ascending.
  [[nodiscard]] const std::vector<NearPair>& strangers() const { return strangers_; }
  /// There were more pairs than there is room for: make_room() and look again.
  [[nodiscard]] bool missed_some() const { return broad_phase_.left_out() > 0 || left_out_ > 0; }

  // Between frames.
  void make_room(World& world);
  /// The link of a pair of bodies; kNone: they have none.
  [[nodiscard]] std::size_t link_of(std::size_t first, std::size_t second) const;
  void add_link(const World& world, std::size_t link);

 private:
  void place(const World& world, std::size_t body);
  void find_of_placed(const World& world);

  struct Known {
    std::uint64_t pair;  ///< first << 32 | second
    std::size_t link;
  };
  BroadPhase broad_phase_;
  std::vector<Bounds> boxes_;
  std::vector<double> ahead_;  ///< m, by which a body is looked for farther than its box
  std::vector<bool> told_;     ///< of bodies: see watch
  std::vector<Known> known_;   ///< ascending
  bool anew_ = true;
  std::vector<std::size_t> moved_;      ///< bodies that moved when it last looked; ascending
  std::vector<std::size_t> placed_;     ///< these and those that move now
  IndexSet is_placed_;                  ///< the same, while it looks
  std::vector<NearPair> near_, stood_;  ///< ascending; those of what did not move
  std::vector<NearPair> strangers_;
  std::size_t room_ = 0;      ///< for near pairs
  std::size_t left_out_ = 0;  ///< for which there was none
};

}  // namespace verisim

// Which bodies a frame has to do with, so that those that stand somewhere else cost it nothing.
#pragma once

#include <vector>

#include "engine/base/index_set.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Busy {
 public:
  /// In the first frame all are.
  explicit Busy(const World& world) : busy_(world.bodies.size()), touched_(world.bodies.size()) {
    last_.reserve(world.bodies.size());
    for (std::size_t i = 0; i < world.bodies.size(); ++i) touched_.add(i);
  }

  /// Between frames: a script put the body elsewhere.
  void add(std::size_t body) { touched_.add(body); }

  /// Writes World::moving and World::busy, when all that this frame takes and lets go has been.
  void list(World& world) {
    world.list_moving();
    for (const std::size_t i : world.moving) touched_.add(i);
    for (const std::size_t l : world.near_links) {
      touched_.add(world.links[l].first);
      touched_.add(world.links[l].second);
    }
    for (const std::size_t i : last_) busy_.add(i);
    last_.clear();
    touched_.move_to(last_);
    for (const std::size_t i : last_) busy_.add(i);
    world.busy.clear();
    busy_.move_to(world.busy);
  }

 private:
  IndexSet busy_;     ///< empty between calls
  IndexSet touched_;  ///< in this frame
  std::vector<std::size_t> last_;
};

}  // namespace verisim

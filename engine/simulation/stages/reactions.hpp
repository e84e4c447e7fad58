// What every contact has done, now that the bodies have moved: the wrenches that the record tells.
#pragma once

#include <vector>

#include "engine/simulation/stages/motion.hpp"

namespace verisim {

class Reactions {
 public:
  explicit Reactions(const World& world) : on_body_(world.bodies.size()), on_second_(world.links.size()) {}

  void find(const World& world, const Contacts& contacts, const Response& response, const ExactResponse& exact,
            const Motion& motion);
  /// Contact wrench as applied, about the body's centre of mass.
  [[nodiscard]] const Wrench& on_body(std::size_t body) const { return on_body_[body]; }
  /// On the second body of a link by the first, as applied, about the second's centre of mass.
  [[nodiscard]] const Wrench& on_second(std::size_t link) const { return on_second_[link]; }

 private:
  std::vector<Wrench> on_body_, on_second_;
};

}  // namespace verisim

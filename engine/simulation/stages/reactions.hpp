// What every contact has done, now that the bodies have moved: the wrenches that the record tells.
#pragma once

#include <vector>

#include "engine/simulation/stages/motion.hpp"

namespace verisim {

class Reactions {
 public:
  explicit Reactions(const World& world) : on_body_(world.bodies.size()) {}
  void add_link() {  ///< between frames
    on_first_.emplace_back();
    on_second_.emplace_back();
  }

  void find(const World& world, const Contacts& contacts, const Response& response, const ExactResponse& exact,
            const Motion& motion);
  /// Contact wrench as applied, about the body's centre of mass.
  [[nodiscard]] const Wrench& on_body(std::size_t body) const { return on_body_[body]; }
  /// On the first body of a link by the second, as applied, about the first's centre of mass.
  [[nodiscard]] const Wrench& on_first(std::size_t link) const { return on_first_[link]; }
  /// On the second body of a link by the first, as applied, about the second's centre of mass.
  [[nodiscard]] const Wrench& on_second(std::size_t link) const { return on_second_[link]; }

 private:
  std::vector<Wrench> on_body_, on_first_, on_second_;
};

}  // namespace verisim

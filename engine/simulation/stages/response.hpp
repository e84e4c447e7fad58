// What acts on each body: virtual coupling and weight, then the penalty forces of its contacts, as the methods of its
// pairs leave them, summed in pair order (floating-point addition is not associative).
#pragma once

#include <vector>

#include "engine/contact/collision_link.hpp"
#include "engine/dynamics/integrator.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/stages/contacts.hpp"
#include "engine/simulation/stages/pair_methods.hpp"

namespace verisim {

class Response {
 public:
  explicit Response(const World& world);
  void add_link() { sides_.emplace_back(); }  ///< between frames

  /// Weight and coupling, from the handles as sampled.
  void pull(const World& world);
  void respond(const World& world, const Contacts& contacts, const PairMethods& methods, FrameCost& cost);

  [[nodiscard]] const Loads& loads(std::size_t body) const { return bodies_[body].loads; }
  /// Of the voxels' contacts of a link that touches, as its method left them.
  [[nodiscard]] const LinkSides& sides(std::size_t link) const { return sides_[link]; }

 private:
  struct OfBody {
    Loads loads;
    LinkBody link_body;
    bool touched = false;         ///< by voxels, in the last frame: only then its loads have any contact
    unsigned links_touching = 0;  ///< explicit ones: they share the body's stability budget
  };
  void prepare_bodies(const World& world, const Contacts& contacts);
  void respond(const World& world, std::size_t link, const Contacts& contacts, PairMethod* method);
  std::vector<OfBody> bodies_;
  std::vector<LinkSides> sides_;
};

}  // namespace verisim

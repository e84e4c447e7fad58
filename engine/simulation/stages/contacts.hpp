// Which voxels touch: broad phase, then pointshell against voxmap (or FCL's triangles), pair by pair.
#pragma once

#include <memory>
#include <vector>

#include "engine/contact/broad_phase.hpp"
#include "engine/contact/collision_link.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class PairMethods;

class Contacts {
 public:
  explicit Contacts(const World& world);

  /// Fills the contact list of every link. What a method answers itself is taken out of it.
  void query(const World& world, const PairMethods& methods, FrameCost& cost);

  /// The pair's contacts and their response; null: one of its bodies has no voxels.
  [[nodiscard]] CollisionLink* link(std::size_t link) const { return links_[link].get(); }
  [[nodiscard]] bool near(std::size_t link) const { return near_[link]; }  ///< broad phase
  [[nodiscard]] std::uint32_t count(std::size_t link) const { return links_[link] ? links_[link]->contacts().size : 0; }
  [[nodiscard]] bool touches(std::size_t link) const { return count(link) > 0; }
  [[nodiscard]] double depth_max(std::size_t link) const {
    return links_[link] ? links_[link]->depth_max() : 0;
  }  ///< m
  [[nodiscard]] std::uint64_t of_body(std::size_t body) const { return of_body_[body]; }
  /// m, the body's centre of mass when contacts were found: what their wrenches are about.
  [[nodiscard]] const Vector3d& found_at(std::size_t body) const { return p_WC_[body]; }
  /// The body with the points as the one with the voxmap sees it.
  [[nodiscard]] Pose X_AB(const World& world, std::size_t link) const;

 private:
  void query_link(const World& world, std::size_t link, FrameCost& cost);

  BroadPhase broad_phase_;
  std::vector<std::size_t> link_of_pair_;  ///< first * bodies + second
  std::vector<std::unique_ptr<CollisionLink>> links_;
  std::vector<bool> near_;
  std::vector<std::uint64_t> of_body_;
  std::vector<Vector3d> p_WC_;
};

}  // namespace verisim

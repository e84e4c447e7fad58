// Which voxels touch: pointshell against voxmap (or FCL's triangles), for every pair whose boxes meet.
#pragma once

#include <memory>
#include <vector>

#include "engine/contact/collision_link.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Neighbours;
class PairMethods;

class Contacts {
 public:
  explicit Contacts(const World& world);
  /// Between frames. @pre both bodies are made
  void add_link(const World& world, std::size_t link);

  /// Fills the contact list of every near link. What a method answers itself is taken out of it.
  void query(const World& world, const Neighbours& neighbours, const PairMethods& methods, FrameCost& cost);

  /// The pair's contacts and their response.
  [[nodiscard]] CollisionLink& link(std::size_t link) const { return *links_[link]; }
  /// Do the bodies' boxes, as large as their voxels reach, meet?
  [[nodiscard]] bool meets(std::size_t link) const { return meets_[link]; }
  [[nodiscard]] std::uint32_t count(std::size_t link) const { return asked_[link] ? links_[link]->contacts().size : 0; }
  [[nodiscard]] bool touches(std::size_t link) const { return count(link) > 0; }
  /// m
  [[nodiscard]] double depth_max(std::size_t link) const { return asked_[link] ? links_[link]->depth_max() : 0; }
  [[nodiscard]] std::uint64_t of_body(std::size_t body) const { return of_body_[body]; }
  /// m, the body's centre of mass when contacts were found: what their wrenches are about.
  [[nodiscard]] const Vector3d& found_at(std::size_t body) const { return p_WC_[body]; }
  /// The body with the points as the one with the voxmap sees it.
  [[nodiscard]] Pose X_AB(const World& world, std::size_t link) const;

 private:
  void query_link(const World& world, std::size_t link, FrameCost& cost);

  std::vector<std::unique_ptr<CollisionLink>> links_;
  std::vector<bool> meets_;
  std::vector<bool> asked_;  ///< were the pair's voxels asked in the last frame in which it was near?
  std::vector<std::uint64_t> of_body_;
  std::vector<Vector3d> p_WC_;
};

}  // namespace verisim

// B-rep entities that a script declares by hand for voxels of a body: what SPARTA's users did before parts had b-reps.
//
// Declared entities extend the part's: its faces, then the declared faces, then its edges, then the declared edges are
// what the numbers of entities count through. In a voxel that was given a declared set, that set REPLACES the part's
// own: whoever declares by hand says all that should be recognized there (the published demonstration leaves planes out
// on purpose). Declared sets have the first numbers, from 1 on, in the order in which they were added.
//
// Whether a round face is a hole need not be said: the inward normals of the voxels that get it tell, together. (A
// plane's normal is as declared: out of the material.) A face's bounds are those of the voxels that have it; a
// cylinder whose rim is in a voxel's set too ends there at the rim.
#pragma once

#include <array>
#include <map>
#include <span>
#include <variant>
#include <vector>

#include "engine/voxel/voxmap.hpp"

namespace verisim {

class DeclaredFeatures {
 public:
  using Entity = std::variant<Face, Edge>;
  /// Kind, point, direction and two sizes: entities are equal if these are.
  using Key = std::array<double, 9>;

  /// The number of the set of these entities: that of an equal set, or the next one. Entities are equal if all numbers
  /// of their surface or curve are.
  /// Throws Error(input) that names `owner` for an entity that is none (fault_of in engine/geometry/entity_check.hpp),
  /// one without an equation, a torus that meets itself, and more sets than can be numbered.
  FeatureSetId add(const std::string& owner, std::span<const Entity> set);

  /// Gives a surface voxel the set: its number in [1, size()], or 0 to take a set away.
  /// @pre body is the one that all calls are about, and voxel is below its surface_count
  void assign(const VoxelBody& body, std::uint32_t voxel, FeatureSetId id);

  [[nodiscard]] std::size_t size() const { return sets_.size() - 1; }
  /// Number of entities in a set; 0 for the empty set. @pre id <= size()
  [[nodiscard]] std::size_t entities_in(FeatureSetId id) const { return sets_[id].size(); }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Sets of the surface voxels; empty, or as long as the body's surface_count.
  [[nodiscard]] const std::vector<FeatureSetId>& of_voxel() const { return of_voxel_; }

  /// Entities of a set, ascending, when the declared faces count from `first_face` and the edges from `first_edge`.
  [[nodiscard]] std::vector<EntityNumber> numbered(FeatureSetId id, EntityNumber first_face,
                                                   EntityNumber first_edge) const;

 private:
  /// Faces are 2 i, edges 2 i + 1.
  using Place = EntityNumber;

  [[nodiscard]] Place place_of(const std::string& owner, const Entity& entity);
  void weigh(std::size_t face, const Vector3d& p, const Vector3d& inward);
  void extend(std::size_t face, std::span<const Place> set, const Vector3d& p, double half_side);
  [[nodiscard]] const Circle* rim_of(const Cylinder& cylinder, std::span<const Place> set) const;

  std::vector<Face> faces_;
  std::vector<bool> met_;     // a voxel has the face
  std::vector<double> lean_;  // sum over its voxels: above zero where the inward normals point away from the axis
  std::vector<Edge> edges_;
  std::map<Key, Place> places_;
  FeatureSets sets_;  // of places
  std::vector<FeatureSetId> of_voxel_;
};

}  // namespace verisim

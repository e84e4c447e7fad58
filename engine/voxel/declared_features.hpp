// B-rep entities that a script declares for voxels of a body, as users of SPARTA did before parts had b-reps.
//
// Entity numbers count the part's faces, then the declared faces, then the part's edges, then the declared edges. In a
// voxel with a declared set, that set replaces the part's own: it holds all that should be recognized there (the
// published demonstration leaves planes out on purpose). Declared sets have the first numbers, from 1 on, in the order
// in which they were added.
//
// Whether a curved face is a hole is found from the inward normals of its voxels, summed. A plane's normal is as
// declared: out of the material. A face's bounds are those of its voxels; a cylinder whose rim is also in a voxel's set
// ends there at the rim.
#pragma once

#include <array>
#include <map>
#include <span>
#include <variant>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

class DeclaredFeatures {
 public:
  using Entity = std::variant<Face, Edge>;
  /// Kind, point, direction and two sizes: entities are equal if these are.
  using Key = std::array<double, 9>;

  /// Adds a set and returns its number; that of an equal set if there is one. Entities are equal if all numbers of
  /// their surface or curve are. Throws Error(input) that names `owner` for an entity that is none (fault_of in
  /// engine/geometry/entity_check.hpp), one without an equation, a torus that meets itself, and more sets than can be
  /// numbered.
  FeatureSetId add(const std::string& owner, std::span<const Entity> set);

  /// Assigns a set to a surface voxel. @param id  in [1, size()], or 0 to remove a set
  /// @pre body is the same in all calls and has a point for each surface voxel, voxel is below its surface_count, and
  /// id <= size()
  void assign(const VoxelBody& body, std::uint32_t voxel, FeatureSetId id);

  [[nodiscard]] std::size_t size() const { return sets_.size() - 1; }
  /// Number of entities in a set; 0 for the empty set. @pre id <= size()
  [[nodiscard]] std::size_t entities_in(FeatureSetId id) const {
    VERISIM_ASSERT(id <= size());
    return sets_[id].size();
  }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  /// Sets of the surface voxels; empty, or as long as the body's surface_count.
  [[nodiscard]] const std::vector<FeatureSetId>& of_voxel() const { return of_voxel_; }

  /// Entities of a set, ascending, when the declared faces count from `first_face` and the edges from `first_edge`.
  /// @pre id <= size(); the faces' numbers end where the edges' begin, or before
  [[nodiscard]] std::vector<EntityNumber> numbered(FeatureSetId id, EntityNumber first_face,
                                                   EntityNumber first_edge) const;

 private:
  /// Faces are 2 i, edges 2 i + 1.
  using Place = EntityNumber;

  [[nodiscard]] Place place_of(const std::string& owner, const Entity& entity);
  void add_normal(std::size_t face, const Vector3d& p, const Vector3d& inward);
  void extend(std::size_t face, std::span<const Place> set, const Vector3d& p, double half_side);
  [[nodiscard]] const Circle* rim_of(const Cylinder& cylinder, std::span<const Place> set) const;

  std::vector<Face> faces_;
  std::vector<bool> used_;           // a voxel has the face
  std::vector<double> outwardness_;  // sum over its voxels: above zero if inward normals point away from the axis
  std::vector<Edge> edges_;
  std::map<Key, Place> places_;
  FeatureSets sets_;  // of places
  std::vector<FeatureSetId> of_voxel_;
};

}  // namespace verisim

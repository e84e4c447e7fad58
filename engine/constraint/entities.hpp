// The input of recognition: the faces and edges of a part as closed variants, and the sets of them that voxels hold.
//
// Part coordinates, m and rad. An entity without size (zero radius, zero length, a number that is not finite) becomes
// OtherSurface or OtherCurve. No recognizer takes those, so recognizers may rely on their input.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/geometry/entity.hpp"

namespace verisim {

/// Pin: the material is inside of the curved shape. Hole: outside. A circle has the role of the curved face that it
/// bounds.
enum class Role : std::uint8_t { unknown, pin, hole };

/// A shape of engine/geometry/entity.hpp with its bounds in the part. Its point is moved to the middle of the bounded
/// part; a cone's radius is the one there.
template <typename Shape>
struct Bounded {
  Shape shape;
  double half_length = 0;  ///< m: along the axis or line to each side. Plane: half of its shorter side. Ball: 0.
                           ///< Circle: its radius, because a rim does not tell how long its pin or hole is.
  double tangent = 0;      ///< of a cone's half angle; 0 for all others
  Role role = Role::unknown;
};

using Entity =
    std::variant<Bounded<Plane>, Bounded<Cylinder>, Bounded<Cone>, Bounded<Sphere>, Bounded<Torus>,
                 Bounded<OtherSurface>, Bounded<Line>, Bounded<Circle>, Bounded<Ellipse>, Bounded<OtherCurve>>;

/// Faces and edges as entities. O(1).
[[nodiscard]] Entity entity_of(const Face& face);
[[nodiscard]] Entity entity_of(const Edge& edge, std::span<const Face> faces);

/// Number of a set of entities of one part; 0 is the empty set.
using FeatureSetId = std::uint16_t;

/// All entities of a part and the sets of them that its voxels hold. Entity number i is face i while i < faces.size(),
/// else edge i - faces.size(). Immutable once made; every access is O(1).
class EntitySets {
 public:
  /// No entity, and the empty set alone.
  EntitySets() = default;
  /// `sets` has size() and [id], which gives entity numbers: engine/voxel's FeatureSets, a vector of vectors. Set 0 is
  /// the empty one by everyone's convention. Throws Error(input) if a set names an entity that is not there, or if
  /// there are more sets than ids.
  template <typename Sets>
  EntitySets(std::span<const Face> faces, std::span<const Edge> edges, const Sets& sets)
      : EntitySets(entities_of(faces, edges), sets) {}
  template <typename Sets>
  EntitySets(std::vector<Entity> entities, const Sets& sets) : entities_(std::move(entities)) {
    const std::size_t count = sets.size();
    if (count == 0) return;
    first_.clear();
    for (std::size_t id = 0; id < count; ++id) add(sets[static_cast<FeatureSetId>(id)], count);
    first_.push_back(static_cast<std::uint32_t>(numbers_.size()));
    find_curved_neighbors();
  }

  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }  ///< sets, the empty one included
  [[nodiscard]] const std::vector<Entity>& entities() const { return entities_; }
  /// @pre number < entities().size()
  [[nodiscard]] const Entity& entity(std::uint32_t number) const {
    VERISIM_ASSERT(number < entities_.size());
    return entities_[number];
  }
  /// Entity numbers of a set; an id beyond the last is empty.
  [[nodiscard]] std::span<const std::uint32_t> set(FeatureSetId id) const {
    if (id >= size()) return {};
    return {numbers_.data() + first_[id], first_[id + 1U] - first_[id]};
  }
  /// Cylinders, cones and circles that belong to a common set with a plane, ascending: they may bound it. Empty for
  /// other entities.
  [[nodiscard]] std::span<const std::uint32_t> curved_neighbors(std::uint32_t plane) const {
    if (plane + 1U >= first_neighbor_.size()) return {};
    return {neighbors_.data() + first_neighbor_[plane], first_neighbor_[plane + 1U] - first_neighbor_[plane]};
  }

 private:
  [[nodiscard]] static std::vector<Entity> entities_of(std::span<const Face> faces, std::span<const Edge> edges);
  void add(std::span<const std::uint32_t> set, std::size_t sets);
  void find_curved_neighbors();

  std::vector<Entity> entities_;
  std::vector<std::uint32_t> first_ = {0, 0};  ///< (sets + 1) where each set begins in numbers_
  std::vector<std::uint32_t> numbers_;         ///< entity numbers, set after set
  std::vector<std::uint32_t> first_neighbor_;  ///< (entities + 1) where each plane's begin in neighbors_
  std::vector<std::uint32_t> neighbors_;       ///< entity numbers, plane after plane
};

}  // namespace verisim

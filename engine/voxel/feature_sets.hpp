// Interned (hash-consed) sets of b-rep entities: each set that occurs in a part is stored once and has a small number.
//
// Source: dissertation section 7.3 (feature sets of voxels, stored once; 12 bits of identity, here 16). A surface voxel
// holds the number of the set of entities that pass through it, so two voxels of one face hold the same number, and
// recognition can be memoized per pair of numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/geometry/entity.hpp"

namespace verisim {

/// Number of a set of b-rep entities of one body. 0: the empty set.
using FeatureSetId = std::uint16_t;

/// Number of an entity of one body: below faces.size() a face, from there on edge (number - faces.size()).
using EntityNumber = std::uint32_t;

class FeatureSets {
 public:
  static constexpr std::size_t kMostSets = 0xFFFF;  ///< that FeatureSetId can number, besides the empty set

  /// @param owner  the body's name in errors
  /// @param most   largest number of sets besides the empty set, up to kMostSets
  /// @pre most <= kMostSets
  explicit FeatureSets(std::string owner = {}, std::size_t most = kMostSets);

  /// The number of the set with these entities; a new set gets the next number. About 20 ns.
  /// Throws Error(input) that names the owner if there are more sets than may be stored: never a wrap-around.
  /// @pre entities ascend, none twice
  FeatureSetId intern(std::span<const EntityNumber> entities);

  /// The number that intern() would give without storing anything; none if it would be a new one.
  [[nodiscard]] std::optional<FeatureSetId> find(std::span<const EntityNumber> entities) const;

  /// Entities of a set, ascending. Valid until the next intern().
  /// `id` is a number that intern() gave. It is not asserted here, where every voxel passes (a sixth of association's
  /// time), but where ids enter: sets_by_slot.
  [[nodiscard]] std::span<const EntityNumber> operator[](FeatureSetId id) const {
    return {entities_.data() + begin_[id], begin_[id + std::size_t{1}] - begin_[id]};
  }

  /// Number of sets, the empty set included: every number is below it.
  [[nodiscard]] std::size_t size() const { return begin_.size() - 1; }
  [[nodiscard]] std::size_t memory_bytes() const;

  /// For engine/base/archive.hpp. Equal parts of bodies with other names are equal: the owner is not told.
  static void fields(auto& archive, FeatureSets& self) {
    archive(self.most_, self.begin_, self.entities_, self.table_);
  }

 private:
  [[nodiscard]] std::size_t place_of(std::span<const EntityNumber> entities) const;
  void grow();

  std::string owner_;
  std::size_t most_;
  std::vector<std::uint32_t> begin_ = {0, 0};  // (sets + 1): where each set begins in entities_
  std::vector<EntityNumber> entities_;
  std::vector<FeatureSetId> table_;  // open addressing, linear probing; 0: free (the empty set is not in it)
};

/// The entities of one body, in the order of their numbers, and the sets of them to which voxels refer.
struct BodyFeatures {
  std::vector<Face> faces;
  std::vector<Edge> edges;
  FeatureSets sets;

  [[nodiscard]] bool is_face(EntityNumber entity) const { return entity < faces.size(); }
  [[nodiscard]] const Face& face(EntityNumber entity) const { return faces[entity]; }
  [[nodiscard]] const Edge& edge(EntityNumber entity) const { return edges[entity - faces.size()]; }
  [[nodiscard]] std::size_t entity_count() const { return faces.size() + edges.size(); }
};

}  // namespace verisim

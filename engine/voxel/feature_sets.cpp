#include "engine/voxel/feature_sets.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"

namespace verisim {

namespace {

constexpr std::size_t kFirstCapacity = 64;  // a power of two, as all that follow

std::size_t hash_of(std::span<const EntityNumber> entities) {
  return static_cast<std::size_t>(hash_bytes(entities.data(), entities.size_bytes(), 0));
}

}  // namespace

FeatureSets::FeatureSets(std::string owner, std::size_t most)
    : owner_(std::move(owner)), most_(most), table_(kFirstCapacity, 0) {
  VERISIM_ASSERT(most <= kMostSets);
}

std::size_t FeatureSets::place_of(std::span<const EntityNumber> entities) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t place = hash_of(entities) & mask;
  while (table_[place] != 0 && !std::ranges::equal((*this)[table_[place]], entities)) place = (place + 1) & mask;
  return place;
}

std::optional<FeatureSetId> FeatureSets::find(std::span<const EntityNumber> entities) const {
  const FeatureSetId id = entities.empty() ? FeatureSetId{0} : table_[place_of(entities)];
  return entities.empty() || id != 0 ? std::optional(id) : std::nullopt;
}

FeatureSetId FeatureSets::intern(std::span<const EntityNumber> entities) {
  if (entities.empty()) return 0;
  VERISIM_ASSERT(std::ranges::adjacent_find(entities, std::ranges::greater_equal{}) == entities.end());
  std::size_t place = place_of(entities);
  if (table_[place] != 0) return table_[place];
  if (size() > most_) {
    fail(ErrorKind::input,
         "'{}': more than {} different sets of faces and edges meet its voxels; give it larger voxels or brep=false",
         owner_, most_);
  }
  if (2 * size() > table_.size()) {
    grow();
    place = place_of(entities);
  }
  const auto id = static_cast<FeatureSetId>(size());
  entities_.insert(entities_.end(), entities.begin(), entities.end());
  begin_.push_back(static_cast<std::uint32_t>(entities_.size()));
  table_[place] = id;
  return id;
}

void FeatureSets::grow() {
  table_.assign(2 * table_.size(), 0);
  for (std::size_t id = 1; id < size(); ++id) {
    table_[place_of((*this)[static_cast<FeatureSetId>(id)])] = static_cast<FeatureSetId>(id);
  }
}

std::size_t FeatureSets::memory_bytes() const {
  return begin_.capacity() * sizeof(std::uint32_t) + entities_.capacity() * sizeof(EntityNumber) +
         table_.capacity() * sizeof(FeatureSetId);
}

}  // namespace verisim

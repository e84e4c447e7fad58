// Feature sets: what is stored comes back, each set once, and no number is ever given twice.
#include "engine/voxel/feature_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "engine/voxel/association.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::feature_sets_test {
namespace {

using Set = std::vector<EntityNumber>;

Set random_set(test::Inputs& inputs, double largest) {
  Set set(static_cast<std::size_t>(inputs.between(0, 5)));
  for (EntityNumber& e : set) e = static_cast<EntityNumber>(inputs.between(0, largest));
  std::ranges::sort(set);
  set.erase(std::unique(set.begin(), set.end()), set.end());
  return set;
}

Set stored(const FeatureSets& sets, FeatureSetId id) {
  return {sets[id].begin(), sets[id].end()};
}

TEST(FeatureSets, NumberSetsAsAnOrderedMapDoes) {
  test::Inputs inputs(1);
  FeatureSets sets;
  std::map<Set, FeatureSetId> plain = {{{}, FeatureSetId{0}}};
  for (int i = 0; i < 20000; ++i) {
    const Set set = random_set(inputs, 40);
    const auto [known, is_new] = plain.try_emplace(set, static_cast<FeatureSetId>(plain.size()));
    ASSERT_EQ(sets.intern(set), known->second);
  }
  ASSERT_EQ(sets.size(), plain.size());
  EXPECT_GT(plain.size(), 1000U);
  for (const auto& [set, id] : plain) EXPECT_EQ(stored(sets, id), set);
}

TEST(FeatureSets, KnowTheEmptySetAsZeroFromTheStart) {
  FeatureSets sets;
  EXPECT_EQ(sets.size(), 1U);
  EXPECT_TRUE(sets[0].empty());
  EXPECT_EQ(sets.intern({}), 0);
  EXPECT_EQ(sets.size(), 1U);
}

TEST(FeatureSets, RefuseOneSetMoreThanAllowedAndNameTheBody) {
  FeatureSets sets("bracket", 3);
  for (EntityNumber e = 0; e < 3; ++e) EXPECT_EQ(sets.intern(Set{e}), e + 1);
  EXPECT_EQ(sets.intern(Set{1}), 2) << "a known set needs no new number";
  test::expect_refused([&] { return sets.intern(Set{3}); }, "'bracket': more than 3 different sets");
}

TEST(FeatureSets, UseEveryNumberAndThenRefuseInsteadOfWrappingAround) {
  FeatureSets sets("comb");
  for (EntityNumber e = 0; e < FeatureSets::kMostSets; ++e) ASSERT_EQ(sets.intern(Set{e, e + 1}), e + 1);
  EXPECT_EQ(stored(sets, 65535), (Set{65534, 65535}));
  test::expect_refused([&] { return sets.intern(Set{7}); }, "'comb': more than 65535 different sets");
}

}  // namespace
}  // namespace verisim::feature_sets_test

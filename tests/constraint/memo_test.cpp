// The memo: what is recognized once is not recognized again, and what cannot be stored is still right.
#include "engine/constraint/memo.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/constraint/parts.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::memo_test {
namespace {

namespace block = test::block_set;
namespace pin = test::pin_set;

TEST(PairMap, AnswersAsAStandardMapDoes) {
  for (const std::uint64_t seed : test::seeds(20)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> plain;
    PairMap fast(200);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const auto a = static_cast<std::uint32_t>(in.between(0, 15));
      const auto b = static_cast<std::uint32_t>(in.between(0, 15)) << (i % 3 == 0 ? 16U : 0U);
      const auto known = plain.find({a, b});
      ASSERT_EQ(fast.find(a, b), known == plain.end() ? PairMap::kAbsent : known->second);
      if (known != plain.end() || fast.size() == fast.capacity()) continue;
      plain[{a, b}] = i;
      fast.insert(a, b, i);
    }
    EXPECT_EQ(fast.size(), plain.size());
  }
}

TEST(ConstraintMemo, RecognizesEachPairOfSetsOnce) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  for (int round = 0; round < 1000; ++round) {
    (void)memo.look_up(block::wall, pin::side);  // a constraint
    (void)memo.look_up(block::wall, pin::end);   // none: an end face has no business with a wall
    (void)memo.look_up(block::nothing, pin::side);
  }
  EXPECT_EQ(memo.counts().misses_constraint, 1U);
  EXPECT_EQ(memo.counts().misses_null, 2U);
  EXPECT_EQ(memo.counts().hits, 2997U);
  EXPECT_EQ(memo.counts().recognitions, 2U);
  EXPECT_EQ(memo.counts().overflows, 0U);
}

TEST(ConstraintMemo, SharesAConstraintBetweenPairsOfSets) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  const Candidates wall = memo.candidates(memo.look_up(block::wall, pin::side));
  const Candidates rim = memo.candidates(memo.look_up(block::rim, pin::side));
  ASSERT_EQ(wall.count, 1);
  EXPECT_EQ(rim.constraint[0], wall.constraint[0]);
}

// Wall x side, rim x side and the side on the top: the dissertation's rule finds three and says none.
TEST(ConstraintMemo, AtARimFindsNothingByTheDissertationsRule) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::exactly_one, {});
  EXPECT_EQ(memo.candidates(memo.look_up(block::wall, pin::side)).count, 1);
  EXPECT_EQ(memo.candidates(memo.look_up(block::rim, pin::side)).count, 0);
}

// By the common freedom: wall and rim are one constraint, about one axis; the side along the top stays a candidate.
TEST(ConstraintMemo, AtARimMergesWallAndRim) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  const Candidates rim = memo.candidates(memo.look_up(block::rim, pin::side));
  ASSERT_EQ(rim.count, 2);
  EXPECT_EQ(memo.constraint(rim.constraint[0]).kind, ConstraintKind::cylindrical);
  EXPECT_EQ(memo.constraint(rim.constraint[1]).kind, ConstraintKind::other);
}

/// Number of gates of the planar constraint between the two ends, found through one pair of voxels.
std::size_t gate_count(const EntitySets& a, const EntitySets& b, FeatureSetId set_a, FeatureSetId set_b,
                       Reduction reduction = Reduction::common_freedom) {
  ConstraintMemo memo(a, b, reduction, {});
  const Candidates found = memo.candidates(memo.look_up(set_a, set_b));
  std::size_t fits = 0;
  for (std::size_t i = 0; i < found.count; ++i) {
    for (const std::uint16_t gate : memo.gates_of(found.constraint[i])) {
      EXPECT_EQ(memo.constraint(found.constraint[i]).kind, ConstraintKind::planar);
      EXPECT_EQ(memo.constraint(gate).kind, ConstraintKind::cylindrical);
      ++fits;
    }
  }
  return fits;
}

// The fit gates the end on the top, once, whether or not the two voxels know of the fit. A collar is not gated.
TEST(ConstraintMemo, GatesBetweenConvexRimsOnly) {
  const EntitySets a = test::block_with_hole();
  const EntitySets straight = test::pin();
  const EntitySets collared = test::collared_pin();
  for (const FeatureSetId set_a : {block::top, block::rim}) {
    for (const FeatureSetId set_b : {pin::end, pin::edge}) {
      EXPECT_EQ(gate_count(a, straight, set_a, set_b), 1U);
      EXPECT_EQ(gate_count(a, collared, set_a, set_b), 0U);
    }
  }
  EXPECT_EQ(gate_count(a, straight, block::top, pin::end, Reduction::exactly_one), 0U);
}

// Two holes in one top: the pin's end may cover either.
TEST(ConstraintMemo, IsGatedByEveryHoleThatFits) {
  const Vector3d there(0.3, 0, 0);
  const std::vector<Entity> plate = {test::plane(test::kZ, {0, 0, 0.1}), test::cylinder(0.075, /*hole=*/true),
                                     test::cylinder(0.075, /*hole=*/true, 0.1, there),
                                     test::cylinder(0.02, /*hole=*/true, 0.1, -there)};
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0}, {0, 1}, {0, 2}, {0, 3}};
  EXPECT_EQ(gate_count(EntitySets(plate, sets), test::pin(), 1, pin::end), 2U);
}

TEST(ConstraintMemo, DoesNotMindAnEntityThatTouchesNoVoxel) {
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0}};
  const std::vector<Entity> with_more = {test::cylinder(0.075, /*hole=*/true), test::cylinder(0.0751, /*hole=*/true)};
  const EntitySets a(with_more, sets);
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  const Candidates found = memo.candidates(memo.look_up(1, pin::side));
  ASSERT_EQ(found.count, 1);
  EXPECT_EQ(memo.constraint(found.constraint[0]).a.radius, 0.075);
  EXPECT_EQ(memo.counts().recognitions, 1U);
}

// A freeform part: as many sets as faces, none of them with an equation. Pairs beyond the memo's room are found anew,
// to nothing each time, and nothing grows.
TEST(ConstraintMemo, FallsBackForThousandsOfFreeformFaces) {
  constexpr std::uint32_t kFaces = 20000;
  std::vector<std::vector<std::uint32_t>> sets(1);
  for (std::uint32_t face = 0; face < kFaces; ++face) sets.push_back({face});
  const EntitySets a(std::vector<Entity>(kFaces, Bounded<OtherSurface>()), sets);
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  const std::uint64_t before = allocations;
  for (FeatureSetId id = 0; id < a.size(); ++id) {
    EXPECT_EQ(memo.candidates(memo.look_up(id, pin::side)).count, 0);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(memo.counts().misses_null, kFaces + 1);
  EXPECT_EQ(memo.counts().overflows, kFaces + 1 - MemoLimits().pairs);
}

// A full memo is slow, not wrong.
TEST(ConstraintMemo, WithoutRoomAnswersTheSame) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo roomy(a, b, Reduction::common_freedom, {});
  ConstraintMemo tight(a, b, Reduction::common_freedom, {}, {.pairs = 2, .constraints = 4096});
  for (int round = 0; round < 3; ++round) {
    for (FeatureSetId i = 0; i < a.size(); ++i) {
      for (FeatureSetId j = 0; j < b.size(); ++j) {
        const Candidates wanted = roomy.candidates(roomy.look_up(i, j));
        const Candidates found = tight.candidates(tight.look_up(i, j));
        ASSERT_EQ(found.count, wanted.count);
        for (std::size_t k = 0; k < found.count; ++k) {
          EXPECT_EQ(tight.constraint(found.constraint[k]).kind, roomy.constraint(wanted.constraint[k]).kind);
        }
      }
    }
  }
  EXPECT_EQ(roomy.counts().overflows, 0U);
  EXPECT_EQ(tight.counts().overflows, 3U * (16 - 2));
}

TEST(ConstraintMemo, WithoutRoomForConstraintsFindsNoneAndSaysSo) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {}, {.pairs = 100, .constraints = 0});
  EXPECT_EQ(memo.candidates(memo.look_up(block::wall, pin::side)).count, 0);
  EXPECT_GT(memo.counts().overflows, 0U);
}

// Nine planes that lean differently meet one: nine constraints, one more than a pair of sets has room for.
TEST(ConstraintMemo, CountsAConstraintThatItsPairOfSetsHasNoRoomFor) {
  const auto plane = [](double lean) {
    const Vector3d normal = Vector3d(lean, 0, 1).normalized();
    return Bounded<Plane>{{Vector3d::Zero(), normal, Vector3d::UnitY()}, 0.1};
  };
  std::vector<Entity> leaning;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i <= Candidates::kMax; ++i) {
    leaning.emplace_back(plane(0.1 * i));
    all.push_back(i);
  }
  const std::vector<std::vector<std::uint32_t>> sets_a = {{}, all};
  const std::vector<std::vector<std::uint32_t>> sets_b = {{}, {0}};
  const EntitySets a(leaning, sets_a);
  const EntitySets b({plane(0)}, sets_b);
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  EXPECT_EQ(memo.candidates(memo.look_up(1, 1)).count, Candidates::kMax);
  EXPECT_EQ(memo.counts().overflows, 1U);
}

TEST(ConstraintMemo, AllocatesNothingAfterItIsMade) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintMemo memo(a, b, Reduction::common_freedom, {});
  const std::uint64_t before = allocations;
  for (FeatureSetId i = 0; i < a.size(); ++i) {
    for (FeatureSetId j = 0; j < b.size(); ++j) (void)memo.look_up(i, j);
  }
  EXPECT_EQ(allocations, before);
}

TEST(EntitySets, RefusesAnEntityThatThePartDoesNotHave) {
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0, 1}};
  test::expect_refused([&] { return EntitySets(std::vector<Entity>{test::plane(test::kZ)}, sets); }, "entity 1");
}

TEST(EntitySets, TakesEveryIdAndNoMore) {
  std::vector<std::vector<std::uint32_t>> sets(65536, std::vector<std::uint32_t>{0});
  const std::vector<Entity> one = {test::plane(test::kZ)};
  EXPECT_EQ(EntitySets(one, sets).set(65535).size(), 1U);
  sets.emplace_back();
  test::expect_refused([&] { return EntitySets(one, sets); }, "65537");
}

TEST(EntitySets, OfNothingHoldsTheEmptySet) {
  const EntitySets none;
  EXPECT_EQ(none.size(), 1U);
  EXPECT_TRUE(none.set(0).empty());
  EXPECT_TRUE(none.set(7).empty());
}

}  // namespace
}  // namespace verisim::memo_test

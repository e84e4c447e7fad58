// The pairs of what moves, found alone, are those that a search over everything finds.
#include "engine/contact/broad_phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/random.hpp"

namespace verisim::broad_phase_test {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs without_others(const Pairs& pairs, const std::vector<std::size_t>& bodies) {
  const auto is_one = [&](std::uint32_t i) { return std::binary_search(bodies.begin(), bodies.end(), i); };
  Pairs kept;
  for (const auto& [i, j] : pairs)
    if (is_one(i) || is_one(j)) kept.emplace_back(i, j);
  return kept;
}

TEST(BroadPhase, FindsOfSomeWhatItFindsOfAll) {
  constexpr std::size_t kBodies = 60;
  const RandomStream random(7, "broad phase");
  std::uint64_t drawn = 0;
  const auto place = [&] {
    const Vector3d p(random.uniform(drawn), random.uniform(drawn + 1), random.uniform(drawn + 2));
    const Vector3d axis(random.normal(drawn + 3), random.normal(drawn + 4), random.normal(drawn + 5));
    drawn += 6;
    return Pose{p, rotation_from_vector(axis)};
  };
  std::vector<BroadPhaseBody> bodies;
  for (std::size_t i = 0; i < kBodies; ++i)
    bodies.push_back({Vector3d::Constant(0.01), Vector3d::Constant(0.02 + 0.08 * random.uniform(drawn++)), i % 4 != 0});
  BroadPhase some(bodies), all(bodies);
  for (std::size_t i = 0; i < kBodies; ++i) {
    const Pose X = place();
    some.set_pose(i, X, 0.01);
    all.set_pose(i, X, 0.01);
  }
  EXPECT_EQ(some.find(), all.find());
  std::size_t found = 0;
  for (int round = 0; round < 300; ++round) {
    const double share = random.uniform(drawn++);
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < kBodies; ++i)
      if (bodies[i].can_move && random.uniform(drawn++) < share) moved.push_back(i);
    for (const std::size_t i : moved) {
      const Pose X = place();
      some.set_pose(i, X, 0.01);
      all.set_pose(i, X, 0.01);
    }
    const Pairs expected = without_others(all.find(), moved);
    ASSERT_EQ(some.find_of(moved), expected) << "round " << round;
    found += expected.size();
  }
  EXPECT_GT(found, 10000U);
}

}  // namespace
}  // namespace verisim::broad_phase_test

// Straight edges against edges of planes: those that the search passes over at a glance have no crossing, whichever
// segment is looked at in full.
#include "engine/exact/edge_crossing.hpp"

#include <gtest/gtest.h>

#include "tests/exact/scenes.hpp"
#include "tests/length.hpp"

namespace verisim::exact::test::edge_crossing_test {
namespace {

constexpr double kMargin = 0.001;

struct Count {
  int passed_over = 0, crossed = 0;
};

/// Looks at all segments of `mover` and convex edges of `base` in full, at one pose.
void look_in_full(const ExactBody& mover, const ExactBody& base, const RelativeMotion& motion, Count& count) {
  const BodyPair pair{mover, base, motion};
  for (const Feature& feature : mover.features) {
    if (feature.kind != Feature::Kind::line || feature.own_face != kNoFace) continue;
    const PlacedFeature placed{&feature, motion.now.R * feature.origin + motion.now.p, motion.now.R * feature.x,
                               motion.now.R * feature.y};
    for (const ExactEdge& edge : base.edges) {
      if (edge.convexity != Convexity::convex) continue;
      const bool may_cross = may_cross_edge(pair, placed, edge);
      count.passed_over += may_cross ? 0 : 1;
      for (std::uint32_t sample = feature.begin; sample < feature.end; ++sample) {
        Candidate c;
        c.sample = sample;
        const auto near = [&](std::size_t side) {
          return closest_place_to(pair, *base.faces[edge.faces[side]].surface, placed, sample);
        };
        const bool crosses = cross_edge(pair, placed, edge, {near(0), near(1)}, c) && c.gap < motion.margin &&
                             c.gap >= -base.options.spacing;
        count.crossed += crosses ? 1 : 0;
        ASSERT_TRUE(may_cross || !crosses);
      }
    }
  }
}

TEST(EdgeCrossing, NoneWhereTheSearchPassesOver) {
  const Solid box = make(Solid::Kind::box, {0.03, 0.04, 0.02}), cube = make(Solid::Kind::box, {0.03, 0.03, 0.03});
  Count count;
  for (const double spacing : {0.004, 0.05}) {
    const auto mover = body_of(box, spacing), base = body_of(cube, spacing);
    const auto poses = verisim::test::by_length<std::uint64_t>(200, 2000, 40000);
    for (std::uint64_t seed = 0; seed < poses; ++seed) {
      Draw draw(seed);
      RelativeMotion motion{};
      motion.now.R = (seed % 8 == 0 ? Quaterniond::Identity() : draw.rotation()).toRotationMatrix();
      motion.now.p = draw.in_box({0.03, 0.03, 0.03});
      motion.free_twist = {draw.in_box({1, 1, 1}), draw.in_box({9, 9, 9})};
      motion.last_twist = {draw.in_box({1, 1, 1}), draw.in_box({9, 9, 9})};
      motion.dt = 0.001;
      motion.margin = kMargin;
      ASSERT_NO_FATAL_FAILURE(look_in_full(*mover, *base, motion, count)) << "spacing " << spacing << " seed " << seed;
    }
  }
  EXPECT_GT(count.passed_over, 1000);
  EXPECT_GT(count.crossed, 100);
}

}  // namespace
}  // namespace verisim::exact::test::edge_crossing_test

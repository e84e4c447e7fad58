// The ruler itself, before it judges anything: against closed forms, and against itself elsewhere and the other way
// round. Depths in m.
#include "engine/ruler/solid_depth.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "tests/length.hpp"
#include "tests/ruler/shapes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::solid_depth_test {
namespace {

using ruler::Overlap;
using ruler::test::at;
using ruler::test::of;

const std::string kPlate = "box(0.2,0.2,0.02)";  // its upper face at 0.01
const std::string kBlock = "difference(box(0.06,0.06,0.03),cylinder(0.01001,0.03))";

/// The depth that was found is at most the true one, and that at most `bound` more.
void expect_depth(const Overlap& found, double truth, double bound) {
  EXPECT_LE(found.depth, truth * (1 + 1e-9) + test::tolerance(1e-14));
  EXPECT_GE(found.depth + found.bound, truth * (1 - 1e-9) - test::tolerance(1e-14));
  EXPECT_LE(found.bound, bound);
}

TEST(SolidDepth, OfABallInAPlaneIsHowFarItReachesBelow) {
  for (const double d : {1e-7, 1e-6, 1e-5, 1e-3}) {
    SCOPED_TRACE(d);
    expect_depth(of("sphere(0.02)", at(0.001, 0.002, 0.03 - d), kPlate), d, 1e-3 * d + 1e-9);
  }
}

// A corner of a cube of half side h, turned so that a diagonal points down, is h sqrt(3) below its middle.
TEST(SolidDepth, OfABoxsCornerInAPlaneIsHowFarItReachesBelow) {
  const double down = 0.02 * std::sqrt(3.0);
  const Quaterniond diagonal = Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), Vector3d(0, 0, -1));
  for (const double d : {1e-6, 1e-5, 1e-3}) {
    SCOPED_TRACE(d);
    expect_depth(of("box(0.04,0.04,0.04)", {{0.001, 0.002, 0.01 + down - d}, diagonal}, kPlate), d, 1e-3 * d + 1e-9);
  }
}

TEST(SolidDepth, OfFlatFacesIsTheirOverlap) {
  expect_depth(of("box(0.04,0.04,0.04)", at(0.001, 0.002, 0.03 - 1e-5), kPlate), 1e-5, 1e-8);
}

TEST(SolidDepth, OfACylinderLyingOnAPlaneIsHowFarItReachesBelow) {
  const Pose lying = at(0.001, 0.002, 0.02 - 1e-5, {0.25 * 6.283185307179586, 0, 0});
  expect_depth(of("cylinder(0.01,0.03)", lying, kPlate), 1e-5, 2e-8);
}

// Two square edges that cross: each lies d below the other, and each's faces stand at 45 degrees.
TEST(SolidDepth, OfCrossingEdgesIsTheDistanceToTheNearerFace) {
  const double eighth = 0.7853981633974483, reach = 0.02 * std::sqrt(2.0);
  const double d = 1e-5;
  expect_depth(of("box(0.04,0.04,0.04)", at(0, 0, 2 * reach - d, {eighth, 0, 0}), "box(0.04,0.04,0.04)",
                  at(0, 0, 0, {0, eighth, 0})),
               d * std::sqrt(0.5), 1e-8);
}

// A pin of radius r and a bore of radius R whose axes cross at an angle t, in a block of height h: at the bore's rims
// the pin's section is an ellipse r wide in one direction and r/cos t in the other, moved by (h/2) tan t: there its
// side is r/cos t + (h/2) tan t from the bore's axis. The nearest of the pin's own points to the block's surface lies
// within: the rim itself is (h/2) sin t + r - R cos t inside the pin, measured across the pin.
TEST(SolidDepth, OfATiltedPinInABoreIsThatOfTheBoresRimInThePin) {
  for (const double t : {0.0012, 0.002, 0.005}) {
    SCOPED_TRACE(t);
    const double rim = 0.015 * std::sin(t) + 0.01 - 0.01001 * std::cos(t);
    ruler::Accuracy accuracy = ruler::test::kFine;
    accuracy.absolute = 1e-7;
    const Overlap found = of("cylinder(0.01,0.06)", at(0, 0, 0, {t, 0, 0}), kBlock, {}, accuracy);
    EXPECT_GE(found.depth, rim - 2e-7);
    EXPECT_LE(found.depth, rim * (1 + t) + 2e-7);
    EXPECT_LE(found.bound, 2e-7 + 1e-2 * rim);
  }
}

TEST(SolidDepth, OfAPinBesideTheMiddleOfItsBoreIsWhatTheClearanceDoesNotLeave) {
  ruler::Accuracy accuracy = ruler::test::kFine;
  accuracy.absolute = 1e-7;
  expect_depth(of("cylinder(0.01,0.04)", at(11e-6, 0, 0.002), kBlock, {}, accuracy), 1e-6, 2e-7);
  EXPECT_EQ(of("cylinder(0.01,0.04)", at(2e-6, 0, 0.002), kBlock, {}, accuracy).depth, 0);
}

// A box in the corner of a pit, d beyond each of two walls and the floor: its corner is d sqrt(3) from the pit's.
TEST(SolidDepth, OfACornerInACornerIsTheDistanceOfBoth) {
  const double d = 1e-5;
  const Overlap found = of("box(0.02,0.02,0.02)", at(0.005 + d, 0.005 + d, 0.005 + d),
                           "difference(box(0.06,0.06,0.06),box(0.03,0.03,0.03))");
  EXPECT_NEAR(found.depth, d * std::sqrt(3.0), 1e-9);
}

// A ring that lies on a plate reaches d into it all around; a tilted one with its lowest point; one that stands, with
// the outermost point of its tube.
TEST(SolidDepth, OfATorusInAPlaneIsHowFarItReachesBelow) {
  const std::string ring = "torus(0.01,0.004)", plate = "placed(0,0,-0.01;0,0,0,1;box(0.1,0.1,0.02))";
  for (const double d : {1e-7, 1e-5, 1e-4}) {
    SCOPED_TRACE(d);
    for (const double tilt : {0.0, 0.3, 0.25 * pinned::kFullTurn}) {
      const double lowest = 0.01 * pinned::sin(tilt) + 0.004;
      const Overlap found = of(ring, at(0.001, 0.002, lowest - d, {tilt, 0, 0}), plate);
      expect_depth(found, d, 2e-3 * d + (tilt == 0 ? 1e-7 : 2e-9));  // as deep all around: more to search
    }
  }
}

// A ball in a ring's hole touches it along a circle, all around: of a ball of radius r whose centre is h over the
// ring's plane the distance to the tube is sqrt(R^2 + h^2) - r - t.
TEST(SolidDepth, OfABallInATorusIsTheDistanceOfItsCentreToTheRing) {
  const double d = 1e-6, h = std::sqrt(0.012 * 0.012 - 0.01 * 0.01);
  const double radius = 0.012 - 0.004 + d;
  const Overlap found = of("sphere(" + std::to_string(radius * 1e3) + "e-3)", at(0, 0, h), "torus(0.01,0.004)", {},
                           {.absolute = 2e-7, .relative = 0.01, .pieces_max = 4000});
  EXPECT_NEAR(found.depth, d, 0.2 * d);
  EXPECT_LE(found.bound, 3e-7);
}

// A sum of two primitives that touch has no surface between them.
TEST(SolidDepth, KnowsThatTouchingPrimitivesAreOne) {
  const ruler::Csg post(
      "sum(placed(0,0,0.01;0,0,0,1;box(0.02,0.02,0.02)),placed(0,0,-0.01;0,0,0,1;box(0.02,0.02,0.02)))");
  EXPECT_NEAR(ruler::depth_of({0, 0, 0}, post), 0.01, test::tolerance(1e-15));
  EXPECT_NEAR(ruler::depth_of({0.008, 0, 1e-9}, post), 0.002, test::tolerance(1e-15));
}

// The bore's rim was cut away by a countersink that is flush with the block: it was taken for surface, 1 mm deep in a
// box that lies in the opening.
TEST(SolidDepth, KnowsThatARimThatWasCutAwayIsNone) {
  const std::string bored = "difference(placed(0,0,-0.03;0,0,0,1;box(0.2,0.2,0.06)),cylinder(0.02,0.2))";
  const std::string sunk = "difference(" + bored + ",placed(0,0,-0.01;0,0,0,1;cone(0.02,0.04,0.02)))";
  const std::string higher = "difference(" + bored + ",placed(0,0,-0.0095;0,0,0,1;cone(0.02,0.041,0.021)))";
  Pose X;
  X.rotation = rotation_from_vector(0.3 * Vector3d(1, 0.3, 0.2).normalized());
  for (const std::string& seat : {sunk, higher}) {
    const Overlap found = of("box(0.03,0.03,0.03)", X, seat, {}, {});
    EXPECT_EQ(found.depth, 0) << seat;
  }
}

// Rigid motions change the roundings alone; what is found may differ by what the search may miss.
TEST(SolidDepth, IsTheSameElsewhereAndTheOtherWayRound) {
  const std::vector<std::string> solids = {
      "sphere(0.01)",          "cylinder(0.01,0.03)",    "box(0.02,0.03,0.01)",
      "cone(0.002,0.01,0.02)", "tube(0.012,0.008,0.02)", "difference(box(0.04,0.04,0.02),cylinder(0.006,0.03))"};
  const RandomStream random(1, "elsewhere");
  std::uint64_t deep = 0;
  const auto count = test::by_length<std::uint64_t>(10, 60, 60);
  for (std::uint64_t i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const std::string& a = solids[i % solids.size()];
    const std::string& b = solids[(i / solids.size()) % solids.size()];
    const Pose X_WA = ruler::test::random_pose(random, 100 * i, 0.012),
               X_WB = ruler::test::random_pose(random, 100 * i + 10, 0.001);
    const Pose X = ruler::test::random_pose(random, 100 * i + 20, 0.5);
    const ruler::Accuracy accuracy{.absolute = 1e-6, .relative = 0.01, .pieces_max = 4000};
    const Overlap here = of(a, X_WA, b, X_WB, accuracy), there = of(a, X * X_WA, b, X * X_WB, accuracy),
                  swapped = of(b, X_WB, a, X_WA, accuracy);
    deep += here.depth > 1e-4 ? 1 : 0;
    for (const Overlap& other : {there, swapped}) {
      EXPECT_LE(here.depth, other.depth + other.bound + 1e-12);
      EXPECT_LE(other.depth, here.depth + here.bound + 1e-12);
    }
  }
  EXPECT_GT(deep, count / 3) << "hardly any of the placements overlapped";
}

TEST(SolidText, ThatIsNotOneIsRefused) {
  for (const char* text : {"", "box(1,1)", "box(1,1,1", "ball(1)", "box(1,1,1)x", "sum(box(1,1,1))", "sphere(nan)"})
    EXPECT_THROW(ruler::Csg{text}, Error) << text;
}

}  // namespace
}  // namespace verisim::solid_depth_test

// The three alignment measures: published numbers, and what a degree means to each kind of constraint.
#include "engine/constraint/alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/pinned_math.hpp"
#include "engine/constraint/recognition.hpp"
#include "tests/constraint/shapes.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::alignment_test {
namespace {

using test::circle;
using test::cone;
using test::cylinder;
using test::kX;
using test::kZ;
using test::line;
using test::plane;
using test::sphere;
using test::tolerance;
using test::torus;

constexpr double kDegree = pinned::kPi / 180;
constexpr AlignmentMeasure kAll[] = {AlignmentMeasure::faas, AlignmentMeasure::pavlik, AlignmentMeasure::by_type};

double alpha(AlignmentMeasure measure, const Constraint& c, const Pose& X_AB, double voxel = 0.0045) {
  return alignment(measure, c, misalignment(c, X_AB), {.voxel_size = voxel});
}
double by_type(const Constraint& c, const Pose& X_AB) {
  return alpha(AlignmentMeasure::by_type, c, X_AB);
}

/// The dissertation's trial: hole of 75 mm through 200 mm, pin of 70 mm, 400 mm long; turned by `tilt` about x.
Constraint peg(double pin_radius = 0.070, double hole_half = 0.1) {
  return recognize(cylinder(0.075, /*hole=*/true, hole_half), cylinder(pin_radius, /*hole=*/false, 0.2));
}
Pose tilted(double tilt, const Vector3d& p = Vector3d::Zero()) {
  return {p, rotation_from_vector(tilt * kX)};
}

TEST(Alignment, IsOneWhenEverythingCoincides) {
  for (const AlignmentMeasure measure : kAll) {
    EXPECT_EQ(alpha(measure, peg(), Pose()), 1);
    EXPECT_EQ(alpha(measure, recognize(sphere(0.03, true), sphere(0.03, false)), Pose()), 1);
    EXPECT_EQ(alpha(measure, recognize(plane(kZ), plane(-kZ)), Pose()), 1);
    EXPECT_EQ(alpha(measure, recognize(torus(0.1, 0.01, true), torus(0.1, 0.01, false)), Pose()), 1);
    EXPECT_EQ(alpha(measure, recognize(cone(0.05, 0.3, true), cone(0.05, 0.3, false)), Pose()), 1);
  }
}

// A clearance of nothing at all (published: 0/0) and axes that are exactly parallel (published: 0/0).
TEST(Alignment, IsFiniteForZeroClearanceAndCoincidentAxes) {
  const Constraint tight = peg(0.075);
  EXPECT_EQ(tight.clearance, 0);
  for (const AlignmentMeasure measure : kAll) {
    EXPECT_EQ(alpha(measure, tight, Pose()), 1);
    const double beside = alpha(measure, tight, {{1e-4, 0, 0}, Quaterniond::Identity()});
    EXPECT_TRUE(std::isfinite(beside));
    EXPECT_LT(beside, 1);
  }
}

// Through parallel, by steps of a billionth: no step of alpha may be more than the motion explains. The distance moves
// by at most 0.1 m x 1e-9, eq. 8.2 is steepest with 10 / 5 mm: 1e-7 covers all three measures.
TEST(Alignment, IsContinuousThroughParallel) {
  for (const AlignmentMeasure measure : kAll) {
    for (const double across : {0.0, 1e-3, 4e-3}) {
      for (const Vector3d& side : {Vector3d(across, 0, 0), Vector3d(0, across, 0)}) {
        double before = alpha(measure, peg(), tilted(-2e-8, side));
        for (int i = -19; i <= 20; ++i) {
          const double now = alpha(measure, peg(), tilted(1e-9 * i, side));
          EXPECT_LE(std::abs(now - before), tolerance(1e-7)) << i << " at " << side.transpose();
          before = now;
        }
      }
    }
  }
}

// The published distance of infinite lines jumps from the offset to 0 as parallel lines tilt by a hair in their plane.
TEST(Misalignment, MeasuresDistanceWithinTheHole) {
  const double offset = 0.003;
  EXPECT_NEAR(misalignment(peg(), tilted(1e-6, {0, offset, 0})).distance, offset, 1e-6);  // they meet 3 km away
  EXPECT_NEAR(misalignment(peg(), tilted(0.05, {0, offset, 0})).distance, 0, 1e-15);      // and here inside
  EXPECT_NEAR(misalignment(peg(), tilted(0.05, {offset, 0, 0})).distance, offset, 1e-15);
}

// ORACLES section 2, two-point contact: 2R cos t - l sin t = 2r. A pin is free up to there, so alpha stays 1; beyond it
// falls. To first order t = 2 (R - r) / l; exact 2.81410 degrees, first order 2.8624 (tan t = 0.05).
TEST(AlignmentByType, OfAPinStaysOneWhileThePinIsFree) {
  EXPECT_EQ(by_type(peg(), tilted(2.8141 * kDegree)), 1);
  EXPECT_LT(by_type(peg(), tilted(2.87 * kDegree)), 1);
  EXPECT_EQ(by_type(peg(), {{0.0049, 0, 0}, Quaterniond::Identity()}), 1);
  EXPECT_NEAR(by_type(peg(), {{0.005 + 0.0009, 0, 0}, Quaterniond::Identity()}), 1 - 0.9 / 4.5, tolerance(1e-12));
}

// Section 9.1: a degree of tilt has a different meaning for each kind of constraint.
TEST(AlignmentByType, OneDegreeCostsALongPinMoreThanAShortOneAndPlanesHardly) {
  const double fit = 0.07499;  // 10 um
  const double needle = by_type(peg(fit, 0.2), tilted(kDegree));
  const double coin = by_type(peg(fit, 0.01), tilted(kDegree));
  const double planes = by_type(recognize(plane(kZ), plane(-kZ)), tilted(kDegree));
  const double ball = by_type(recognize(sphere(0.03, true), sphere(0.0299, false)), tilted(kDegree));
  // The needle is as long as its hole: tilted, it reaches over 0.2 cos(theta) of it to each side.
  EXPECT_NEAR(needle, 1 - (0.2 * std::sin(kDegree) - 1e-5) / 0.0045, tolerance(1e-9));
  EXPECT_NEAR(coin, 1 - (0.01 * std::tan(kDegree) - 1e-5) / 0.0045, tolerance(1e-9));
  EXPECT_NEAR(planes, 1 - std::tan(kDegree) * std::tan(kDegree), tolerance(1e-12));
  EXPECT_EQ(ball, 1);
  EXPECT_LT(needle, 0.3);
  EXPECT_GT(coin, 0.95);
  EXPECT_GT(planes, 0.999);
}

TEST(AlignmentByType, IsZeroForAPinBesideOrAcrossItsHole) {
  EXPECT_EQ(by_type(peg(), {{0.2, 0, 0}, Quaterniond::Identity()}), 0);
  EXPECT_EQ(by_type(peg(), tilted(90 * kDegree)), 0);
  EXPECT_GE(alpha(AlignmentMeasure::pavlik, peg(), {{0.2, 0, 0}, Quaterniond::Identity()}), 0.5);  // the published one
}

// Before its end has passed the rim a pin that stands beside its hole is not in it; a plate thinner than a voxel is
// passed once the pin is through.
TEST(AlignmentByType, OfAPinBesideItsHoleBeginsAtTheRimAndIsWholeAVoxelBehindIt) {
  const double beside = 0.001, aligned = 1 - beside / 0.0045;
  const auto deep = [&](const Constraint& c, double rim, double depth) {
    return by_type(c, {{0.005 + beside, 0, rim + 0.2 - depth}, Quaterniond::Identity()});
  };
  for (const double depth : {-0.1, -0.001, 0.0, 0.001, 0.002, 0.0045, 0.1}) {
    EXPECT_NEAR(deep(peg(), 0.1, depth), aligned * std::clamp(depth / 0.0045, 0.0, 1.0), tolerance(1e-12)) << depth;
    EXPECT_NEAR(deep(peg(0.070, 0.001), 0.001, depth), aligned * std::clamp(depth / 0.002, 0.0, 1.0), tolerance(1e-12))
        << depth;
  }
}

// A pin that stands freely before its hole touches nothing, so no contact may hold it there. That ends a tenth of a
// voxel beside the hole.
TEST(AlignmentByType, OfAPinThatStandsFreelyBeforeItsHoleIsWhole) {
  const auto before = [](double offset) { return by_type(peg(), {{offset, 0, 0.301}, Quaterniond::Identity()}); };
  EXPECT_EQ(before(0), 1);
  EXPECT_EQ(before(0.00499), 1);
  for (double beside = 0; beside < 0.0006; beside += 1e-5)
    EXPECT_NEAR(before(0.005 + beside), std::max(0.0, 1 - beside / 0.00045), tolerance(1e-9)) << beside;
}

// A pin of 70 mm covers part of a hole of 75 mm up to 145 mm between their axes.
TEST(ClearOfHole, BeginsWhereTheEndCoversNoPartOfTheHole) {
  const auto at = [](const Pose& X) { return clear_of_hole(peg(), misalignment(peg(), X), {.voxel_size = 0.0045}); };
  for (const double offset : {0.0, 0.005, 0.07, 0.1449, 0.146, 0.149, 0.15, 1.0}) {
    EXPECT_NEAR(at({{offset, 0, 0.3}, Quaterniond::Identity()}), std::clamp((offset - 0.145) / 0.0045, 0.0, 1.0),
                tolerance(1e-12));
  }
  EXPECT_EQ(at({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, Quaterniond::Identity()}), 0);
}

TEST(AlignmentByType, OfPlanesNeedsThemToFaceEachOther) {
  EXPECT_EQ(by_type(recognize(plane(kZ), plane(-kZ)), Pose()), 1);
  EXPECT_EQ(by_type(recognize(plane(kZ), plane(kZ)), Pose()), 0);
  EXPECT_EQ(by_type(recognize(plane(kZ), plane(kX)), Pose()), 0);
  EXPECT_NEAR(by_type(recognize(plane(kZ), plane(kZ)), tilted(180 * kDegree)), 1, tolerance(1e-15));
}

// A cone pulled out of its seat by h has the radial room h tan(half angle); cones that open opposite ways do not mate.
TEST(AlignmentByType, OfConesAllowsWhatPullingOutGives) {
  const Constraint c = recognize(cone(0.05, 0.3, true), cone(0.05, 0.3, false));
  const double room = 0.01 * std::tan(0.3);
  EXPECT_EQ(by_type(c, {{room * 0.999, 0, 0.01}, Quaterniond::Identity()}), 1);
  EXPECT_LT(by_type(c, {{room * 1.001, 0, 0.01}, Quaterniond::Identity()}), 1);
  EXPECT_LT(by_type(c, {{room * 0.999, 0, 0}, Quaterniond::Identity()}), 1);
  EXPECT_EQ(by_type(c, tilted(180 * kDegree)), 0);
}

TEST(AlignmentByType, OfABallInATubeKnowsNoAngleAndEndsWithTheTube) {
  const Constraint c = recognize(cylinder(0.03, true), sphere(0.029, false));
  EXPECT_EQ(by_type(c, tilted(1, {0.0009, 0, 0.09})), 1);
  EXPECT_NEAR(by_type(c, {{0.002, 0, 0}, Quaterniond::Identity()}), 1 - 1 / 4.5, tolerance(1e-12));
  EXPECT_LT(by_type(c, {{0, 0, 0.1011}, Quaterniond::Identity()}), 1);  // its middle is past the end
}

TEST(AlignmentByType, OfAnEdgeIsTheAngleOutOfThePlane) {
  const Constraint c = recognize(plane(kZ), line(Vector3d::UnitY()));
  EXPECT_EQ(by_type(c, Pose()), 1);
  EXPECT_NEAR(by_type(c, tilted(10 * kDegree)), 1 - std::tan(10 * kDegree) * std::tan(10 * kDegree), tolerance(1e-12));
  EXPECT_EQ(by_type(c, tilted(50 * kDegree)), 0);
}

/// One constraint of each pair that is recognized.
std::vector<Constraint> one_of_each() {
  const Entity sink = cone(0.05, 0.3, true);
  return {peg(),
          recognize(plane(kZ), plane(-kZ)),
          recognize(sink, cone(0.05, 0.3, false)),
          recognize(sink, circle(0.05, Role::pin)),
          recognize(sink, sphere(0.051, false)),
          recognize(sphere(0.03, true), sphere(0.029, false)),
          recognize(cylinder(0.03, true), sphere(0.029, false)),
          recognize(torus(0.1, 0.01, true), torus(0.1, 0.0095, false)),
          recognize(circle(0.075, Role::hole), cylinder(0.07, false)),
          recognize(circle(0.075, Role::hole), circle(0.07, Role::pin)),
          recognize(plane(kZ), sphere(0.02, false)),
          recognize(plane(kZ), cylinder(0.02, false)),
          recognize(plane(kZ), line(kX))};
}

TEST(Alignment, LiesBetweenZeroAndOneAndDoesNotDependOnTheOrder) {
  for (const std::uint64_t seed : test::seeds(300)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    const Pose X = in.pose(seed % 2 == 0 ? 0.2 : 0.005);
    for (const Constraint& c : one_of_each()) {
      ASSERT_NE(c.kind, ConstraintKind::none);
      for (const AlignmentMeasure measure : kAll) {
        const double a = alpha(measure, c, X);
        EXPECT_GE(a, 0);
        EXPECT_LE(a, 1);
        EXPECT_NEAR(alpha(measure, mirrored(c), X.inverse()), a, tolerance(1e-9));
      }
    }
  }
}

TEST(Alignment, IsZeroForAPoseThatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Constraint& c : one_of_each()) {
    for (const AlignmentMeasure measure : kAll) {
      EXPECT_EQ(alpha(measure, c, {{nan, 0, 0}, Quaterniond::Identity()}), 0);
      EXPECT_EQ(alpha(measure, c, {{nan, nan, nan}, Quaterniond(nan, nan, nan, nan)}), 0);
      EXPECT_EQ(alpha(measure, c, {{inf, inf, inf}, Quaterniond::Identity()}), 0);
    }
  }
}

}  // namespace
}  // namespace verisim::alignment_test

// ORACLES section 2: the two published measures of alignment, eq. 8.1 (Faas) and eq. 8.2 (Pavlik, c = 10 as in the
// published code), for the dissertation's pin: 70 mm and 400 mm long in a hole of 75 mm through 200 mm.
#include "engine/constraint/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/constraint/recognition.hpp"
#include "tests/constraint/shapes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::published_alignment_test {
namespace {

using test::cylinder;
using test::kX;
using test::tolerance;

constexpr double kDegree = pinned::kPi / 180;

double alpha(AlignmentMeasure measure, const Constraint& c, const Pose& X_AB) {
  return alignment(measure, c, misalignment(c, X_AB), {.voxel_size = 0.0045});
}
Constraint peg() {
  return recognize(cylinder(0.075, /*hole=*/true, 0.1), cylinder(0.070, /*hole=*/false, 0.2));
}
Pose tilted(double tilt, const Vector3d& p = Vector3d::Zero()) {
  return {p, rotation_from_vector(tilt * kX)};
}

// Eq. 8.2 with c = 10, dc = 5 mm: parallel axes 1 mm apart, theta = 0: 0.5 + 0.5 e^-2.
TEST(AlignmentPavlik, GivesTheWorkedNumberForParallelAxes) {
  const double expected = 0.5 + 0.5 * std::exp(-2.0);
  EXPECT_NEAR(alpha(AlignmentMeasure::pavlik, peg(), {{0.001, 0, 0.03}, Quaterniond::Identity()}), expected,
              tolerance(1e-12));
}

// One degree about the middle: d = 0, so 0.5 e^-0.0174533 + 0.5 = 0.991349: it hardly notices.
TEST(AlignmentPavlik, GivesTheWorkedNumberForATilt) {
  EXPECT_NEAR(alpha(AlignmentMeasure::pavlik, peg(), tilted(kDegree)), 0.5 * std::exp(-kDegree) + 0.5,
              tolerance(1e-12));
}

// Eq. 8.1: theta0 = voxel / engaged length = 4.5 / 200, d0 = 4.5 mm. 1 degree and 2 mm square to the tilt.
TEST(AlignmentFaas, GivesTheWorkedNumber) {
  const double expected = 0.5 * std::exp(-kDegree * 200 / 4.5) + 0.5 * std::exp(-2.0 / 4.5);
  EXPECT_NEAR(alpha(AlignmentMeasure::faas, peg(), tilted(kDegree, {0.002, 0, 0})), expected, tolerance(1e-12));
}

// Parallel axes are the common case, and their distance needs a formula of its own: 3 mm and 4 mm aside make 5 mm.
TEST(Misalignment, KnowsTheDistanceOfParallelAxes) {
  const Misalignment m = misalignment(peg(), {{0.003, 0.004, 0.1}, Quaterniond::Identity()});
  EXPECT_NEAR(m.distance, 0.005, tolerance(1e-17));
  EXPECT_EQ(m.sine, 0);
}

// Published: 1 degree of tilt with axes that meet 1 m away still gives 0.991: half of the measure is blind to where.
TEST(AlignmentPavlik, ForgivesAxesThatMeetFarAway) {
  EXPECT_NEAR(0.5 * std::exp(-kDegree) + 0.5, 0.991, tolerance(5e-4));
  EXPECT_NEAR(alpha(AlignmentMeasure::pavlik, peg(), tilted(kDegree)), 0.991, tolerance(5e-4));
}

}  // namespace
}  // namespace verisim::published_alignment_test

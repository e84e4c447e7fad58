// ORACLES section 2, two-point contact: a pin (r) tilted by theta in a through hole (R, l long) touches both rims when
// 2 R cos(theta) - l sin(theta) = 2 r.
#include <gtest/gtest.h>

#include "engine/constraint/alignment.hpp"
#include "engine/constraint/recognition.hpp"
#include "tests/constraint/shapes.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::two_point_contact_test {
namespace {

using test::tolerance;

constexpr double kDegree = 3.14159265358979323846 / 180;

struct Printed {
  double pin_radius;  ///< m
  double degrees;
  double half_digit;  ///< of the last digit printed
};

class TwoPointContact : public ::testing::TestWithParam<Printed> {};
INSTANTIATE_TEST_SUITE_P(Pins, TwoPointContact,
                         ::testing::Values(Printed{0.070, 2.81410, 5e-6}, Printed{0.0745, 0.285945, 5e-7},
                                           Printed{0.07495, 0.0286425, 5e-8}, Printed{0.07499, 0.00572936, 5e-9}));

// What the equation leaves at the printed angle is no more than its last digit explains: d/dtheta is about -l.
TEST_P(TwoPointContact, SolvesItsEquation) {
  const auto& [r, degrees, half_digit] = GetParam();
  const double theta = degrees * kDegree;
  const double left = 2 * 0.075 * std::cos(theta) - 0.2 * std::sin(theta) - 2 * r;
  EXPECT_LE(std::abs(left), tolerance(1.1 * 0.2 * half_digit * kDegree));
}

// The precise bodies: clear just before that tilt, overlapping just after, at a sample spacing of 4.5 mm.
TEST_P(TwoPointContact, IsWhereThePreciseSurfacesMeet) {
  const auto& [r, degrees, half_digit] = GetParam();
  exact::test::Pair pair(exact::test::block_solid(), exact::test::pin_solid(0.075 - r), 0.0045);
  const auto gap = [&pair, degrees = degrees](double share) {
    const Pose tilted = {Vector3d::Zero(), rotation_from_vector({0, share * degrees * kDegree, 0})};
    return pair.gap_at(tilted, /*margin=*/1e-3);
  };
  EXPECT_GT(gap(1 - 1e-4), 0);
  EXPECT_LT(gap(1 + 1e-4), 0);
}

// Alignment per type takes a pin as aligned while it is free; to first order tan(theta) = 2 (R - r) / l.
TEST_P(TwoPointContact, IsWhereAlignmentPerTypeBeginsToFall) {
  const auto& [r, degrees, half_digit] = GetParam();
  const Constraint c = recognize(test::cylinder(0.075, true, 0.1), test::cylinder(r, false, 0.2));
  const auto alpha = [&](double theta) {
    const Pose X_AB = {Vector3d::Zero(), rotation_from_vector({0, theta, 0})};
    return alignment(AlignmentMeasure::by_type, c, misalignment(c, X_AB), {.voxel_size = 0.0045});
  };
  EXPECT_EQ(alpha(degrees * kDegree), 1);
  EXPECT_LT(alpha(std::atan(2 * (0.075 - r) / 0.2) * (1 + 1e-4)), 1);
}

}  // namespace
}  // namespace verisim::two_point_contact_test

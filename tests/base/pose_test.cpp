#include "engine/base/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::pose_test {
namespace {

using pinned::kPi;
using test::Inputs;
using test::seeds;
using test::tolerance;

/// Distance of two rotations as quaternions, sign ignored.
double apart(const Quaterniond& a, const Quaterniond& b) {
  return std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
}

// A quarter turn about z and a shift, by hand: (1, 2, 3) turns to (-2, 1, 3), then moves by (10, 20, 30).
TEST(Pose, MovesAPointAsDrawnByHand) {
  const Pose X_WB{{10, 20, 30}, Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5))};
  EXPECT_LE((X_WB * Vector3d(1, 2, 3) - Vector3d(8, 21, 33)).norm(), tolerance(40 * 0x1p-52));
}

// Points are up to 10 from their origins: about twenty roundings of numbers below 64.
TEST(Pose, ComposesInOrderAndInverts) {
  for (const std::uint64_t seed : seeds(1000)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Pose X_AB = in.pose(10), X_BC = in.pose(10);
    const Vector3d p_C = in.vector(10);
    ASSERT_LE(((X_AB * X_BC) * p_C - X_AB * (X_BC * p_C)).norm(), tolerance(20 * 64 * 0x1p-53));
    ASSERT_LE((X_AB.inverse() * (X_AB * p_C) - p_C).norm(), tolerance(20 * 64 * 0x1p-53));
    const Pose identity = X_AB * X_AB.inverse();
    ASSERT_LE(identity.position.norm() + apart(identity.rotation, Quaterniond::Identity()),
              tolerance(20 * 64 * 0x1p-53));
  }
}

// Unit quaternions stay unit however often they are composed: half a unit in the last place per normalisation.
TEST(Pose, StaysUnitOverAMillionCompositions) {
  const Pose small{{0, 0, 0}, rotation_from_vector({1e-3, -2e-3, 3e-3})};
  Pose X;
  for (int i = 0; i < 1000000; ++i) X = small * X;
  EXPECT_LE(std::abs(X.rotation.norm() - 1), tolerance(4 * 0x1p-53));
}

TEST(RotationVector, OfZeroIsTheIdentityExactly) {
  EXPECT_EQ(rotation_from_vector(Vector3d::Zero()).coeffs(), Quaterniond::Identity().coeffs());
  EXPECT_EQ(vector_from_rotation(Quaterniond::Identity()), Vector3d::Zero());
}

TEST(RotationVector, TurnsByItsLengthAboutItself) {
  const Quaterniond q = rotation_from_vector({0, 0, kPi / 2});
  EXPECT_LE((q * Vector3d(1, 0, 0) - Vector3d(0, 1, 0)).norm(), tolerance(4 * 0x1p-52));
}

// Every length from the smallest to just below pi comes back to 8 ulp: relative error, so that a slip in the series
// below 1e-4 rad, or at its seam, is seen.
TEST(RotationVector, ComesBackFromARotationAtAnyLengthBelowPi) {
  for (const std::uint64_t seed : seeds(2000)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Vector3d axis = in.vector(1).normalized();
    for (const double angle : {1e-300, 1e-160, 1e-12, 0.99999e-4, 1.00001e-4, 1.99999e-4, 2.00001e-4, 0.1, 3.0, 3.14}) {
      const Vector3d w = angle * axis;
      ASSERT_LE((vector_from_rotation(rotation_from_vector(w)) - w).norm(), tolerance(8 * 0x1p-52 * angle)) << angle;
    }
  }
}

// At pi, axis and opposite axis are one rotation: either may come back. Near pi, cos is linear, so no precision is
// lost.
TEST(RotationVector, AtPiComesBackUpToItsSign) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    const Vector3d w = kPi * Inputs(seed).vector(1).normalized();
    const Vector3d back = vector_from_rotation(rotation_from_vector(w));
    ASSERT_LE(std::min((back - w).norm(), (back + w).norm()), tolerance(8 * 0x1p-51));
    ASSERT_LE(back.norm(), kPi * (1 + tolerance(4 * 0x1p-52)));
  }
}

TEST(RotationVector, IsTheShortestAndDoesNotSeeTheQuaternionsSign) {
  for (const std::uint64_t seed : seeds(1000)) {
    SCOPED_TRACE(seed);
    const Quaterniond q = Inputs(seed).rotation();
    const Vector3d w = vector_from_rotation(q);
    ASSERT_LE(w.norm(), kPi * (1 + tolerance(4 * 0x1p-52)));
    ASSERT_EQ(vector_from_rotation(Quaterniond(-q.coeffs())), w);
    ASSERT_LE(apart(rotation_from_vector(w), q), tolerance(16 * 0x1p-53));
  }
}

TEST(RotationVector, OfManyTurnsIsStillAUnitQuaternion) {
  // A body at 1e4 rad/s over a step of 1 s.
  EXPECT_LE(std::abs(rotation_from_vector({6e3, -8e3, 0}).norm() - 1), tolerance(2 * 0x1p-53));
}

TEST(TurnBetween, TakesOneDirectionToTheOtherByTheSmallestAngle) {
  for (const std::uint64_t seed : seeds(200)) {
    Inputs draw(seed);
    const Vector3d a = draw.vector(3), b = seed % 4 == 0 ? Vector3d(-2 * a) : draw.vector(3);
    const Quaterniond q = turn_between(a, b);
    EXPECT_NEAR(q.norm(), 1, 1e-14);
    EXPECT_LT((q * a.normalized() - b.normalized()).norm(), 1e-12);
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    EXPECT_NEAR(vector_from_rotation(q).norm(), angle, 1e-7);
  }
}

TEST(Slerp, EndsAtItsEndsAndHalvesTheAngle) {
  for (const std::uint64_t seed : seeds(1000)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Quaterniond a = in.rotation(), b = in.rotation();
    ASSERT_LE(apart(slerp(a, b, 0), a), tolerance(4 * 0x1p-53));
    ASSERT_LE(apart(slerp(a, b, 1), b), tolerance(32 * 0x1p-53));
    // Halfway between unit quaternions on the same side is their normalised sum.
    const double side = a.dot(b) < 0 ? -1 : 1;
    const Quaterniond middle(Eigen::Vector4d((a.coeffs() + side * b.coeffs()).normalized()));
    ASSERT_LE(apart(slerp(a, b, 0.5), middle), tolerance(32 * 0x1p-53));
  }
}

// 170 degrees one way, given as the quaternion of 190 the other way.
TEST(Slerp, GoesTheShortWayRound) {
  const Quaterniond a = Quaterniond::Identity();
  const Quaterniond b(-rotation_from_vector({0, 0, 17 * kPi / 18}).coeffs());
  const Vector3d w = vector_from_rotation(slerp(a, b, 0.1));
  EXPECT_LE((w - Vector3d(0, 0, 1.7 * kPi / 18)).norm(), tolerance(8 * 0x1p-53));
}

TEST(Skew, IsTheCrossProduct) {
  const Vector3d w(1, 2, 3), v(-4, 5, 6);
  EXPECT_EQ(Vector3d(skew(w) * v), w.cross(v));
  EXPECT_EQ(skew(w).transpose(), -skew(w));
}

TEST(Wrench, AddsAndTurnsRound) {
  Wrench w{{1, 2, 3}, {4, 5, 6}};
  w += Wrench{{10, 20, 30}, {40, 50, 60}};
  EXPECT_EQ(w.force, Vector3d(11, 22, 33));
  EXPECT_EQ((-w).torque, Vector3d(-44, -55, -66));
}

}  // namespace
}  // namespace verisim::pose_test

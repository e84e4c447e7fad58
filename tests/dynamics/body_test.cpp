#include "engine/dynamics/body.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "engine/base/error.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::body_test {
namespace {

using test::brick;
using test::Inputs;
using test::seeds;
using test::tolerance;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// m (b^2 + c^2)/12 for a box; a few products each.
TEST(MakeBody, GivesABoxItsMassAndInertia) {
  const RigidBody body = brick(12, {1, 2, 3});
  EXPECT_LE(std::abs(body.mass - 12), tolerance(4 * 12 * 0x1p-53));
  EXPECT_LE((body.inertia_B - Matrix3d(Vector3d(13, 10, 5).asDiagonal())).norm(), tolerance(16 * 13 * 0x1p-52));
  EXPECT_LE((body.inertia_B * body.inertia_inverse_B - Matrix3d::Identity()).norm(), tolerance(32 * 0x1p-52));
}

TEST(MakeBody, TakesMassesFromANanogramToAMillionTonnes) {
  for (const double mass : {1e-12, 1e-9, 1e-3, 1e9}) {
    for (const double size : {1e-5, 1e-2, 1e3}) {
      const RigidBody body = brick(mass, size * Vector3d(1, 2, 3));
      EXPECT_LE(std::abs(body.mass / mass - 1), tolerance(1e-15));
      EXPECT_TRUE(body.inertia_inverse_B.allFinite());
      EXPECT_LE((body.inertia_B * body.inertia_inverse_B - Matrix3d::Identity()).norm(), tolerance(32 * 0x1p-52));
    }
  }
}

// A wire 1 m long and a micrometre thick: exact inertias relate as 2e-12; the header promises 1e-6.
TEST(MakeBody, RaisesTheThinAxisOfANeedle) {
  const RigidBody needle = brick(1e-6, {1e-6, 1e-6, 1});
  const double largest = needle.inertia_B(0, 0);
  EXPECT_LE(std::abs(largest - 1e-6 / 12), tolerance(1e-12 * largest));
  EXPECT_LE(std::abs(needle.inertia_B(2, 2) / largest - 1e-6), tolerance(1e-15));
  EXPECT_LE(std::abs(smallest_eigenvalue(needle.inertia_B) / largest - 1e-6), tolerance(1e-15));
}

void expect_refused(double volume, const Vector3d& centroid, const Matrix3d& inertia, double density) {
  try {
    (void)make_body("pin", volume, centroid, inertia, density);
    ADD_FAILURE() << "taken: volume " << volume << ", density " << density << ", inertia\n" << inertia;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find("'pin'"), std::string::npos) << e.what();
  }
}

TEST(MakeBody, RefusesWhatIsNoBody) {
  const Vector3d c = Vector3d::Zero();
  const Matrix3d inertia = Matrix3d::Identity();
  for (const double density : {0.0, -1.0, kNaN, kInfinity, -kInfinity}) expect_refused(1, c, inertia, density);
  for (const double volume : {0.0, -1.0, kNaN, kInfinity}) expect_refused(volume, c, inertia, 1);
  expect_refused(1e300, c, inertia, 1e300);  // the mass overflows
  expect_refused(1, {kNaN, 0, 0}, inertia, 1);
  expect_refused(1, c, Matrix3d::Zero(), 1);
  expect_refused(1, c, -inertia, 1);                           // inside out
  expect_refused(1, c, Vector3d(1, 1, -0.5).asDiagonal(), 1);  // torn open: one axis negative
  expect_refused(1, c, Matrix3d::Constant(kNaN), 1);
  expect_refused(1, c, 1e-320 * inertia, 1);  // its inverse overflows
}

TEST(RigidBody, PoseAndCentreOfMassBelongTogether) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    RigidBody body = brick(2, {1, 2, 3});
    body.p_BC = in.vector(1);
    const Pose X_WB = in.pose(10);
    body.set_pose(X_WB);
    ASSERT_LE((body.p_WC - X_WB * body.p_BC).norm(), 0);
    ASSERT_LE((body.pose().position - X_WB.position).norm(), tolerance(10 * 16 * 0x1p-53));
  }
}

// Spinning about a principal axis: I omega^2/2, whatever the orientation.
TEST(RigidBody, KineticEnergyOfAPrincipalSpin) {
  RigidBody body = brick(12, {1, 2, 3});
  body.v_C = {3, 4, 0};
  body.R_WB = rotation_from_vector({0.3, -0.7, 1.1});
  body.omega = body.R_WB * Vector3d(0, 2, 0);
  EXPECT_LE(std::abs(body.kinetic_energy() - (0.5 * 12 * 25 + 0.5 * 10 * 4)), tolerance(32 * 170 * 0x1p-52));
}

TEST(RigidBody, InverseMassMatrixInvertsTheMassMatrix) {
  RigidBody body = brick(3, {1, 2, 3});
  body.R_WB = rotation_from_vector({0.3, -0.7, 1.1});
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>() = 3 * Matrix3d::Identity();
  M.bottomRightCorner<3, 3>() = body.inertia_W();
  EXPECT_LE((M * body.inverse_mass_matrix() - Matrix6d::Identity()).norm(), tolerance(64 * 0x1p-52));
}

TEST(RigidBody, SaysWhenItsStateIsNotFinite) {
  RigidBody body = brick(1, {1, 1, 1});
  EXPECT_TRUE(body.is_finite());
  for (Vector3d RigidBody::*part : {&RigidBody::p_WC, &RigidBody::v_C, &RigidBody::omega}) {
    RigidBody broken = body;
    (broken.*part).y() = kNaN;
    EXPECT_FALSE(broken.is_finite());
  }
  body.R_WB.w() = kInfinity;
  EXPECT_FALSE(body.is_finite());
}

TEST(SquareRoot, SquaredIsTheMatrix) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Matrix3d R = in.rotation().toRotationMatrix();
    const Vector3d values(in.between(0, 1), in.between(0, 1e-3), in.between(0, 1e-6));
    const Matrix3d m = R * values.asDiagonal() * R.transpose();
    const Matrix3d root = square_root(m);
    ASSERT_LE((root * root - m).norm(), tolerance(32 * 0x1p-52));
    ASSERT_LE((root - root.transpose()).norm(), tolerance(8 * 0x1p-52));
  }
}

}  // namespace
}  // namespace verisim::body_test

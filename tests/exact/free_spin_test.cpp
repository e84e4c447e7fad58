#include <gtest/gtest.h>

#include "engine/base/pinned_math.hpp"
#include "tests/exact/held_pin.hpp"

namespace verisim::exact::test::free_spin_test {
namespace {

/// Wrench on the pin, moved by hand into a pose and held there: 100 kg, so that nothing gives.
Wrench wrench_at(double clearance, const Pose& X_WB) {
  const auto block = body_of(block_solid(), 0.0045);
  const auto pin = body_of(pin_solid(clearance), 0.0045);
  ExactLink link(block, pin);
  link.find({}, {X_WB, X_WB.position, {}}, 0.001, 0.0004);
  EXPECT_GT(link.rows().rows().size(), 20U) << "nothing is near: this test would prove nothing";
  ConvexStep step(4096);
  const int body = step.add_body(X_WB.position, 100 * Matrix6d::Identity(), Vector6d::Zero(), Vector6d::Zero());
  step.add_rows(link.rows().rows(), kFixed, body);
  step.solve(0.001);
  return step.wrench(body);
}

// ORACLES section 2, "Free spin". A voxel method gives newtons here.
TEST(CoaxialPin, FeelsNothingInItsHole) {
  const Wrench w = wrench_at(1e-5, {{0, 0, 0.05}, rotation_from_vector({0, 0, 0.3})});
  EXPECT_EQ(w.force, Vector3d::Zero());
  EXPECT_EQ(w.torque, Vector3d::Zero());
}

// Even where it is 0.2 um deep in the wall (100 kg are thrown back with 100 kg x 0.2 um / dt^2 = 20 N) the force has no
// part along the axis and no torque about it: the wall's normals meet the axis. What is left is rounding of sums of 20
// N.
TEST(PinAgainstTheWall, TurnsAndSlidesFreely) {
  for (const double turn : {0.0, 0.01, 0.3, 1.0}) {
    SCOPED_TRACE(turn);
    const Wrench w = wrench_at(1e-5, {{1.02e-5, 0, 0.05}, rotation_from_vector({0, 0, turn})});
    EXPECT_GT(w.force.norm(), 15);
    EXPECT_LE(std::abs(w.force.z()), 1e-9);
    EXPECT_LE(std::abs(w.torque.z()), 1e-9);
  }
}

}  // namespace
}  // namespace verisim::exact::test::free_spin_test

#include <gtest/gtest.h>

#include "tests/exact/held_pin.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::tilt_test {
namespace {

using verisim::test::tolerance;

/// The tilt at which both rims of the hole stop the pin: 2 R cos(t) - l sin(t) = 2 r (ORACLES section 2).
double two_point_tilt(double R, double r, double l) {
  double low = 0;
  double high = 0.5;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.5 * (low + high);
    (2 * R * std::cos(t) - l * std::sin(t) < 2 * r ? high : low) = t;
  }
  return 0.5 * (low + high);
}

class TwoPointContact : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Clearances, TwoPointContact, ::testing::Values(5e-3, 5e-4, 5e-5, 1e-5));

// A hand turns the pin, held in the middle of the hole, three times as far as it can go; samples are 4.5 mm apart. The
// pin's tilt then is the formula's, but for what 20 N m/rad press it into the rims: 1e-5 of it (and the experiment's).
TEST_P(TwoPointContact, StopsThePinAtTheFormulasTilt) {
  const double clearance = GetParam();
  const double want = two_point_tilt(kHoleRadius, kHoleRadius - clearance, kBlockHeight);
  HeldPin pin(clearance, /*chamfer=*/0, /*spacing=*/0.0045);
  pin.stiffness = 3000;
  pin.damping = 2 * std::sqrt(3000.0);
  pin.angular_stiffness = 20;
  for (int i = 0; i < 1500; ++i) {
    const double angle = std::min(1.0, i / 800.0) * 3 * want;
    pin.step({Vector3d::Zero(), rotation_from_vector({0, angle, 0}), Vector3d::Zero()});
  }
  const Vector3d axis = pin.X_WB.rotation * Vector3d::UnitZ();
  const double tilt = std::atan2(axis.head<2>().norm(), axis.z());
  EXPECT_NEAR(tilt, want, tolerance(1e-4 * want));
  EXPECT_GT(pin.contact_force.norm() + pin.coupling.torque.norm(), 0);
}

}  // namespace
}  // namespace verisim::exact::test::tilt_test

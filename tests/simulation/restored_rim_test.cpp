// Restoration where a pin stands on the rim of its hole: the top's push stays, on the way in it gives way to the
// wall's.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::restored_rim_test {
namespace {

constexpr std::size_t kPin = 1;
constexpr double kTop = 0.05, kHalfLength = 0.1, kClearance = 0.005;  ///< of the scene's block and pin [m]

/// One frame's force on the pin, upright and at rest, its end `depth` below the block's top.
class PinAt {
 public:
  PinAt(Hybrid hybrid, double voxel) : simulation_(left_alone(hybrid, voxel), {}) {}
  Vector3d force(double offset, double depth) {
    simulation_.set_body_pose(kPin, {{offset, 0, kTop + kHalfLength - depth}, Quaterniond::Identity()});
    simulation_.step();
    return simulation_.body_force(kPin).force;
  }

 private:
  static Scene left_alone(Hybrid hybrid, double voxel) {
    Scene scene = scenes::brep_pin_in_hole(hybrid, voxel);
    scene.grasps.clear();
    scene.parameters.passive_contacts = false;               // it is put there, and did not come
    scene.devices = {scenes::hand_along({{1, 0, 1}}, 0.5)};  // out of reach: nobody holds the pin
    return scene;
  }
  Simulation simulation_;
};

// Parallel axes, standing beside the hole by a part of a voxel up to nearly the block's border. While the end is less
// deep in the top than the pin stands beside the hole, the wall has a share of depth / voxel x (1 - beside / voxel) in
// the rim's voxels, and of the push along the axis at most so much may be taken.
TEST(RestoredRim, HoldsAPinThatStandsBesideItsHole) {
  for (const double voxel : {0.0045, 0.002}) {
    PinAt off(hybrid::off, voxel);
    PinAt restored(hybrid::restore, voxel);
    for (const double beside : {0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0}) {
      for (const double depth : {0.0, 0.1, 0.25, 0.5}) {
        const double taken = depth * std::max(0.0, 1 - beside);
        const double whole = off.force(kClearance + beside * voxel, depth * voxel).z();
        const double left = restored.force(kClearance + beside * voxel, depth * voxel).z();
        EXPECT_TRUE(depth < 0.5 || whole > 1) << "the voxels do not hold it either";
        EXPECT_GE(left, (1 - taken) * whole - test::tolerance(1e-5)) << voxel << ' ' << beside << ' ' << depth;
      }
    }
  }
}

// A voxel deep and within its clearance nothing holds the pin up: its slide is free.
TEST(RestoredRim, LetsAPinGoInOnceItsEndIsInTheHole) {
  for (const double voxel : {0.0045, 0.002}) {
    PinAt restored(hybrid::restore, voxel);
    const Vector3d force = restored.force(kClearance - 0.1 * voxel, 2 * voxel);
    EXPECT_GT(force.head<2>().norm(), 0.1);
    EXPECT_LE(std::abs(force.z()), 1e-5 * force.norm());
  }
}

}  // namespace
}  // namespace verisim::restored_rim_test

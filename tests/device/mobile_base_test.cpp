// A device on a base that moves: what the hand in the room does comes back to the room, whatever the base does; what
// the hand feels, the base feels the other way round; and the error drives.
#include "engine/device/mobile_base.hpp"

#include <gtest/gtest.h>

#include "engine/device/tracked_transform.hpp"
#include "tests/device/chains.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::mobile_base_test {
namespace {

using test::frame_at;
using test::Inputs;
using test::random_motion;
using test::seeds;
using test::tolerance;

/// A base that the test moves, whose tracker tells the truth.
struct WrittenBase final : MovingBase {
  Pose X_WB;
  double x = 0, z = 0;
  Wrench loaded;
  [[nodiscard]] const Pose& pose() const override { return X_WB; }
  [[nodiscard]] const Pose& tracked_pose() const override { return X_WB; }
  Vector3d wall = Vector3d::Zero();
  void follow(double to_x, double to_z) override { x = to_x, z = to_z; }
  [[nodiscard]] const Vector3d& limit() const override { return wall; }
  void load(const Wrench& wrench) override { loaded += wrench; }
};

// X_WB X_WB^-1 X_WH: three products of poses within a few metres, a dozen roundings of 2^-52 times 10 m.
TEST(MobileBase, WithATrueTrackerIsNotThere) {
  for (const std::uint64_t seed : seeds(50)) {
    Inputs inputs(seed);
    const auto bare = random_motion(seed, 0.5), source = random_motion(seed, 0.5);
    const auto base = std::make_shared<WrittenBase>();
    const auto device = make_tracked_transform(make_mounted(source, base), make_base_tracker("tracker", base));
    for (std::uint64_t frame = 0; frame < 100; ++frame) {
      base->X_WB = {inputs.vector(5), inputs.rotation()};
      bare->sample(frame_at(frame));
      device->sample(frame_at(frame));
      const Pose &found = device->reading().handle, &wanted = bare->reading().handle;
      ASSERT_LE((found.position - wanted.position).norm(), tolerance(200 * 0x1p-52)) << seed;
      ASSERT_LE(vector_from_rotation(found.rotation * wanted.rotation.conjugate()).norm(), tolerance(1e-14)) << seed;
      const Wrench wrench{inputs.vector(10), inputs.vector(1)};
      device->render(wrench, frame_at(frame));
      ASSERT_LE((source->rendered().force - wrench.force).norm(), tolerance(1e-13));
      ASSERT_LE((source->rendered().torque - wrench.torque).norm(), tolerance(1e-13));
    }
  }
}

// Newton's third law about one point: the room's origin. Hand and base together are pushed by nothing.
TEST(MobileBase, IsPushedByWhatTheHandFeelsTheOtherWayRound) {
  for (const std::uint64_t seed : seeds(50)) {
    Inputs inputs(seed);
    const auto source = random_motion(seed, 0.5);
    const auto base = std::make_shared<WrittenBase>();
    const auto device = make_mounted(source, base);
    for (std::uint64_t frame = 0; frame < 50; ++frame) {
      base->X_WB = {inputs.vector(5), inputs.rotation()};
      base->loaded = {};
      device->sample(frame_at(frame));
      device->render({inputs.vector(30), inputs.vector(3)}, frame_at(frame));
      const Wrench& hand = source->rendered();
      const Vector3d p_WH = source->reading().handle.position, &p_WB = base->X_WB.position;
      const Vector3d on_base = base->X_WB.rotation * base->loaded.force;
      const Vector3d about_base = base->X_WB.rotation * base->loaded.torque;
      ASSERT_LE((hand.force + on_base).norm(), tolerance(1e-12)) << seed;
      ASSERT_LE((hand.torque + p_WH.cross(hand.force) + about_base + p_WB.cross(on_base)).norm(), tolerance(1e-11));
    }
  }
}

TEST(MobileBase, IsDrivenByTheHandlesWayFromTheNeutralPlaceTimesTheGain) {
  const auto base = std::make_shared<WrittenBase>();
  const auto gain = std::make_shared<double>(1);
  const auto hand = test::still_at({0.1, 0.7, 0.6});
  const auto device = make_remote_base(hand, base, {0.02, 0.55, gain, "Robot@localhost"});
  device->sample(frame_at(0));
  EXPECT_DOUBLE_EQ(base->x, 0.08);
  EXPECT_NEAR(base->z, 0.05, 1e-15);
  *gain = 3;
  device->sample(frame_at(1));
  EXPECT_DOUBLE_EQ(base->x, 3 * 0.08);
  EXPECT_EQ(device->reading().handle.position, Vector3d(0.1, 0.7, 0.6));
  base->wall = {0, 0, -4};
  device->render({{1, 2, 3}, {4, 5, 6}}, frame_at(1));
  EXPECT_EQ(hand->rendered().force, Vector3d(1, 2, -1));
  EXPECT_EQ(hand->rendered().torque, Vector3d(4, 5, 6));
  EXPECT_NE(device->described().find("driving Robot@localhost from (0.02, 0.55)"), std::string::npos);
}

}  // namespace
}  // namespace verisim::mobile_base_test

// A device on a base that a tracker follows: where the handle is, by the trace of the base; what stands still changes
// nothing; and power goes through.
#include "engine/device/tracked_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/device/hardware.hpp"
#include "tests/device/chains.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::tracked_transform_test {
namespace {

using test::frame_at;
using test::Inputs;
using test::kStep;
using test::random_motion;
using test::seeds;
using test::tolerance;

std::shared_ptr<Device> tracker(std::shared_ptr<Device> base, double rate, double delay) {
  HardwareDescription description = ideal_device("tracker");
  description.rate = rate;
  description.delay = delay;
  return make_hardware(std::move(description), std::move(base));
}

TEST(TrackedTransform, OfABaseThatStandsAtTheOriginIsAsIfItWereNotThere) {
  for (const std::uint64_t seed : seeds(50)) {
    const auto bare = random_motion(seed, 0.5), inner = random_motion(seed, 0.5);
    const auto device = make_tracked_transform(inner, tracker(nullptr, 60, 0.01));
    Inputs inputs(seed);
    for (std::uint64_t frame = 0; frame < 200; ++frame) {
      bare->sample(frame_at(frame));
      device->sample(frame_at(frame));
      const Wrench wrench{inputs.vector(10), inputs.vector(1)};
      device->render(wrench, frame_at(frame));
      ASSERT_EQ(device->reading().handle.position, bare->reading().handle.position);
      ASSERT_EQ(device->reading().velocity.linear, bare->reading().velocity.linear);
      ASSERT_EQ(device->reading().velocity.angular, bare->reading().velocity.angular);
      ASSERT_EQ(inner->rendered().force, wrench.force);
      ASSERT_EQ(inner->rendered().torque, wrench.torque);
    }
  }
}

// The base's own trace, asked for at the time of the last report that has arrived.
TEST(TrackedTransform, PutsTheHandleWhereTheTrackerSawTheBase) {
  constexpr double kRate = 50, kDelay = 0.012;
  for (const std::uint64_t seed : seeds(50)) {
    SCOPED_TRACE(seed);
    const auto inner = random_motion(seed, 0.3), truth = random_motion(seed + 1000, 3);
    const auto device = make_tracked_transform(inner, tracker(random_motion(seed + 1000, 3), kRate, kDelay));
    Pose before, reported = truth->reading().handle;
    std::uint64_t asked = 0;
    truth->sample(frame_at(0));
    for (std::uint64_t frame = 0; frame < 220; ++frame) {
      const std::uint64_t sent = frame < 12 ? 0 : (frame - 12) / 20 * 20;  // a report every 20 frames, 12 frames late
      if (sent > asked) truth->sample(frame_at(asked = sent));
      reported = truth->reading().handle;
      device->sample(frame_at(frame));
      const Pose &hand = inner->reading().handle, &handle = device->reading().handle;
      ASSERT_LE((handle.position - (reported.position + reported.rotation * hand.position)).norm(), tolerance(1e-12));
      ASSERT_LE(
          (handle.rotation.toRotationMatrix() - reported.rotation.toRotationMatrix() * hand.rotation.toRotationMatrix())
              .norm(),
          tolerance(1e-12));
      const Twist v = device->reading().velocity;
      if (frame > 0) {
        const Twist moved = velocity_between(before, handle, kStep);
        ASSERT_LE((v.linear - moved.linear).norm(), tolerance(1e-9 * (1 + moved.linear.norm())));
        ASSERT_LE((v.angular - moved.angular).norm(), tolerance(1e-9 * (1 + moved.angular.norm())));
      }
      before = handle;
    }
  }
}

TEST(TrackedTransform, OfABaseThatStandsAnywhereLetsThePowerThrough) {
  for (const std::uint64_t seed : seeds(100)) {
    Inputs inputs(seed);
    const auto inner = random_motion(seed, 0.3);
    const auto base = make_replay("base", {{0}, {{inputs.vector(5), inputs.rotation()}}, {}});
    const auto device = make_tracked_transform(inner, tracker(base, 60, 0));
    for (std::uint64_t frame = 0; frame < 50; ++frame) {
      device->sample(frame_at(frame));
      const Wrench w{inputs.vector(10), inputs.vector(1)};
      device->render(w, frame_at(frame));
      const Twist &outer = device->reading().velocity, &v = inner->reading().velocity;
      const double out = inner->rendered().force.dot(v.linear) + inner->rendered().torque.dot(v.angular);
      const double scale = w.force.norm() * v.linear.norm() + w.torque.norm() * v.angular.norm();
      ASSERT_NEAR(w.force.dot(outer.linear) + w.torque.dot(outer.angular), out, tolerance(1e-12 * scale));
    }
  }
}

TEST(TrackedTransform, SaysWhatNothingDrives) {
  const auto undriven = make_tracked_transform(make_hardware(ideal_device("arm"), nullptr), tracker(nullptr, 60, 0));
  EXPECT_EQ(undriven->idle(), (std::vector<std::string>{"arm", "tracker"}));
  EXPECT_TRUE(std::isfinite(undriven->travel()));
  const auto driven = make_tracked_transform(random_motion(1, 1), tracker(random_motion(2, 1), 60, 0));
  EXPECT_TRUE(driven->idle().empty());
  EXPECT_FALSE(std::isfinite(driven->travel()));
}

}  // namespace
}  // namespace verisim::tracked_transform_test

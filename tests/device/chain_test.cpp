// Laws of every chain of filters, on random chains: power, velocity, identity, scales that cancel.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/device/bubble.hpp"
#include "engine/device/bump.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/passivity_filter.hpp"
#include "tests/device/chains.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::chain_test {
namespace {

using test::frame_at;
using test::Inputs;
using test::kStep;
using test::random_motion;
using test::seeds;
using test::tolerance;
using DevicePointer = std::shared_ptr<Device>;

/// Five lossless filters in random order.
DevicePointer lossless(DevicePointer device, Inputs& inputs) {
  for (int i = 0; i < 5; ++i) {
    if (inputs.between(0, 1) < 0.5)
      device = make_translate(std::move(device), inputs.vector(2));
    else
      device = make_rotate(std::move(device), inputs.rotation());
  }
  return device;
}

double power(const Wrench& w, const Twist& v) {
  return w.force.dot(v.linear) + w.torque.dot(v.angular);
}

TEST(Chain, OfLosslessFiltersLetsOutThePowerThatGoesIn) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const DevicePointer source = random_motion(seed, 0.3);
    const DevicePointer device = lossless(source, inputs);
    for (std::uint64_t frame = 0; frame < 100; ++frame) {
      device->sample(frame_at(frame));
      const Wrench wrench{inputs.vector(10), inputs.vector(1)};
      device->render(wrench, frame_at(frame));
      const Twist& outer = device->reading().velocity;
      const double scale = wrench.force.norm() * outer.linear.norm() + wrench.torque.norm() * outer.angular.norm();
      ASSERT_NEAR(power(wrench, outer), power(source->rendered(), source->reading().velocity),
                  tolerance(1e-12 * scale));
    }
  }
}

// A scale makes motions larger and forces smaller: the hand has 1/s^2 of the power of linear motion.
TEST(Chain, WithAScaleDividesThePowerOfLinearMotionByItsSquare) {
  for (const std::uint64_t seed : seeds(100)) {
    Inputs inputs(seed);
    const double scale = inputs.between(0.1, 20);
    const DevicePointer source = random_motion(seed, 0.3);
    const DevicePointer device = lossless(make_scale(source, scale), inputs);
    device->sample(frame_at(0));
    device->sample(frame_at(1));
    const Wrench force{inputs.vector(10), Vector3d::Zero()};
    device->render(force, frame_at(1));
    const double inner = power(source->rendered(), source->reading().velocity);
    const Twist& v = device->reading().velocity;
    EXPECT_NEAR(power(force, v), scale * scale * inner, tolerance(1e-12 * force.force.norm() * v.linear.norm()));
  }
}

TEST(Chain, OfAScaleAndItsInverseIsAsIfItWereNotThere) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const double scale = std::pow(10, inputs.between(-2, 2));
    const DevicePointer source = random_motion(seed, 1);
    const DevicePointer device = make_scale(make_scale(source, scale), 1 / scale);
    for (std::uint64_t frame = 0; frame < 50; ++frame) {
      device->sample(frame_at(frame));
      const Wrench wrench{inputs.vector(10), inputs.vector(1)};
      device->render(wrench, frame_at(frame));
      const DeviceReading &a = device->reading(), &b = source->reading();
      ASSERT_LE((a.handle.position - b.handle.position).norm(), tolerance(1e-12));
      ASSERT_LE((a.velocity.linear - b.velocity.linear).norm(), tolerance(1e-12 * (1 + b.velocity.linear.norm())));
      ASSERT_LE((source->rendered().force - wrench.force).norm(), tolerance(1e-12 * 10));
    }
  }
}

DevicePointer idle_chain(DevicePointer device) {
  device = make_scale(make_translate(make_rotate(std::move(device), Quaterniond::Identity()), Vector3d::Zero()), 1);
  BubbleDescription never_left;
  never_left.radius = 100;
  device = make_bubble(std::move(device), never_left);
  device = make_carried(std::move(device), std::make_shared<Navigator>());
  return make_bump(make_passivity_filter(std::move(device), {.controls = false}), {});
}

TEST(Chain, WithoutActivePartsIsTheIdentityToTheBit) {
  for (const std::uint64_t seed : seeds(50)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const DevicePointer source = random_motion(seed, 1), device = idle_chain(source);
    for (std::uint64_t frame = 0; frame < 250; ++frame) {
      device->sample(frame_at(frame));
      const Wrench wrench{inputs.vector(10), inputs.vector(1)};
      device->render(wrench, frame_at(frame, 3, false));
      const DeviceReading &a = device->reading(), &b = source->reading();
      ASSERT_EQ(a.handle.position, b.handle.position);
      ASSERT_EQ(a.handle.rotation.coeffs(), b.handle.rotation.coeffs());
      ASSERT_EQ(a.velocity.linear, b.velocity.linear);
      ASSERT_EQ(a.velocity.angular, b.velocity.angular);
      ASSERT_EQ(source->rendered().force, wrench.force);
      ASSERT_EQ(source->rendered().torque, wrench.torque);
    }
  }
}

/// Any filters, with a bubble that moves.
DevicePointer any_chain(DevicePointer device, Inputs& inputs) {
  const auto bubble_at = static_cast<int>(inputs.between(0, 6));
  for (int i = 0; i < 6; ++i) {
    BubbleDescription bubble;
    bubble.radius = inputs.between(0.01, 0.2);
    const Workspace workspace = device->workspace();
    bubble.center = workspace.min.allFinite() ? Vector3d((workspace.min + workspace.max) / 2) : Vector3d::Zero();
    bubble.law.kind = static_cast<BubbleLawKind>(static_cast<int>(inputs.between(0, 5)));
    const double kind = inputs.between(0, 3);
    if (i == bubble_at)
      device = make_bubble(std::move(device), bubble);
    else if (kind < 1)
      device = make_scale(std::move(device), inputs.between(0.2, 5));
    else if (kind < 2)
      device = make_translate(std::move(device), inputs.vector(1));
    else
      device = make_rotate(std::move(device), inputs.rotation());
  }
  return device;
}

// The velocity that a chain says is the one with which its handle moved, the bubble's own motion included.
TEST(Chain, SaysTheVelocityWithWhichItsHandleMoved) {
  int moved_bubbles = 0;
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const DevicePointer device = any_chain(make_hardware(phantom_omni("omni"), random_motion(seed, 0.3)), inputs);
    Columns columns;
    device->declare(columns);
    Pose before;
    for (std::uint64_t frame = 0; frame < 200; ++frame) {
      device->sample(frame_at(frame));
      device->render({}, frame_at(frame));
      const Pose now = device->reading().handle;
      const Twist& v = device->reading().velocity;
      if (frame > 0) {
        const Vector3d linear = (now.position - before.position) / kStep;
        ASSERT_LE((v.linear - linear).norm(), tolerance(1e-9 * (1 + linear.norm())));
        const Vector3d angular = vector_from_rotation(now.rotation * before.rotation.conjugate()) / kStep;
        ASSERT_LE((v.angular - angular).norm(), tolerance(1e-9 * (1 + angular.norm())));
      }
      before = now;
    }
    DeviceNotes notes;
    device->report(notes);
    for (const auto& note : notes) moved_bubbles += std::string(note.kind) == "bubble" ? 1 : 0;
  }
  EXPECT_GT(moved_bubbles, 50) << "hardly a bubble moved: this would prove little";
}

TEST(Chain, DescribesItselfFromTheInsideOut) {
  const std::string text =
      idle_chain(make_hardware(phantom_omni("omni"), test::still_at(Vector3d::Zero())))->described();
  std::size_t at = 0;
  for (const char* part :
       {"trace (a recorded trace)", "omni (Phantom Omni", "rotated by", "translated by", "scaled by 1",
        "in a bubble of 100 m", "carried by a navigator", "with a passivity observer", "with a bump of 2 N"}) {
    const std::size_t found = text.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << " in " << text;
    at = found;
  }
}

// --- bump and passivity
// -----------------------------------------------------------------------------------------------

// A half wave against the motion: its impulse is 2 F d / pi.
TEST(Bump, PushesAgainstTheMotionWhenACollisionStarts) {
  HapticSamples way{{0, 1}, {{}, {{0, 0.2, 0}, Quaterniond::Identity()}}, {}};
  const auto source = make_replay("trace", way);
  const DevicePointer device = make_bump(source, {.force = 3, .duration = 0.05});
  Vector3d impulse = Vector3d::Zero();
  for (std::uint64_t frame = 0; frame < 300; ++frame) {
    device->sample(frame_at(frame));
    device->render({}, frame_at(frame, 4, frame == 100));
    const Vector3d& force = source->rendered().force;
    if (frame <= 100 || frame >= 151) {
      EXPECT_LE(force.norm(), 1e-12) << frame;
    }
    impulse += kStep * force;
  }
  EXPECT_LE((impulse - Vector3d(0, -2 * 3 * 0.05 / 3.14159265358979, 0)).norm(), 1e-3 * impulse.norm());
}

// A spring whose rendered force is a frame late gives energy: the observer counts it as the ledger of the hand does,
// and with the controller the hand is given none but what one step can bring.
TEST(Passivity, IsObservedAndKept) {
  for (const bool controls : {false, true}) {
    HandDescription hand;
    hand.path = {HandWaypoint()};
    hand.stiffness = 1;
    hand.damping = 0.01;
    hand.error = {0.01, 0, 0};
    const auto source = make_hand(hand);
    const DevicePointer device = make_passivity_filter(source, {.controls = controls, .damping_max = 100});
    double given = 0, most = 0;  // J, to the hand
    Wrench late;
    for (std::uint64_t frame = 0; frame < 3000; ++frame) {
      device->sample(frame_at(frame));
      device->render(late, frame_at(frame));
      given += kStep * power(source->rendered(), device->reading().velocity);
      most = std::max(most, given);
      late = {-2000 * device->reading().handle.position, Vector3d::Zero()};
    }
    if (controls)
      EXPECT_LE(most, 0.5 * 2000 * 0.01 * 0.01 * 1.05) << "what was in the spring at first, and little more";
    else
      EXPECT_GT(most, 1) << "nothing was unstable: this would prove nothing";
  }
}

}  // namespace
}  // namespace verisim::chain_test

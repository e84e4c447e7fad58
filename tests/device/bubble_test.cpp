// The bubble: its laws against ORACLES section 2, and what it does to a handle against what is known of a handle that
// stands still outside of it.
#include "engine/device/bubble.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/device/hardware.hpp"
#include "tests/device/chains.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::bubble_test {
namespace {

using test::expect_refused;
using test::frame_at;
using test::kStep;
using test::seeds;
using test::still_at;
using test::tolerance;

constexpr double kRadius = 0.45;  // m
constexpr BubbleLawKind kAll[] = {BubbleLawKind::linear, BubbleLawKind::quadratic, BubbleLawKind::cubic,
                                  BubbleLawKind::peak_ring, BubbleLawKind::peak_ring_as_printed};

BubbleLaw peak_ring() {
  return {.kind = BubbleLawKind::peak_ring, .scale = 1.5, .peak = 0.15, .taper = 0.3};
}

// ORACLES section 2: R 0.45 m, x* 0.15, beta 0.3, v* 1.5 m/s.
TEST(BubbleLaw, PeakRingHasItsWorkedNumbers) {
  const BubbleLaw law = peak_ring();
  const double p = 0.0675;
  EXPECT_NEAR(law.rate(p, kRadius), 1.5, 1e-12);
  EXPECT_NEAR(law.rate(0.03375, kRadius), 1.125, 1e-12);
  const double tapered = p * (1 + std::sqrt(1 - 0.3));
  EXPECT_NEAR(tapered, 0.12397, 5e-6);
  EXPECT_NEAR(law.rate(tapered, kRadius), 0.45, 1e-12);
  for (const double x : {0.13, 0.2, 1.0, 1e6}) EXPECT_NEAR(law.rate(x, kRadius), 0.45, 1e-12);
}

// ORACLES section 3, slip 1: as printed its peak is v* R^2.
TEST(BubbleLaw, AsPrintedPeaksElsewhere) {
  BubbleLaw law = peak_ring();
  law.kind = BubbleLawKind::peak_ring_as_printed;
  EXPECT_NEAR(law.rate(std::nextafter(0.0675, 0), kRadius), 1.5 * 0.45 * 0.45, 1e-12);
  EXPECT_NEAR(law.rate(0.0676, kRadius), 0.45, 1e-12) << "and there it jumps";
}

TEST(BubbleLaw, OfAPowerIsThatPower) {
  for (const std::uint64_t seed : seeds(200)) {
    test::Inputs inputs(seed);
    const double scale = inputs.between(0.1, 20), x = inputs.between(0, 0.5), R = inputs.between(0.05, 2);
    EXPECT_NEAR((BubbleLaw{BubbleLawKind::linear, scale}.rate(x, R)), scale * x, 1e-12);
    EXPECT_NEAR((BubbleLaw{BubbleLawKind::quadratic, scale}.rate(x, R)), scale * std::pow(x, 2), 1e-12);
    EXPECT_NEAR((BubbleLaw{BubbleLawKind::cubic, scale}.rate(x, R)), scale * std::pow(x, 3), 1e-12);
  }
}

// Slopes are at most 2 v*/p for the ring, scale and its like for powers below 1 m.
TEST(BubbleLaw, IsContinuousButForThePrintedOne) {
  for (const BubbleLawKind kind : kAll) {
    BubbleLaw law = peak_ring();
    law.kind = kind;
    double jump = 0;
    constexpr double kApart = 1e-6;
    for (double x = -0.01; x < 0.5; x += kApart)
      jump = std::max(jump, std::abs(law.rate(x + kApart, kRadius) - law.rate(x, kRadius)));
    if (kind == BubbleLawKind::peak_ring_as_printed)
      EXPECT_NEAR(jump, 0.45 - 1.5 * 0.45 * 0.45, 1e-4);
    else
      EXPECT_LE(jump, 2 * 1.5 / 0.0675 * kApart);
    EXPECT_EQ(law.rate(0, kRadius), 0);
    EXPECT_EQ(law.rate(-0.1, kRadius), 0);
  }
}

BubbleDescription description(BubbleLawKind kind = BubbleLawKind::peak_ring) {
  BubbleDescription bubble;
  bubble.radius = kRadius;
  bubble.stiffness = 50;
  bubble.law = peak_ring();
  bubble.law.kind = kind;
  return bubble;
}

// The spring pulls with k x towards the centre; the bubble moves with V from the second frame on.
TEST(Bubble, MovesWithItsLawAndPullsWithItsSpring) {
  for (const BubbleLawKind kind : kAll)
    for (const std::uint64_t seed : seeds(40)) {
      SCOPED_TRACE(seed);
      test::Inputs inputs(seed);
      BubbleDescription bubble = description(kind);
      bubble.center = inputs.vector(0.3);
      const Vector3d way = inputs.rotation() * Vector3d::UnitX();
      const double x = inputs.between(0.001, 0.3);
      const Vector3d at = bubble.center + (kRadius + x) * way;
      const auto source = still_at(at);
      const auto device = make_bubble(source, bubble);
      const Wrench scene{inputs.vector(3), inputs.vector(1)};
      const double V = bubble.law.rate(x, kRadius);
      for (std::uint64_t frame = 0; frame < 50; ++frame) {
        device->sample(frame_at(frame));
        device->render(scene, frame_at(frame));
        const Vector3d moved = static_cast<double>(frame) * kStep * V * way;
        ASSERT_LE((device->reading().handle.position - at - moved).norm(), tolerance(1e-12));
        ASSERT_LE((device->reading().velocity.linear - (frame > 0 ? V : 0) * way).norm(), tolerance(1e-11));
        ASSERT_LE((source->rendered().force - scene.force + 50 * x * way).norm(), tolerance(1e-12));
        ASSERT_EQ(source->rendered().torque, scene.torque);
      }
    }
}

TEST(Bubble, DoesNothingInside) {
  const auto source = still_at({0.1, 0.2, 0.3});
  const auto device = make_bubble(source, description());
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    device->sample(frame_at(frame));
    device->render({{1, 2, 3}, {4, 5, 6}}, frame_at(frame));
    EXPECT_EQ(device->reading().handle.position, Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(source->rendered().force, Vector3d(1, 2, 3));
  }
}

// What a handle feels and does just outside is near what it does just inside.
TEST(Bubble, HasNoJumpAtItsSurface) {
  for (const BubbleLawKind kind : kAll)
    for (const double beyond : {-1e-9, 0.0, 1e-9, 1e-8}) {
      const auto source = still_at({kRadius + beyond, 0, 0});
      const auto device = make_bubble(source, description(kind));
      for (std::uint64_t frame = 0; frame < 3; ++frame) {
        device->sample(frame_at(frame));
        device->render({}, frame_at(frame));
      }
      EXPECT_LE(source->rendered().force.norm(), 50 * 1.01e-8);
      EXPECT_LE(device->reading().velocity.linear.norm(), 2 * 1.5 / 0.0675 * 1.01e-8);
      EXPECT_LE((device->reading().handle.position - Vector3d(kRadius, 0, 0)).norm(), 2e-8);
    }
}

TEST(Bubble, MovesAlongTheAxesThatItMay) {
  BubbleDescription bubble = description();
  bubble.moves = {1, 0, 1};
  const auto device = make_bubble(still_at({0.4, 0.4, 0.4}), bubble);
  for (std::uint64_t frame = 0; frame < 100; ++frame) device->sample(frame_at(frame));
  const Vector3d moved = device->reading().handle.position - Vector3d(0.4, 0.4, 0.4);
  EXPECT_EQ(moved.y(), 0);
  EXPECT_GT(moved.x(), 0.01);
  EXPECT_EQ(moved.x(), moved.z());
}

TEST(Bubble, WithoutASpringDoesNotPull) {
  BubbleDescription bubble = description();
  bubble.elastic = false;
  const auto source = still_at({1, 0, 0});
  const auto device = make_bubble(source, bubble);
  device->sample(frame_at(0));
  device->render({{1, 2, 3}, {}}, frame_at(0));
  EXPECT_EQ(source->rendered().force, Vector3d(1, 2, 3));
}

// A contact that goes in and out of collision stops it as one that stays; it moves again 0.1 s after the last one.
TEST(Bubble, StopsInCollisionAndGoesOnAfterwards) {
  BubbleDescription bubble = description();
  bubble.stops_in_collision = true;
  const auto device = make_bubble(still_at({0.6, 0, 0}), bubble);
  Vector3d before = Vector3d::Zero();
  for (std::uint64_t frame = 0; frame < 600; ++frame) {
    const bool touches = frame >= 100 && frame < 300 && frame % 7 == 0;
    device->sample(frame_at(frame));
    device->render({}, frame_at(frame, touches ? 5 : 0));
    const Vector3d now = device->reading().handle.position;
    const bool moved = frame > 0 && now.x() > before.x();
    const std::uint64_t last_touch = 294;  // 42 times 7
    if (frame >= 1 && frame <= 105) {
      EXPECT_TRUE(moved) << frame;
    }
    if (frame > 107 && frame <= last_touch + 100) {
      EXPECT_FALSE(moved) << frame;
    }
    if (frame > last_touch + 106) {
      EXPECT_TRUE(moved) << frame;
    }
    before = now;
  }
}

TEST(Bubble, SaysWhenTheHandleLeavesAndComesBack) {
  HapticSamples way{{0, 0.1, 0.2}, {{}, {{0.6, 0, 0}, Quaterniond::Identity()}, {}}, {}};
  const auto device = make_bubble(make_replay("trace", way), description());
  std::vector<std::string> said;
  for (std::uint64_t frame = 0; frame <= 200; ++frame) {
    device->sample(frame_at(frame));
    device->render({}, frame_at(frame));
    DeviceNotes notes;
    device->report(notes);
    for (const auto& note : notes) said.push_back(note.text);
  }
  EXPECT_EQ(said, (std::vector<std::string>{"leaves its bubble, which moves", "is back in its bubble"}));
}

// Two devices that one navigator carries: the bubble around the one moves the other as far.
TEST(Navigator, CarriesAllItsDevices) {
  const auto navigator = std::make_shared<Navigator>();
  const auto bubble = make_bubble(still_at({0.6, 0, 0}), description(), navigator);
  const auto other = make_carried(still_at({0, 0, 1}), navigator);
  for (std::uint64_t frame = 0; frame < 100; ++frame) {
    bubble->sample(frame_at(frame));
    other->sample(frame_at(frame));
  }
  const double moved = bubble->reading().handle.position.x() - 0.6;
  EXPECT_NEAR(moved, 0.099 * 0.45, 1e-12);
  EXPECT_LE((other->reading().handle.position - Vector3d(moved, 0, 1)).norm(), tolerance(1e-15));
  EXPECT_NEAR(other->reading().velocity.linear.x(), 0.45, 1e-11);
  navigator->paused = true;
  bubble->sample(frame_at(100));
  EXPECT_EQ(bubble->reading().handle.position.x() - 0.6, moved);
}

TEST(Bubble, RefusesWhatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto with = [](auto change) {
    return [change] {
      BubbleDescription bubble = description();
      change(bubble);
      return make_bubble(make_hardware(phantom_omni("omni"), nullptr), bubble);
    };
  };
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    expect_refused(with([=](auto& b) { b.radius = bad; }), "'omni': the bubble's radius");
    expect_refused(with([=](auto& b) { b.stiffness = bad; }), "'omni': the bubble's stiffness");
    expect_refused(with([=](auto& b) { b.law.scale = bad; }), "'omni': the bubble's velocity scale");
    expect_refused(with([=](auto& b) { b.law.peak = bad; }), "'omni': the bubble's peak");
    expect_refused(with([=](auto& b) { b.law.taper = bad; }), "'omni': the bubble's taper");
    expect_refused(with([=](auto& b) { b.clear = bad; }), "'omni': the bubble's clear");
  }
  expect_refused(with([](auto& b) { b.law.taper = 1; }), "taper is 1 but must be below 1");
  expect_refused(with([=](auto& b) { b.center.y() = nan; }), "'omni': the bubble's centre");
  expect_refused(with([](auto& b) { b.center = {0, 0.1, 0}; }), "outside of the device's workspace");
  expect_refused(with([](auto& b) { b.moves = {1, 0.5, 1}; }), "moves along an axis (1) or not (0), not 0.5");
}

}  // namespace
}  // namespace verisim::bubble_test

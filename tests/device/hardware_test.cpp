#include "engine/device/hardware.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "engine/device/sources.hpp"
#include "tests/device/chains.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::hardware_test {
namespace {

using test::expect_refused;
using test::frame_at;
using test::Inputs;
using test::seeds;
using test::tolerance;

/// A source that stands still.
std::shared_ptr<Device> still_at(const Pose& pose) {
  return make_replay("trace", {{0}, {pose}, {}});
}

Wrench rendered_by(Device& device, const Wrench& wrench) {
  device.render(wrench, {0, 0, 1e-3});
  return device.rendered();
}

// ORACLES section 4: 3.3 N peak, no torque. Shortened, not clipped per axis: the direction stays.
TEST(PhantomOmni, RendersAtMost3point3NewtonAndNoTorque) {
  const auto source = still_at({});
  const auto omni = make_hardware(phantom_omni("omni"), source);
  const Wrench strong = rendered_by(*omni, {{30, -40, 0}, {1, 2, 3}});
  EXPECT_LE((strong.force - Vector3d(1.98, -2.64, 0)).norm(), tolerance(8 * 0x1p-52));
  EXPECT_EQ(strong.torque.norm(), 0);
  EXPECT_EQ(source->rendered().force, strong.force) << "the source feels what the hardware renders";
  EXPECT_EQ(rendered_by(*omni, {{1, 2, 2}, {0, 0, 0}}).force, Vector3d(1, 2, 2)) << "3 N pass as they are";
}

TEST(Virtuose, Renders35NewtonAnd3point1NewtonMetre) {
  const auto virtuose = make_hardware(virtuose_6d("virtuose"), still_at({}));
  const Wrench strong = rendered_by(*virtuose, {{0, 0, 1e6}, {-1e6, 0, 0}});
  EXPECT_LE((strong.force - Vector3d(0, 0, 35)).norm(), tolerance(2 * 35 * 0x1p-52));
  EXPECT_LE((strong.torque - Vector3d(-3.1, 0, 0)).norm(), tolerance(2 * 3.1 * 0x1p-52));
}

TEST(Hardware, WithForcesOffRendersNothing) {
  HardwareDescription description = virtuose_6d("virtuose");
  description.forces = false;
  const auto source = still_at({});
  const auto device = make_hardware(description, source);
  EXPECT_EQ(rendered_by(*device, {{1, 2, 3}, {4, 5, 6}}).force, Vector3d::Zero());
  EXPECT_EQ(source->rendered().torque, Vector3d::Zero());
}

// Readings are whole multiples of 0.055 mm and at most half a step per axis from the truth; rotations are not touched.
TEST(PhantomOmni, ReportsPositionsInStepsOf55Micrometres) {
  const double step = 0.000055;
  for (const std::uint64_t seed : seeds(500)) {
    SCOPED_TRACE(seed);
    const Pose truth = Inputs(seed).pose(0.2);
    const auto omni = make_hardware(phantom_omni("omni"), still_at(truth));
    omni->sample({0, 0, 1e-3});
    const DeviceReading& r = omni->reading();
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = r.raw.position[axis] / step;
      ASSERT_LE(std::abs(steps - std::round(steps)), tolerance(1e-11));  // 4000 steps, a few roundings
      ASSERT_LE(std::abs(r.raw.position[axis] - truth.position[axis]), 0.5 * step + tolerance(1e-16));
    }
    ASSERT_EQ(r.handle.position, r.raw.position);
    ASSERT_EQ(r.handle.rotation.coeffs(), truth.rotation.coeffs());
  }
}

TEST(Hardware, TravelCoversTheRoundingToo) {
  HapticSamples s{
      {0, 1}, {{{0.000027, 0, 0}, Quaterniond::Identity()}, {{0.000028, 0, 0}, Quaterniond::Identity()}}, {}};
  const auto omni = make_hardware(phantom_omni("omni"), make_replay("trace", s));
  omni->sample({0, 0, 1});
  const Vector3d start = omni->reading().handle.position;
  omni->sample({1, 1, 1});
  const double moved = (omni->reading().handle.position - start).norm();
  EXPECT_GT(moved, 0.00005) << "no step was crossed: this test would prove nothing";
  EXPECT_LE(moved, omni->travel());
}

TEST(Hardware, ThatNothingDrivesStaysAtHomeAndHoldsNothing) {
  HardwareDescription description = phantom_omni("omni");
  description.home = {{0.1, 0.2, 0.3}, rotation_from_vector({0, 0, 1})};
  const auto omni = make_hardware(description, nullptr);
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    omni->sample({frame, static_cast<double>(frame), 1});
    omni->render({{1, 0, 0}, {0, 0, 0}}, {frame, static_cast<double>(frame), 1});
  }
  EXPECT_FALSE(omni->driven());
  EXPECT_FALSE(omni->reading().button);
  EXPECT_EQ(omni->reading().handle.position, description.home.position);
  EXPECT_EQ(omni->travel(), 0);
  EXPECT_EQ(omni->duration(), 0);
}

TEST(Hardware, IsDrivenThroughItsFilters) {
  const auto hardware = make_hardware(phantom_omni("omni"), still_at({{0.0055, 0, 0}, Quaterniond::Identity()}));
  const auto device = make_translate(make_scale(hardware, 4), {0, 0, 1});
  EXPECT_TRUE(device->driven());
  device->sample({0, 0, 1e-3});
  EXPECT_TRUE(device->reading().button);
  EXPECT_LE((device->reading().handle.position - Vector3d(0.022, 0, 1)).norm(), tolerance(1e-15));
}

// --- what can be switched on
// ------------------------------------------------------------------------------------------

/// Along x from 0 with 0.1 m/s.
std::shared_ptr<Device> steady() {
  return make_replay("trace", {{0, 10}, {{}, {{1, 0, 0}, Quaterniond::Identity()}}, {}});
}
std::shared_ptr<Device> ideal_with(std::shared_ptr<Device> source,
                                   const std::function<void(HardwareDescription&)>& change) {
  HardwareDescription description = ideal_device("ideal");
  change(description);
  return make_hardware(description, std::move(source));
}

TEST(IdealDevice, AddsAndTakesNothing) {
  for (const std::uint64_t seed : seeds(50)) {
    const auto source = test::random_motion(seed, 0.5);
    const auto device = make_hardware(ideal_device("ideal"), source);
    Inputs inputs(seed);
    for (std::uint64_t frame = 0; frame < 50; ++frame) {
      device->sample(frame_at(frame));
      const Wrench wrench{inputs.vector(1e6), inputs.vector(1e6)};
      device->render(wrench, frame_at(frame));
      ASSERT_EQ(device->reading().handle.position, source->reading().handle.position);
      ASSERT_EQ(source->rendered().force, wrench.force);
      ASSERT_EQ(source->rendered().torque, wrench.torque);
    }
  }
}

// A servo of 100 Hz under frames of 1 ms: a new value in every tenth frame, both ways.
TEST(Hardware, HoldsWhatItSampled) {
  const auto source = steady();
  const auto device = ideal_with(source, [](auto& d) { d.rate = 100; });
  for (std::uint64_t frame = 0; frame < 100; ++frame) {
    device->sample(frame_at(frame));
    device->render({{static_cast<double>(frame), 0, 0}, Vector3d::Zero()}, frame_at(frame));
    const double sampled = static_cast<double>(frame / 10 * 10);
    ASSERT_NEAR(device->reading().handle.position.x(), 1e-4 * sampled, 1e-15) << frame;
    ASSERT_EQ(device->rendered().force.x(), sampled);
  }
}

TEST(Hardware, IsLateByItsDelayBothWays) {
  const auto source = steady();
  const auto device = ideal_with(source, [](auto& d) { d.delay = 0.007; });
  for (std::uint64_t frame = 0; frame < 100; ++frame) {
    device->sample(frame_at(frame));
    device->render({{static_cast<double>(frame), 0, 0}, Vector3d::Zero()}, frame_at(frame));
    const double then = frame < 7 ? 0 : static_cast<double>(frame - 7);
    ASSERT_NEAR(device->reading().handle.position.x(), 1e-4 * then, 1e-15);
    ASSERT_EQ(device->rendered().force.x(), then);
  }
  EXPECT_NEAR(device->duration(), 10.007, 1e-12);
  const auto too_late = ideal_with(source, [](auto& d) { d.delay = 9; });
  expect_refused([&] { return too_late->sample(frame_at(200)), too_late; }, "'ideal': a delay of 9 s is 9000 frames");
}

TEST(Hardware, StopsAtItsWorkspaceAndSaysSo) {
  HardwareDescription description = phantom_omni("omni");
  description.stops = true;
  description.resolution = 0;
  const auto source = steady();
  const auto omni = make_hardware(description, source);
  std::vector<std::string> said;
  for (std::uint64_t frame = 0; frame < 1000; ++frame) {
    omni->sample(frame_at(frame));
    omni->render({}, frame_at(frame));
    const double hand = source->reading().handle.position.x();
    ASSERT_NEAR(omni->reading().handle.position.x(), std::min(hand, 0.08), 1e-15);
    ASSERT_NEAR(source->rendered().force.x(), -3000 * std::max(0.0, hand - 0.08), 1e-9) << "the stop pushes the hand";
    ASSERT_EQ(omni->rendered().force.norm(), 0) << "and is no motor";
    DeviceNotes notes;
    omni->report(notes);
    for (const auto& note : notes) said.push_back(note.text);
  }
  EXPECT_EQ(said, std::vector<std::string>{"is stopped at its workspace's limit"});
}

TEST(Hardware, SaysWhenSaturationBeginsAndEnds) {
  const auto omni = make_hardware(phantom_omni("omni"), steady());
  std::vector<std::string> said;
  for (std::uint64_t frame = 0; frame < 30; ++frame) {
    omni->sample(frame_at(frame));
    omni->render({{0, frame >= 10 && frame < 20 ? 3.4 : 3.2, 0}, {0, 0, 5}}, frame_at(frame));
    DeviceNotes notes;
    omni->report(notes);
    for (const auto& note : notes) said.push_back(fmt::format("{} {}", frame, note.text));
  }
  EXPECT_EQ(said, (std::vector<std::string>{"10 is asked for more than its peak",
                                            "20 renders all that it is asked for again"}));
}

// A handle of 0.3 kg on a hand of 0.15 kg without a spring: it gains F t / (m + M); with friction (F - f) t / (m + M).
TEST(Hardware, LoadsTheHandWithMassAndFriction) {
  for (const double friction : {0.0, 0.4, 2.0}) {
    HandDescription hand;
    hand.path = {HandWaypoint()};
    hand.stiffness = 0;
    hand.damping = 0;
    const auto device = ideal_with(make_hand(hand), [=](auto& d) { d.load = {0.3, friction}; });
    device->sample(frame_at(0));
    for (std::uint64_t frame = 1; frame <= 100; ++frame) {
      device->render({{1, 0, 0}, Vector3d::Zero()}, frame_at(frame - 1));
      device->sample(frame_at(frame));
    }
    EXPECT_NEAR(device->reading().velocity.linear.x(), std::max(0.0, 1 - friction) * 0.1 / 0.45, 1e-9) << friction;
  }
}

TEST(Hardware, RefusesADescriptionThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto change) {
    return [change] {
      HardwareDescription d = phantom_omni("omni");
      change(d);
      return make_hardware(d, nullptr);
    };
  };
  expect_refused(with([](auto& d) { d.resolution = -1e-6; }), "'omni': resolution");
  expect_refused(with([=](auto& d) { d.resolution = nan; }), "'omni': resolution");
  expect_refused(with([](auto& d) { d.force_max = -1; }), "'omni': its limits");
  expect_refused(with([=](auto& d) { d.torque_max = nan; }), "'omni': its limits");
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    expect_refused(with([=](auto& d) { d.rate = bad; }), "'omni': rate");
    expect_refused(with([=](auto& d) { d.delay = bad; }), "'omni': delay");
    expect_refused(with([=](auto& d) { d.load.mass = bad; }), "'omni': mass");
    expect_refused(with([=](auto& d) { d.load.friction = bad; }), "'omni': friction");
  }
  expect_refused(with([](auto& d) { d.workspace.max = d.workspace.min; }), "'omni': its workspace");
  expect_refused(with([=](auto& d) { d.home.position.x() = nan; }), "'omni': its home");
}

}  // namespace
}  // namespace verisim::hardware_test

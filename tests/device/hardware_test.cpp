#include "engine/device/hardware.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/device/sources.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::hardware_test {
namespace {

using test::expect_refused;
using test::Inputs;
using test::seeds;
using test::tolerance;

/// A source that stands still.
std::shared_ptr<Device> still_at(const Pose& pose) {
  return make_replay("trace", {{0}, {pose}, {}});
}

Wrench rendered_by(Device& device, const Wrench& wrench) {
  device.render(wrench, 1e-3);
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
    omni->sample(0, 0, 1e-3);
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
  omni->sample(0, 0, 1);
  const Vector3d start = omni->reading().handle.position;
  omni->sample(1, 1, 1);
  const double moved = (omni->reading().handle.position - start).norm();
  EXPECT_GT(moved, 0.00005) << "no step was crossed: this test would prove nothing";
  EXPECT_LE(moved, omni->travel());
}

TEST(Hardware, ThatNothingDrivesStaysAtHomeAndHoldsNothing) {
  HardwareDescription description = phantom_omni("omni");
  description.home = {{0.1, 0.2, 0.3}, rotation_from_vector({0, 0, 1})};
  const auto omni = make_hardware(description, nullptr);
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    omni->sample(frame, static_cast<double>(frame), 1);
    omni->render({{1, 0, 0}, {0, 0, 0}}, 1);
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
  device->sample(0, 0, 1e-3);
  EXPECT_TRUE(device->reading().button);
  EXPECT_LE((device->reading().handle.position - Vector3d(0.022, 0, 1)).norm(), tolerance(1e-15));
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
  expect_refused(with([=](auto& d) { d.home.position.x() = nan; }), "'omni': its home");
}

}  // namespace
}  // namespace verisim::hardware_test

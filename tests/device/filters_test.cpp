#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/sources.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::filters_test {
namespace {

using test::expect_refused;
using test::tolerance;

std::shared_ptr<Device> moving() {
  HapticSamples s;
  s.t = {0, 1};
  s.pose = {{{0.01, 0.02, 0.03}, rotation_from_vector({0, 0, 1})},
            {{0.01, 0.02, 0.08}, rotation_from_vector({0, 1, 0})}};
  return make_replay("trace", s);
}

// The dissertation's trial: an Omni scaled by 4. Powers of two scale without rounding.
TEST(Scale, MultipliesPositionsAndDividesForces) {
  const auto source = moving();
  const auto device = make_scale(source, 4);
  device->sample({1, 1, 1});
  EXPECT_EQ(device->reading().handle.position, Vector3d(0.04, 0.08, 0.32));
  EXPECT_EQ(device->reading().handle.rotation.coeffs(), source->reading().handle.rotation.coeffs());
  EXPECT_EQ(device->reading().raw.position, Vector3d(0.01, 0.02, 0.08)) << "the hardware's own report stays";
  device->render({{8, 4, 2}, {1, 2, 3}}, {1, 1, 1e-3});
  EXPECT_EQ(device->rendered().force, Vector3d(2, 1, 0.5));
  EXPECT_EQ(device->rendered().torque, Vector3d(1, 2, 3));
  EXPECT_EQ(device->travel(), 4 * source->travel());
  EXPECT_EQ(device->duration(), 1);
  EXPECT_EQ(device->name(), "trace");
}

TEST(Translate, MovesTheHandleAndNothingElse) {
  const auto source = moving();
  const auto device = make_translate(source, {1, 2, 3});
  device->sample({1, 1, 1});
  EXPECT_EQ(device->reading().handle.position, Vector3d(1.01, 2.02, 3.08));
  EXPECT_EQ(device->reading().raw.position, Vector3d(0.01, 0.02, 0.08));
  device->render({{8, 4, 2}, {1, 2, 3}}, {1, 1, 1e-3});
  EXPECT_EQ(device->rendered().force, Vector3d(8, 4, 2));
  EXPECT_EQ(device->travel(), source->travel());
}

// A grasp that a scene starts with is taken where the handle is before the first frame.
TEST(Filters, SayWhereTheHandleIsBeforeTheFirstFrame) {
  EXPECT_EQ(make_scale(moving(), 4)->reading().handle.position, Vector3d(0.04, 0.08, 0.12));
  EXPECT_EQ(make_translate(moving(), {1, 2, 3})->reading().handle.position, Vector3d(1.01, 2.02, 3.03));
}

TEST(Filters, StackInTheOrderInWhichTheyWrap) {
  const auto scaled_last = make_scale(make_translate(moving(), {1, 0, 0}), 2);
  const auto moved_last = make_translate(make_scale(moving(), 2), {1, 0, 0});
  scaled_last->sample({0, 0, 1});
  moved_last->sample({0, 0, 1});
  EXPECT_LE((scaled_last->reading().handle.position - Vector3d(2.02, 0.04, 0.06)).norm(), tolerance(1e-15));
  EXPECT_LE((moved_last->reading().handle.position - Vector3d(1.02, 0.04, 0.06)).norm(), tolerance(1e-15));
}

// Forces are limited by the hardware after the scale divided them: 12 N through a scale of 4 are 3 N, under its 3.3 N.
TEST(Filters, ForcesReachTheHardwareScaled) {
  const auto device = make_scale(make_hardware(phantom_omni("omni"), moving()), 4);
  device->render({{0, 0, 12}, {0, 0, 0}}, {1, 1, 1e-3});
  EXPECT_EQ(device->rendered().force, Vector3d(0, 0, 3));
  device->render({{0, 0, 20}, {0, 0, 0}}, {1, 1, 1e-3});
  EXPECT_LE((device->rendered().force - Vector3d(0, 0, 3.3)).norm(), tolerance(4 * 0x1p-52));
}

TEST(Filters, RefuseNumbersThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double scale : {0.0, -4.0, nan, infinity})
    expect_refused([&] { return make_scale(moving(), scale); }, "'trace': scale");
  for (const double x : {nan, infinity})
    expect_refused([&] { return make_translate(moving(), {0, x, 0}); }, "'trace': translation");
}

}  // namespace
}  // namespace verisim::filters_test

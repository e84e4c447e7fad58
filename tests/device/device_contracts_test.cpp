// The doors of engine/device. What a scenario or a trace says is checked by Error(input) in the makers; here is what
// only the program itself could get wrong.
#include <gtest/gtest.h>

#include <limits>

#include "engine/device/bubble.hpp"
#include "engine/device/bump.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/passivity_filter.hpp"
#include "engine/device/sources.hpp"
#include "tests/support/broken.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::device_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kStep = 1e-3;

std::shared_ptr<Device> hand() {
  HandDescription description;
  description.path = {HandWaypoint()};
  return make_hand(description);
}

TEST(DeviceDeathTest, WrapsAnother) {
  EXPECT_BROKEN(make_scale(nullptr, 2), "inner != nullptr");
  EXPECT_BROKEN(make_translate(nullptr, {0, 0, 0}), "inner != nullptr");
  EXPECT_BROKEN(make_rotate(nullptr, Quaterniond::Identity()), "inner != nullptr");
  EXPECT_BROKEN(make_bubble(nullptr, {}), "inner != nullptr");
  EXPECT_BROKEN(make_carried(nullptr, std::make_shared<Navigator>()), "inner != nullptr");
  EXPECT_BROKEN(make_carried(hand(), nullptr), "navigator != nullptr");
  EXPECT_BROKEN(make_bump(nullptr, {}), "inner != nullptr");
  EXPECT_BROKEN(make_passivity_filter(nullptr, {}), "inner != nullptr");
}

TEST(DeviceDeathTest, GoesForwardInTime) {
  const auto replay = make_replay("omni", {{0, 1}, {{}, {}}, {}});
  replay->sample({0, 0.5, kStep});
  replay->sample({1, 0.5, kStep});
  EXPECT_BROKEN(replay->sample({2, 0.4, kStep}), "t >= last_t_");
  EXPECT_BROKEN(replay->sample({2, kNaN, kStep}), "std::isfinite(t)");
  EXPECT_BROKEN(replay->sample({2, 0.5, 0}), "is_positive(frame.dt)");
  const auto moved = hand();
  moved->sample({0, 0.5, kStep});
  EXPECT_BROKEN(moved->sample({1, 0.4, kStep}), "frame.t >= last_t_");
  EXPECT_BROKEN(hand()->sample({0, kNaN, kStep}), "std::isfinite(frame.t)");
  EXPECT_BROKEN(hand()->sample({0, 0, 0}), "is_positive(frame.dt)");
}

TEST(Hardware, RefusesAHomeThatIsNoPlacement) {
  HardwareDescription description = phantom_omni("omni");
  description.home.rotation.coeffs().setZero();
  test::expect_refused([&] { return make_hardware(description, nullptr); },
                       "'omni': its home pose is not finite with a unit quaternion");
}

}  // namespace
}  // namespace verisim::device_contracts_test

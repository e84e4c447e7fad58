// The virtual Wii Remote: ideal by default, and each imperfection what its parameter says.
#include "engine/wii/virtual_remote.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "engine/base/error.hpp"
#include "tests/support/paths.hpp"
#include "tests/wii/recordings.hpp"

namespace verisim::wii::virtual_remote_test {
namespace {

Situation head_at(const Vector3d& p_W) {
  return {.X_WR = {}, .X_WH = {p_W, Quaterniond::Identity()}};
}

Channels sensed(const RemoteSettings& settings, const Situation& situation, std::uint64_t k = 0) {
  return VirtualRemote(settings, 1, "remote").sense(k, situation).channels;
}

// Pitch lifts the lens, roll raises the remote's left side: X_WR = (Rx(-p) Rz(r)) with L = W turned by no heading.
Situation tilted(double pitch, double roll, const Vector3d& p_R) {
  Situation s;
  s.X_WR.rotation = rotation_from_vector({-pitch, 0, 0}) * rotation_from_vector({0, 0, roll});
  s.X_WH = {s.X_WR * p_R, Quaterniond::Identity()};
  return s;
}

// ORACLES section 2, "Pinhole sensor": 0.15 m at 1 m is 194.97 pixels.
TEST(VirtualRemote, ImagesTwoLedsAtTheWorkedDistance) {
  RemoteSettings settings;
  settings.whole_pixels = false;
  const Channels c = sensed(settings, head_at({0, 0, 1}));
  EXPECT_NEAR(c[4] - c[7], 194.97, 0.005);
  EXPECT_NEAR(c[5], 384, 1e-9);
  EXPECT_EQ(c[6], 4);
}

class RecordedChannels : public testing::TestWithParam<const char*> {};
TEST_P(RecordedChannels, AreWhatTheIdealRemoteSends) {
  const std::vector<RecordedRow> rows = read_recording(GetParam());
  if (rows.empty()) GTEST_SKIP() << "no " << GetParam() << " in " << paths::in_shared_reference("wii");
  VirtualRemote remote({}, 1, "remote");
  int near_edge = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const SensedReport report = remote.sense(k, head_at({rows[k].truth[0], rows[k].truth[1], rows[k].truth[2]}));
    for (std::size_t i = 0; i < kChannels; ++i) {
      const double difference = std::abs(report.channels[i] - rows[k].channels[i]);
      // The recorded truth has ten digits: at a rounding edge one pixel may fall either way.
      if (difference != 0) ++near_edge;
      ASSERT_LE(difference, 1) << "row " << k << ", channel " << i;
    }
  }
  EXPECT_LE(near_edge, 1);
}
INSTANTIATE_TEST_SUITE_P(Upstream, RecordedChannels, testing::Values("static_centre.csv", "sweep_x.csv"),
                         [](const auto& param) { return std::string(param.param).substr(0, 6); });

// reference/wii/README.md: for pitch p and roll r the noise-free reading is (cos p sin r, -sin p, cos p cos r).
TEST(VirtualRemote, FeelsGravityAsTheReferenceSays) {
  const double p = 20 * kDegree;
  const double r = 10 * kDegree;
  const Channels c = sensed({}, tilted(p, r, {0, 0, 1}));
  EXPECT_NEAR(c[1], std::cos(p) * std::sin(r), 1e-12);
  EXPECT_NEAR(c[2], -std::sin(p), 1e-12);
  EXPECT_NEAR(c[3], std::cos(p) * std::cos(r), 1e-12);
}

TEST(VirtualRemote, TruthIsLevelled) {
  const Situation s = tilted(20 * kDegree, 10 * kDegree, {0.1, 0, 1});
  const Pose X_LH = levelled_pose(s);
  EXPECT_LT((X_LH.position - s.X_WH.position).norm(), 1e-12);  // no heading: L and W have the same axes here
  EXPECT_NEAR(std::abs(X_LH.rotation.w()), 1, 1e-12);
}

TEST(VirtualRemote, SeesOnlyWhatIsInTheImage) {
  const Channels c = sensed({}, head_at({0.38, 0, 1}));  // LED 0 at 0.455 m is beyond tan(21.5 deg) = 0.394
  EXPECT_EQ(c[4], -1);
  EXPECT_EQ(c[6], -1);
  EXPECT_GT(c[7], 0);
}

TEST(VirtualRemote, KeepsSlotsWhenTheyAreTheLedsOwn) {
  RemoteSettings settings;
  settings.outages = {{.led = 0, .begin = 0.01, .end = 0.02}};
  VirtualRemote remote(settings, 1, "remote");
  EXPECT_GT(remote.sense(0, head_at({0, 0, 1})).channels[4], 512);
  EXPECT_EQ(remote.sense(1, head_at({0, 0, 1})).channels[4], -1);
  EXPECT_GT(remote.sense(2, head_at({0, 0, 1})).channels[4], 512);
}

TEST(VirtualRemote, ReordersSlotsWhenBlobsTakeTheFirstFreeOne) {
  RemoteSettings settings;
  settings.slot_rule = SlotRule::first_free;
  settings.outages = {{.led = -1, .begin = 0, .end = 0.01}, {.led = 0, .begin = 0, .end = 0.02}};
  VirtualRemote remote(settings, 1, "remote");
  EXPECT_EQ(remote.sense(0, head_at({0, 0, 1})).led_in_view, 0U);
  EXPECT_LT(remote.sense(1, head_at({0, 0, 1})).channels[4], 512);  // LED 1 came first
  const SensedReport both = remote.sense(2, head_at({0, 0, 1}));
  EXPECT_LT(both.channels[4], 512);
  EXPECT_GT(both.channels[7], 512);
  EXPECT_EQ(both.led_in_view, 3U);
}

TEST(VirtualRemote, ExchangesSlotsFromThatMomentOn) {
  RemoteSettings settings;
  settings.exchanges = {{.t = 0.01, .a = 0, .b = 1}};
  EXPECT_EQ(sensed(settings, head_at({0, 0, 1}), 0)[4], 609);
  EXPECT_EQ(sensed(settings, head_at({0, 0, 1}), 1)[4], 415);
}

TEST(VirtualRemote, ReportsAtMostFourLights) {
  RemoteSettings settings;
  for (double x : {-0.2, -0.1, 0.15, 0.25}) settings.lamps.push_back({.p_W = {x, 0.1, 1}});
  const Channels c = sensed(settings, head_at({0, 0, 1}));
  EXPECT_EQ(c[4], 609);
  EXPECT_EQ(c[7], 415);
  EXPECT_GT(c[10], 0);
  EXPECT_GT(c[13], 0);
}

// Two rows of ten: the first four have the slots until one of them leaves the image.
TEST(VirtualRemote, ImagesAnyNumberOfPointsFourAtATime) {
  RemoteSettings settings;
  settings.slot_rule = SlotRule::first_free;
  settings.leds.clear();
  for (int i = 0; i < 20; ++i) settings.leds.push_back(Led{{0.02 * (i % 10) - 0.09, 0.05 * (i / 10), 0}});
  settings.pixel_noise = 0.3;
  VirtualRemote remote(settings, 1, "remote");
  EXPECT_EQ(remote.sense(0, head_at({0, 0, 1})).led_in_view, 0b1111U);
  // u = 1023 is 0.39 m to the side: LED 3 at x = 0.42 is out, LED 0 at 0.36 in.
  const SensedReport aside = remote.sense(1, head_at({0.45, 0, 1}));
  EXPECT_EQ(std::popcount(aside.led_in_view), 4);
  EXPECT_EQ(aside.led_in_view & 0b1111U, 0b0011U);
}

TEST(VirtualRemote, LosesAnLedBehindTheHeadThatWearsIt) {
  RemoteSettings settings;
  settings.balls = {{.centre = {0, 0, 0.1}, .radius = 0.1, .on_head = true}};
  Situation s = head_at({0, 0, 1});
  EXPECT_EQ(VirtualRemote(settings, 1, "r").sense(0, s).led_in_view, 3U);
  s.X_WH.rotation = rotation_from_vector({0, 120 * kDegree, 0});  // turned away
  EXPECT_EQ(VirtualRemote(settings, 1, "r").sense(0, s).led_in_view, 1U);
}

TEST(VirtualRemote, WeakerCellsAndSlantedLedsLookSmaller) {
  RemoteSettings settings;
  EXPECT_EQ(sensed(settings, head_at({0, 0, 1}))[6], 4);
  settings.battery = 0.25;
  EXPECT_EQ(sensed(settings, head_at({0, 0, 1}))[6], 2);
  settings.battery = 1;
  settings.half_power_angle = 20 * kDegree;
  Situation s = head_at({0, 0, 1});
  s.X_WH.rotation = rotation_from_vector({20 * kDegree, 0, 0});
  EXPECT_EQ(sensed(settings, s)[6], 3);  // 4 sqrt(0.5) = 2.83
  settings.intensity_min = 0.6;
  EXPECT_EQ(sensed(settings, s)[6], -1);
}

// 104 counts per g at 10 bit, 26 at 8 bit.
TEST(VirtualRemote, RoundsAccelerationsToWholeCounts) {
  for (const auto& [bits, counts] : {std::pair{8, 26.0}, std::pair{10, 104.0}}) {
    RemoteSettings settings;
    settings.accelerometer_bits = bits;
    const Channels c = sensed(settings, tilted(0.3, 0.1, {0, 0, 1}));
    for (int i = 1; i <= 3; ++i)
      EXPECT_NEAR(c[static_cast<std::size_t>(i)] * counts, std::round(c[static_cast<std::size_t>(i)] * counts), 1e-9);
  }
}

TEST(VirtualRemote, SaturatesAndFeelsItsOwnMotion) {
  RemoteSettings settings;
  settings.accelerometer_limit = 3.6;
  Situation s = head_at({0, 0, 1});
  s.acceleration_W = {9.80665, 0, 0};
  EXPECT_NEAR(sensed(settings, s)[1], 1, 1e-12);
  s.acceleration_W = {100, 0, 0};
  EXPECT_EQ(sensed(settings, s)[1], 3.6);
}

TEST(VirtualRemote, NoiseHasItsStandardDeviation) {
  RemoteSettings settings;
  settings.whole_pixels = false;
  settings.pixel_noise = 0.3;
  VirtualRemote remote(settings, 1, "remote");
  double sum = 0;
  constexpr int kCount = 10000;
  for (std::uint64_t k = 0; k < kCount; ++k) {
    const double e = remote.sense(k, head_at({0, 0, 1})).channels[5] - 384;
    sum += e * e;
  }
  EXPECT_NEAR(std::sqrt(sum / kCount), 0.3, 4 * 0.3 / std::sqrt(2.0 * kCount));
}

TEST(VirtualRemote, NoiseDoesNotDependOnOtherImperfections) {
  RemoteSettings plain;
  plain.pixel_noise = 0.3;
  RemoteSettings more = plain;
  more.accelerometer_noise = 0.01;
  more.loss = 0.5;
  more.lamps = {{.p_W = {0.2, 0.1, 1}}};
  const Channels a = sensed(plain, head_at({0, 0, 1}), 77);
  const Channels b = sensed(more, head_at({0, 0, 1}), 77);
  for (std::size_t i = 4; i < 10; ++i) EXPECT_EQ(a[i], b[i]);
}

TEST(VirtualRemote, LowSensitivityLosesTheSubpixels) {
  RemoteSettings settings;
  settings.subpixels = 2;
  const Channels c = sensed(settings, head_at({0.013, 0, 1}));
  EXPECT_EQ(std::fmod(c[4], 4), 0);
}

TEST(VirtualRemote, JitterAndLossHaveTheirShares) {
  RemoteSettings settings;
  settings.jitter = 0.4;
  settings.loss = 0.1;
  const VirtualRemote remote(settings, 1, "remote");
  int lost = 0;
  constexpr int kCount = 10000;
  for (std::uint64_t k = 1; k < kCount; ++k) {
    ASSERT_GT(remote.report_time(k), remote.report_time(k - 1));
    lost += remote.lost(k) ? 1 : 0;
  }
  EXPECT_NEAR(lost, 1000, 4 * std::sqrt(900.0));
}

TEST(VirtualRemote, RefusesSettingsOutsideTheirRange) {
  RemoteSettings settings;
  settings.accelerometer_bits = 9;
  EXPECT_THROW(VirtualRemote(settings, 1, "r"), Error);
  settings = {};
  settings.leds.clear();
  EXPECT_THROW(VirtualRemote(settings, 1, "r"), Error);
  settings.leds.resize(5);
  EXPECT_THROW(VirtualRemote(settings, 1, "r"), Error) << "five LEDs, four slots of their own";
}

}  // namespace
}  // namespace verisim::wii::virtual_remote_test

// Input that no healthy remote sends: survived, never valid, never news, by every tracker that follows tracker.hpp's
// rules.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "engine/base/random.hpp"
#include "engine/wii/sensed_run.hpp"
#include "engine/wii/tracker.hpp"
#include "engine/wii/validate.hpp"
#include "tests/length.hpp"

namespace verisim::wii::bad_input_test {
namespace {

constexpr Channels kGood = {0.75, 0, 0, 1, 609, 384, 4, 415, 384, 4, -1, -1, -1, -1, -1, -1};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// NAME/3: with three LEDs.
std::vector<std::string> honest_trackers() {
  std::vector<std::string> names = tracker_names();
  std::erase(names, "vrpn-compatible");
  names.emplace_back("scaat/3");
  return names;
}
const TrackerEntry& entry_of(const std::string& name) {
  return find_tracker(name.substr(0, name.find('/')));
}
bool has_three_leds(const std::string& name) {
  return name.ends_with("/3") || entry_of(name).leds.count == 3;
}
std::unique_ptr<Tracker> make(const std::string& name, const Pose& X_R1R2 = {}) {
  TrackerSettings settings;
  if (has_three_leds(name)) settings.leds = LedLayout::triangle();
  if (entry_of(name).remotes == 2) settings.X_R1R2 = X_R1R2;
  return make_tracker(entry_of(name).name, settings);
}

class BadInput : public testing::TestWithParam<std::string> {
 protected:
  /// A good report of whatever LEDs the tracker needs.
  [[nodiscard]] Channels good() const {
    Channels c = kGood;
    if (has_three_leds(GetParam())) {  // LED 2 at (0, 0.04, -0.06), 1 m away: v = 384 + 1339.17 * 0.04 / 0.94
      c[10] = 512;
      c[11] = 441;
      c[12] = 4;
    }
    return c;
  }
  std::unique_ptr<Tracker> tracker_ = make(GetParam());
};

TEST_P(BadInput, NothingIsReportedBeforeTheFirstData) {
  const Report& report = tracker_->heartbeat(1);
  EXPECT_FALSE(report.valid);
  EXPECT_FALSE(report.news);
  EXPECT_TRUE(std::isnan(report.pose.position.x()));
}

TEST_P(BadInput, GoodDataIsValidAtOnceAndAHeartbeatIsNoNews) {
  EXPECT_TRUE(tracker_->update(0, good()).valid);
  EXPECT_TRUE(tracker_->update(0.01, good()).news);
  EXPECT_FALSE(tracker_->heartbeat(0.02).news);
  EXPECT_TRUE(tracker_->heartbeat(0.02).valid);
  EXPECT_FALSE(tracker_->heartbeat(1).valid);
}

TEST_P(BadInput, FewerThanFifteenChannelsAreNoNews) {
  const Channels c = good();
  for (std::size_t n = 0; n < kChannelsMin; ++n) EXPECT_FALSE(tracker_->update(0, std::span(c).first(n)).news) << n;
  EXPECT_TRUE(tracker_->update(0, std::span(c).first(kChannelsMin)).valid);
}

TEST_P(BadInput, NanIsNeverValid) {
  for (std::size_t i = 1; i < 10; ++i) {
    std::unique_ptr<Tracker> tracker = make(GetParam());
    Channels c = good();
    c[i] = kNan;
    EXPECT_FALSE(tracker->update(0, c).valid) << i;
  }
  EXPECT_FALSE(tracker_->update(kNan, good()).news);
}

TEST_P(BadInput, PixelsOutsideTheImageAreNotBlobs) {
  for (const double u : {-5.0, 1024.0, 1e300, -1e300}) {
    Channels c = good();
    c[4] = u;
    EXPECT_FALSE(tracker_->update(0, c).valid) << u;
  }
}

TEST_P(BadInput, CoincidentBlobsAndAllZerosAreNoHead) {
  Channels c = good();
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    c[4 + 3 * slot] = 500;
    c[5 + 3 * slot] = 400;
    c[6 + 3 * slot] = 4;
  }
  EXPECT_FALSE(tracker_->update(0, c).valid);
  EXPECT_FALSE(tracker_->update(0.01, Channels{}).valid);
}

TEST_P(BadInput, GravityZeroCannotLevelAndKeepsWhatWasKnown) {
  Channels c = good();
  c[3] = 0;
  EXPECT_FALSE(tracker_->update(0, c).valid);
  EXPECT_TRUE(tracker_->update(0.01, good()).valid);
  EXPECT_TRUE(tracker_->update(0.02, c).valid);
}

TEST_P(BadInput, TimeThatStandsStillOrGoesBackIsNoNews) {
  EXPECT_TRUE(tracker_->update(1, good()).news);
  EXPECT_FALSE(tracker_->update(1, good()).news);
  EXPECT_FALSE(tracker_->update(0.5, good()).news);
  EXPECT_TRUE(tracker_->update(1.01, good()).news);
}

TEST_P(BadInput, TimeThatGoesFarBackIsANewRecording) {
  tracker_->update(100, good());
  const Report& report = tracker_->update(0, good());
  EXPECT_TRUE(report.valid);
  EXPECT_TRUE(report.reacquired);
}

// Not a trace of the recording before is left: reports are those of a tracker that never saw it, to the bit.
TEST_P(BadInput, ANewRecordingIsTrackedAsByANewTracker) {
  const std::string name = GetParam();
  const auto run = [&](Tracker& tracker, const char* path, const char* sensor, double shift) {
    const LedLayout leds = has_three_leds(name) ? LedLayout::triangle() : LedLayout();
    const RemoteSettings remote = remote_settings(sensor_case(sensor).settings, trajectory(path), leds, {});
    std::vector<Report> reports;
    for (const Sensed& s : sense_run(remote, trajectory(path), entry_of(name).remotes, 1, 0))
      reports.push_back(tracker.update(s.report.t + shift, s.report.channels, s.remote));
    return reports;
  };
  const std::unique_ptr<Tracker> fresh = make(name, second_remote());
  const std::vector<Report> first = run(*fresh, "edges", "wiimote", 0);
  for (const char* before : {"edges", "natural-yaw", "dropout-one", "moving-remote"}) {
    const std::unique_ptr<Tracker> used = make(name, second_remote());
    (void)run(*used, before, "lamp", 1000);
    const std::vector<Report> again = run(*used, "edges", "wiimote", 0);
    ASSERT_EQ(again.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      SCOPED_TRACE(testing::Message() << before << ", report " << i);
      ASSERT_EQ(again[i].valid, first[i].valid);
      if (!first[i].valid) continue;
      ASSERT_EQ(again[i].pose.position, first[i].pose.position);
      ASSERT_EQ(again[i].pose.rotation.coeffs(), first[i].pose.rotation.coeffs());
      ASSERT_EQ(again[i].covariance, first[i].covariance);
    }
  }
}

// Times that grow by next to nothing, or by ages.
TEST_P(BadInput, StepsOfTimeOfAnySizeAreSurvived) {
  for (const double step : {1e-300, 1e-12, 1e-3, 1e9, 1e300}) {
    const std::unique_ptr<Tracker> tracker = make(GetParam());
    for (int i = 1; i <= 2000; ++i) {
      const Report& report = tracker->update(step * i, good());
      ASSERT_TRUE(report.valid) << step << ", " << i;
      ASSERT_TRUE(report.pose.position.allFinite() && report.covariance.allFinite()) << step << ", " << i;
    }
  }
}

TEST_P(BadInput, AThousandReportsInAMillisecondMoveNothing) {
  const Vector3d before = tracker_->update(0, good()).pose.position;
  for (int i = 1; i <= 1000; ++i) {
    Channels c = good();
    c[4] += i % 2;  // a pixel of flicker: 5 mm of depth
    const Report& report = tracker_->update(1e-6 * i, c);
    ASSERT_TRUE(report.valid);
    ASSERT_FALSE(report.reacquired);
  }
  EXPECT_LE((tracker_->heartbeat(0.001).pose.position - before).norm(), 5 * 0.001);
}

TEST_P(BadInput, AReportAfterAMinuteOfSilenceIsAReacquisition) {
  tracker_->update(0, good());
  const Report& report = tracker_->update(60, good());
  EXPECT_TRUE(report.valid);
  EXPECT_TRUE(report.reacquired);
}

/// A channel value that is anything: a plausible number, a huge one, a special one.
double any_value(const RandomStream& random, std::uint64_t c, double plausible_max) {
  const double which = random.uniform(2 * c);
  const double x = random.uniform(2 * c + 1);
  if (which < 0.9) return -1 + (plausible_max + 1) * x;
  if (which < 0.94) return 2 * plausible_max * (x - 0.5) * 1e3;
  if (which < 0.96) return (x - 0.5) * 1e308;
  if (which < 0.97) return kNan;
  if (which < 0.98) return std::numeric_limits<double>::infinity();
  return 0;
}

Channels any_channels(const RandomStream& random, std::uint64_t k, const Channels& base) {
  Channels c = base;
  const double mode = random.uniform(1000 * k);
  if (mode < 0.3) return c;  // healthy reports between, so that locks are won and lost
  for (std::uint64_t i = 1; i < kChannels; ++i) {
    if (mode < 0.6 && random.uniform(1000 * k + i) < 0.7) continue;
    const double max = i < 4 ? 1.5 : (i - 4) % 3 == 0 ? kWidth : (i - 4) % 3 == 1 ? kHeight : 15;
    c[i] = any_value(random, 1000 * k + 100 + i, max);
  }
  return c;
}

std::uint64_t fuzz_count() {
  return test::by_length<std::uint64_t>(12'500, 200'000, 10'000'000);
}

// Issue, "Numbers": 10^7 frames with VERISIM_LONG_TESTS=1, a fiftieth without.
TEST_P(BadInput, RandomReportsNeverMakeAWrongReport) {
  const RandomStream random(7, "fuzz");
  const RandomStream other(7, "fuzz/second remote");
  const std::uint64_t count = fuzz_count();
  Vector3d last_p = Vector3d::Zero();
  double last_t = 0;
  bool last_set = false;
  std::uint64_t valid = 0;
  double t = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    t += 0.01 * random.uniform(1000 * k + 500) + (random.uniform(1000 * k + 501) < 0.001 ? 1.0 : 0.0);
    if (entry_of(GetParam()).remotes == 2) (void)tracker_->update(t, any_channels(other, k, good()), 1);
    const Report& report = tracker_->update(t, any_channels(random, k, good()));
    if (!report.valid) continue;
    ++valid;
    const Vector3d& p = report.pose.position;
    ASSERT_TRUE(p.allFinite() && report.covariance.allFinite()) << k;
    ASSERT_NEAR(report.pose.rotation.norm(), 1, 1e-9) << k;
    ASSERT_GT(report.covariance.diagonal().minCoeff(), 0) << k;
    ASSERT_GE(p.norm(), 0.2) << k;
    ASSERT_LE(p.norm(), 5) << k;
    if (last_set && !report.reacquired) {
      ASSERT_LE((p - last_p).norm(), 5 * (t - last_t)) << k;
    }
    last_p = p;
    last_t = t;
    last_set = true;
  }
  EXPECT_GT(valid, count / 10) << "locks were hardly ever won: this test would prove little";
}

// It keeps upstream's rules, not ours; but what it calls valid can be computed with.
TEST(VrpnCompatible, RandomReportsNeverMakeOneThatIsNotFinite) {
  const RandomStream random(7, "fuzz");
  const std::unique_ptr<Tracker> tracker = make("vrpn-compatible");
  std::uint64_t valid = 0;
  for (std::uint64_t k = 0; k < fuzz_count(); ++k) {
    const Report& report = tracker->update(0.01 * static_cast<double>(k), any_channels(random, k, kGood));
    ASSERT_TRUE(report.pose.position.allFinite() && report.pose.rotation.coeffs().allFinite()) << k;
    valid += report.valid ? 1 : 0;
  }
  EXPECT_GT(valid, fuzz_count() / 10);
}

INSTANTIATE_TEST_SUITE_P(Trackers, BadInput, testing::ValuesIn(honest_trackers()), [](const auto& param) {
  std::string name = param.param;
  std::erase_if(name, [](char c) { return c == '-' || c == '/'; });
  return name;
});

}  // namespace
}  // namespace verisim::wii::bad_input_test

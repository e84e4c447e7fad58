// No head turns over without a word: heads that roll beyond a right angle, lose one LED or both for a while and show
// them again, and remotes that start on their buttons or are turned over, before every tracker that takes a pair.
#include "engine/wii/half_turn.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.hpp"
#include "engine/wii/sensed_run.hpp"
#include "engine/wii/tracker.hpp"
#include "engine/wii/validate.hpp"
#include "tests/length.hpp"

namespace verisim::wii {
namespace {

/// A head 1 m away that rolls from upright to `roll` between 1 and 2 s and back between 6 and 7 s; LED `led` (-1: both)
/// is dark for `dark` seconds from 4 s on. All drawn from the seed. Beyond half a second nobody can know which way
/// round it is then: the report has to say so.
struct Rolled {
  explicit Rolled(std::uint64_t seed) : random(seed, "rolled") {
    roll = (100 + 70 * random.uniform(0)) * kDegree * (random.uniform(1) < 0.5 ? -1 : 1);
    led = static_cast<int>(3 * random.uniform(2)) - 1;
    dark = 0.05 + 2 * random.uniform(3) * random.uniform(3);
    path.name = "rolled";
    path.duration = 8;
    path.outages = {{led, 4, 4 + dark}};
    const double r = roll;
    path.at = [r](double t) {
      const auto ramp = [](double s) { return s <= 0 ? 0 : s >= 1 ? 1 : 0.5 - 0.5 * std::cos(M_PI * s); };
      const double share = ramp(t - 1) - ramp(t - 6);
      return Situation{.X_WR = {}, .X_WH = {{0.05 * std::sin(t), 0.03, 1}, head_rotation(0, 0, r * share)}};
    };
  }
  RandomStream random;
  double roll = 0, dark = 0;
  int led = 0;
  Trajectory path;
};

struct Turns {
  double fastest_untold = 0;  ///< rad/s, between valid reports of which the second is not `reacquired`
  double worst_sigmas = 0;    ///< of a roll that is off, in the standard deviations that its report states
  int wrong = 0;              ///< valid reports that are half a turn off
  int valid = 0;
};
Turns turns_of(std::string_view tracker, const Trajectory& path, const SensorCase& sensor, std::uint64_t seed,
               const Thresholds& thresholds = {}) {
  const bool triangle = tracker.ends_with("/3");
  if (triangle) tracker.remove_suffix(2);
  const TrackerEntry& entry = find_tracker(tracker);
  TrackerSettings settings;
  settings.thresholds = thresholds;
  settings.leds = triangle ? LedLayout::triangle() : entry.leds;
  if (entry.remotes == 2) settings.X_R1R2 = second_remote();
  const RemoteSettings remote = remote_settings(sensor.settings, path, settings.leds, {});
  const auto judged = make_tracker(tracker, settings);
  Turns turns;
  Report last;
  for (const Sensed& s : sense_run(remote, path, entry.remotes, seed, 0)) {
    const Report report = judged->update(s.report.t, s.report.channels, s.remote);
    if (!report.news) continue;
    if (report.valid) {
      ++turns.valid;
      const Vector3d off =
          vector_from_rotation((report.pose.rotation * s.report.X_LH.rotation.conjugate()).normalized());
      turns.wrong += std::abs(off.z()) > M_PI / 2 ? 1 : 0;
      turns.worst_sigmas = std::max(turns.worst_sigmas, std::abs(off.z()) / std::sqrt(report.covariance(5, 5)));
      if (last.valid && !report.reacquired) {
        const double turned = (report.pose.rotation * last.pose.rotation.conjugate()).normalized().vec().norm();
        turns.fastest_untold =
            std::max(turns.fastest_untold, 2 * std::asin(std::min(1.0, turned)) / (report.t - last.t));
      }
    }
    last = report;
  }
  return turns;
}

class OfPairs : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(HalfTurn, OfPairs, ::testing::Values("geometric", "scaat", "stereo"),
                         [](const auto& tracker) { return std::string(tracker.param); });

TEST_P(OfPairs, HeadsThatRollFarAreFollowedOrInDoubt) {
  const int seeds = test::by_length(10, 100, 2000);
  for (const char* sensor : {"noisy", "wiimote"})
    for (int i = 0; i < seeds; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      const Rolled rolled(seed);
      const Turns turns = turns_of(GetParam(), rolled.path, sensor_case(sensor), seed);
      SCOPED_TRACE(fmt::format("{}, seed {}: roll {:.0f} deg, LED {} dark for {:.2f} s", sensor, i,
                               rolled.roll / kDegree, rolled.led, rolled.dark));
      EXPECT_LE(turns.fastest_untold, 15);
      EXPECT_LE(turns.worst_sigmas, 6);
      if (rolled.dark > 0.5) continue;
      EXPECT_EQ(turns.wrong, 0);
    }
}

/// A number of which no formula tells the value: halved and doubled, what is promised still holds.
struct Number {
  const char* name;
  double Thresholds::*member;
};
class WiiHalfTurn : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(
    HalfAndDouble, WiiHalfTurn,
    ::testing::Values(Number{"roll_sigma", &Thresholds::roll_sigma}, Number{"lying", &Thresholds::lying},
                      Number{"roll_speed", &Thresholds::roll_speed}, Number{"roll_noise", &Thresholds::roll_noise},
                      Number{"seen_gap", &Thresholds::seen_gap}, Number{"posture_kept", &Thresholds::posture_kept},
                      Number{"posture_time", &Thresholds::posture_time}),
    [](const auto& number) { return std::string(number.param.name); });

TEST_P(WiiHalfTurn, HardlyHangsOnIt) {
  const int seeds = test::by_length(5, 40, 1000);
  for (const double factor : {0.5, 2.0})
    for (int i = 0; i < seeds; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      const Rolled rolled(seed);
      Thresholds thresholds;
      thresholds.*GetParam().member *= factor;
      const Turns turns = turns_of("geometric", rolled.path, sensor_case("wiimote"), seed, thresholds);
      SCOPED_TRACE(fmt::format("x {}, seed {}: roll {:.0f} deg, LED {} dark for {:.2f} s", factor, i,
                               rolled.roll / kDegree, rolled.led, rolled.dark));
      EXPECT_LE(turns.fastest_untold, 15);
      EXPECT_LE(turns.worst_sigmas, 6);
      if (rolled.dark <= 0.5) {
        EXPECT_EQ(turns.wrong, 0);
      }
    }
}

// A remote that lies on its buttons, or on its side, and is put right within a second while it watches a head, or while
// the head is not to be seen.
TEST_P(OfPairs, RemotesThatAreTurnedOverTurnNoHead) {
  const int seeds = test::by_length(5, 50, 500);
  for (const bool dark : {false, true})
    for (int i = 0; i < seeds; ++i) {
      const RandomStream random(static_cast<std::uint64_t>(i), "turned over");
      const double from = (90 + 90 * random.uniform(0)) * kDegree * (random.uniform(1) < 0.5 ? -1 : 1);
      const double head_roll = 40 * kDegree * (2 * random.uniform(2) - 1);
      Trajectory path;
      path.name = "turned-over";
      path.duration = 5;
      path.moves_remote = true;
      if (dark) path.outages = {{-1, 1.9, 3.2}};
      path.at = [=](double t) {
        const double share = t < 2 ? 1 : t > 3 ? 0 : 0.5 + 0.5 * std::cos(M_PI * (t - 2));
        return Situation{.X_WR = tilted_remote(0.05, from * share),
                         .X_WH = {{0.02, 0.03, 1.2}, head_rotation(0, 0, head_roll)}};
      };
      const Turns turns = turns_of(GetParam(), path, sensor_case("wiimote"), static_cast<std::uint64_t>(i));
      SCOPED_TRACE(fmt::format("seed {}: from {:.0f} deg, head at {:.0f}, {}", i, from / kDegree, head_roll / kDegree,
                               dark ? "unseen" : "seen"));
      EXPECT_LE(turns.fastest_untold, 15);
      EXPECT_EQ(turns.wrong, 0);
      EXPECT_GE(turns.valid, dark ? 330 : 450);
    }
}

TEST(Turns, FasterThanHeadsTurnAreTold) {
  for (const char* sensor : test::some_of({"wiimote", "lamp", "low-sensitivity"}))
    for (const Trajectory& path : trajectories())
      for (const char* tracker : {"geometric", "three-led", "scaat", "stereo", "scaat/3"}) {
        SCOPED_TRACE(fmt::format("{}, {}, {}", sensor, path.name, tracker));
        EXPECT_LE(turns_of(tracker, path, sensor_case(sensor), 1).fastest_untold, 15);
      }
}

}  // namespace
}  // namespace verisim::wii

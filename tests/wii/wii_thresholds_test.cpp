// How much the trackers' errors hang on the heuristic numbers of thresholds.hpp: each is halved and doubled, alone,
// where it speaks. "Worse" is the rms error of the position against that with the numbers as they are.
#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "engine/wii/gravity.hpp"
#include "engine/wii/place.hpp"
#include "engine/wii/validate.hpp"
#include "tests/length.hpp"

namespace verisim::wii::wii_thresholds_test {
namespace {

struct Number {
  const char* name;
  std::variant<double Thresholds::*, int Thresholds::*> member;
  const char* tracker;
  const char* trajectory;
  const char* sensor;
  double worse_max;  ///< times the usual error
};

ValidationRow row(const Number& n, double factor) {
  ValidationOptions options;
  std::visit(
      [&](auto member) {
        auto& number = options.tracker.thresholds.*member;
        number = static_cast<std::remove_reference_t<decltype(number)>>(factor * number);
      },
      n.member);
  options.measure_time = false;
  return validate_one(n.tracker, trajectory(n.trajectory), sensor_case(n.sensor), options);
}

// What a tracker does with a head of three LEDs of which one is dark hangs on its numbers, by up to 62 %; so does how
// two remotes predict where a blob will be, by 30 %, beside errors of 2 mm. All else does by a tenth at most, most of
// it not at all.
class WiiThresholds : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(
    HalfAndDouble, WiiThresholds,
    ::testing::ValuesIn(test::some_of(
        {Number{"linear_density", &Thresholds::linear_density, "scaat/3", "natural-yaw", "wiimote", 1.06},
         Number{"angular_density", &Thresholds::angular_density, "scaat/3", "natural-yaw", "wiimote", 1.05},
         Number{"guessed_density", &Thresholds::guessed_density, "scaat/3", "dropout-one", "wiimote", 1.21},
         Number{"unseen_density", &Thresholds::unseen_density, "scaat", "dropout-both", "wiimote", 1.05},
         Number{"decay", &Thresholds::decay, "scaat", "dropout-one", "wiimote", 1.05},
         Number{"pair_decay", &Thresholds::pair_decay, "scaat/3", "dropout-one", "wiimote", 1.62},
         Number{"slow", &Thresholds::slow, "scaat/3", "dropout-one", "wiimote", 1.05},
         Number{"clutter_radius", &Thresholds::clutter_radius, "geometric", "dropout-one", "lamp", 1.05},
         Number{"pair_cost_max", &Thresholds::pair_cost_max, "geometric", "natural", "lamp", 1.05},
         Number{"cost_margin", &Thresholds::cost_margin, "geometric", "dropout-one", "lamp", 1.05},
         Number{"cost_per_led_max", &Thresholds::cost_per_led_max, "three-led", "natural-yaw", "wiimote", 1.05},
         Number{"gate_sigmas", &Thresholds::gate_sigmas, "scaat", "swap", "wiimote", 1.05},
         Number{"pixel_gate", &Thresholds::pixel_gate, "scaat", "natural", "wiimote", 1.05},
         Number{"gate", &Thresholds::gate, "three-led", "natural-yaw", "wiimote", 1.05},
         Number{"gate_growth", &Thresholds::gate_growth, "three-led", "dropout-both", "wiimote", 1.05},
         Number{"sigma_max", &Thresholds::sigma_max, "scaat", "natural", "wiimote", 1.05},
         Number{"upright_time", &Thresholds::upright_time, "scaat/3", "natural-yaw", "wiimote", 1.05},
         Number{"prior_width", &Thresholds::prior_width, "three-led", "natural-yaw", "wiimote", 1.05},
         Number{"roll_sigma", &Thresholds::roll_sigma, "three-led", "tilted", "wiimote", 1.05},
         Number{"turn_rate", &Thresholds::turn_rate, "three-led", "dropout-one", "wiimote", 1.52},
         Number{"still_known", &Thresholds::still_known, "three-led", "dropout-one", "wiimote", 1.16},
         Number{"start_speed", &Thresholds::start_speed, "scaat", "dropout-both", "lamp", 1.01},
         Number{"start_spin", &Thresholds::start_spin, "scaat/3", "static", "lamp", 1.01},
         Number{"velocity_gain", &Thresholds::velocity_gain, "stereo", "swap", "wiimote", 1.3},
         Number{"pair_speed", &Thresholds::pair_speed, "scaat", "dropout-one", "lamp", 1.2},
         Number{"lost_head_memory", &Thresholds::lost_head_memory, "stereo", "dropout-one", "wiimote", 1.01},
         Number{"size_learning", &Thresholds::size_learning, "scaat", "dropout-one", "wiimote", 1.03},
         Number{"size_sigma", &Thresholds::size_sigma, "scaat", "dropout-one", "wiimote", 1.43},
         Number{"size_repeats", &Thresholds::size_repeats, "scaat", "dropout-one", "wiimote", 1.15},
         Number{"confirmations", &Thresholds::confirmations, "scaat", "dropout-one", "lamp", 1.07},
         Number{"unassigned_reports", &Thresholds::unassigned_reports, "stereo", "natural-yaw", "lamp", 1.1},
         Number{"other_remote_max", &Thresholds::other_remote_max, "stereo", "natural", "wiimote", 1.07},
         Number{"both_silent", &Thresholds::both_silent, "stereo", "natural", "wiimote", 1.01},
         Number{"scatter", &Thresholds::scatter, "stereo", "static", "accelerometer", 1.05},
         Number{"scatter_min", &Thresholds::scatter_min, "stereo", "moving-remote", "lamp", 1.05},
         Number{"scatter_time", &Thresholds::scatter_time, "stereo", "moving-remote", "lamp", 1.05},
         Number{"resting_for", &Thresholds::resting_for, "stereo", "edges", "accelerometer", 1.06},
         Number{"moving_for", &Thresholds::moving_for, "stereo", "moving-remote", "accelerometer", 1.05},
         Number{"lone_blob_memory", &Thresholds::lone_blob_memory, "stereo", "natural-yaw", "wiimote", 1.05},
         Number{"repetition_learning", &Thresholds::repetition_learning, "scaat", "grid", "wiimote", 1.01},
         Number{"slack_sigmas", &Thresholds::slack_sigmas, "scaat/3", "grid", "wiimote", 1.05},
         Number{"pixel_gate_max", &Thresholds::pixel_gate_max, "scaat", "edges", "lamp", 1.1},
         Number{"pinned", &Thresholds::pinned, "scaat", "swap", "wiimote", 1.01}})),
    [](const auto& number) { return std::string(number.param.name); });

TEST_P(WiiThresholds, HardlyChangeTheErrorAndTheAvailability) {
  const Number& n = GetParam();
  const ValidationRow usual = row(n, 1);
  for (const double factor : {0.5, 2.0}) {
    SCOPED_TRACE(factor);
    const ValidationRow varied = row(n, factor);
    EXPECT_LE(varied.position.rms, n.worse_max * usual.position.rms);
    EXPECT_GE(varied.position.rms, usual.position.rms / n.worse_max) << "the number is not the best one by far";
    EXPECT_GE(varied.availability, usual.availability - 0.02);
    EXPECT_LE(varied.false_validity, usual.false_validity + 0.02);
  }
}

/// A number that keeps out what heads do not do. Doubled or halved it changes nothing; `reached` times it does, in the
/// same scene: the scene asks for it.
struct Guard : Number {
  double reached;
};
class WiiGuards : public ::testing::TestWithParam<Guard> {};
INSTANTIATE_TEST_SUITE_P(
    HalfAndDouble, WiiGuards,
    ::testing::Values(
        Guard{{"spin_max", &Thresholds::spin_max, "scaat/3", "dropout-one", "lamp", 1}, 0.001},
        Guard{{"pair_memory", &Thresholds::pair_memory, "geometric", "natural-yaw", "wiimote", 1}, 0.001},
        Guard{{"unassigned_reports_filter", &Thresholds::unassigned_reports_filter, "scaat", "dropout-one", "lamp", 1},
              0.001},
        Guard{{"start_turn", &Thresholds::start_turn, "three-led", "edges", "lamp", 1}, 100},
        Guard{{"solver_step_max", &Thresholds::solver_step_max, "three-led", "dropout-one", "lamp", 1}, 0.001},
        Guard{{"forward_min", &Thresholds::forward_min, "geometric", "dropout-one", "lamp", 1}, 10},
        Guard{{"shaken", &Thresholds::shaken, "geometric", "dropout-one", "wiimote", 1}, 0.001},
        Guard{{"gravity_gap", &Thresholds::gravity_gap, "geometric", "moving-remote", "lamp", 1}, 0.001},
        Guard{{"direction_min", &Thresholds::direction_min, "geometric", "moving-remote", "lamp", 1}, 10},
        Guard{{"forget_after", &Thresholds::forget_after, "scaat", "dropout-both", "lamp", 1}, 0.001}),
    [](const auto& number) { return std::string(number.param.name); });

TEST_P(WiiGuards, ChangeNothingUntilTheyKeepOutWhatHeadsDo) {
  const ValidationRow usual = row(GetParam(), 1);
  for (const double factor : {0.5, 2.0}) {
    const ValidationRow varied = row(GetParam(), factor);
    EXPECT_NEAR(varied.position.rms, usual.position.rms, 1e-4 * usual.position.rms) << factor;
    EXPECT_EQ(varied.valid, usual.valid) << factor;
  }
  const ValidationRow reached = row(GetParam(), GetParam().reached);
  const bool as_usual = std::abs(reached.position.rms - usual.position.rms) <= 1e-3 * usual.position.rms;
  EXPECT_FALSE(as_usual && reached.valid == usual.valid) << "nothing asks for this number here";
}

/// What is told apart by a size or a cost has one good side only.
struct OneSided : Number {
  double good, bad;  ///< factors; `worse_max` is of the good one
};
class WiiOneSided : public ::testing::TestWithParam<OneSided> {};
INSTANTIATE_TEST_SUITE_P(
    HalfOrDouble, WiiOneSided,
    ::testing::Values(OneSided{{"acquisition_cost_per_led", &Thresholds::acquisition_cost_per_led, "three-led", "edges",
                                "lamp", 1.05},
                               0.5,
                               2},
                      OneSided{
                          {"size_spread", &Thresholds::size_spread, "geometric", "dropout-one", "lamp", 1.05}, 0.7, 2},
                      OneSided{{"size_scale", &Thresholds::size_scale, "geometric", "edges", "lamp", 1.05}, 0.9, 2}),
    [](const auto& number) { return std::string(number.param.name); });

TEST_P(WiiOneSided, TakeALampForAnLedBeyondIt) {
  const double usual = row(GetParam(), 1).position.rms;
  EXPECT_LE(row(GetParam(), GetParam().good).position.rms, GetParam().worse_max * usual);
  EXPECT_GT(row(GetParam(), GetParam().bad).position.rms, 10 * usual);
}

// coast_max: what is valid for 0.1 s without any LED is, doubled, valid for 0.1 s more of each half second.
TEST(WiiThresholdsWithoutLeds, CoastingLongerIsValidForAsMuchLonger) {
  const Number coast{"coast_max", &Thresholds::coast_max, "scaat", "dropout-both", "wiimote", 1};
  const ValidationRow usual = row(coast, 1), shorter = row(coast, 0.5), longer = row(coast, 2);
  EXPECT_LE(shorter.false_validity, usual.false_validity);
  EXPECT_NEAR(longer.false_validity - usual.false_validity, 0.22, 0.05);
  EXPECT_LE(longer.position.rms, 1.2 * usual.position.rms);
}

/// How far a level remote seems tilted [rad] after a second at rest, a shake of `force` to the side for `shaken_for`
/// seconds, and 0.1 s of rest.
double tilt_after_shake(double factor, double Thresholds::*member, double force, double shaken_for) {
  Thresholds thresholds;
  thresholds.*member *= factor;
  GravityFilter filter(0.1, thresholds);
  for (int i = 0; i < 100; ++i) filter.add(0.01, {0, 1, 0});
  for (double t = 0; t < shaken_for; t += 0.01) filter.add(0.01, {force, 1, 0});
  double farthest = std::abs(filter.C_LR()(0, 1));
  for (int i = 0; i < 10; ++i) {
    filter.add(0.01, {0, 1, 0});
    farthest = std::max(farthest, std::abs(filter.C_LR()(0, 1)));
  }
  return farthest;
}

// 1 g to the side makes 1.41 g: left out at 0.3 g and at half of that, but 0.6 g or more off would be seen. 0.7 g makes
// 1.22 g: within 0.3 g of 1, so the remote seems tilted, as it does at 0.6; half of it keeps it level.
TEST(WiiGravityThresholds, ShakenSaysWhichReadingsAreGravity) {
  for (const double factor : {0.5, 1.0}) EXPECT_LE(tilt_after_shake(factor, &Thresholds::shaken, 1, 0.05), 1e-12);
  EXPECT_GT(tilt_after_shake(2, &Thresholds::shaken, 1, 0.05), 0.3);
  EXPECT_LE(tilt_after_shake(0.5, &Thresholds::shaken, 0.7, 0.05), 1e-12);
  for (const double factor : {1.0, 2.0}) EXPECT_GT(tilt_after_shake(factor, &Thresholds::shaken, 0.7, 0.05), 0.2);
}

/// The search for a place, each of its numbers halved and doubled in front of a seated user.
struct SearchNumber {
  const char* name;
  void (*scale)(PlaceSearch&, double factor);
};
class WiiPlaceSearch : public ::testing::TestWithParam<SearchNumber> {};
INSTANTIATE_TEST_SUITE_P(
    HalfAndDouble, WiiPlaceSearch,
    ::testing::ValuesIn(
        test::some_of({SearchNumber{"grid", [](PlaceSearch& s, double f) { s.grid = static_cast<int>(f * s.grid); }},
                       SearchNumber{"finalists",
                                    [](PlaceSearch& s, double f) {
                                      s.finalists = static_cast<std::size_t>(f * static_cast<double>(s.finalists));
                                    }},
                       SearchNumber{"first_turn", [](PlaceSearch& s, double f) { s.first_turn *= f; }},
                       SearchNumber{"step_min", [](PlaceSearch& s, double f) { s.step_min *= f; }},
                       SearchNumber{"angle_min", [](PlaceSearch& s, double f) { s.angle_min *= f; }},
                       SearchNumber{"equal_coverage", [](PlaceSearch& s, double f) { s.equal_coverage *= f; }}},
                      6)),
    [](const auto& number) { return std::string(number.param.name); });

PlaceOptions in_front_of_a_screen() {
  PlaceOptions options;
  options.heads = modelled_heads({0, 1.2, 1}, {0, 1.2, 0}, {0.15, 0.05, 0.1}, 200, 1);
  options.room_min = {-0.6, 0.7, -0.3};
  options.room_max = {0.6, 1.7, 0.1};
  return options;
}

TEST_P(WiiPlaceSearch, HardlyChangesWhatThePlaceIsWorth) {
  static const Placement usual = good_places(in_front_of_a_screen()).front();
  for (const double factor : test::some_of({0.5, 2.0})) {
    PlaceOptions options = in_front_of_a_screen();
    GetParam().scale(options.search, factor);
    const Placement place = good_places(options).front();
    EXPECT_NEAR(place.covered, usual.covered, 0.005) << factor;
    EXPECT_NEAR(place.error, usual.error, 0.05 * usual.error) << factor;
  }
}

}  // namespace
}  // namespace verisim::wii::wii_thresholds_test

// How much the trackers' errors hang on the heuristic numbers of thresholds.hpp: each is halved and doubled, alone,
// where it speaks. "Worse" is the rms error of the position against that with the numbers as they are.
#include <gtest/gtest.h>

#include "engine/wii/validate.hpp"

namespace verisim::wii::wii_thresholds_test {
namespace {

struct Number {
  const char* name;
  double Thresholds::*member;
  const char* tracker;
  const char* trajectory;
  const char* sensor;
  double worse_max;  ///< times the usual error
};

ValidationRow row(const Number& n, double factor) {
  ValidationOptions options;
  options.tracker.thresholds.*n.member *= factor;
  options.measure_time = false;
  return validate_one(n.tracker, trajectory(n.trajectory), sensor_case(n.sensor), options);
}

// What a tracker does with a head of three LEDs of which one is dark hangs on its numbers: by up to a half. All else
// does by less than a twentieth, most of it not at all.
class WiiThresholds : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(
    HalfAndDouble, WiiThresholds,
    ::testing::Values(
        Number{"linear_density", &Thresholds::linear_density, "scaat/3", "natural-yaw", "wiimote", 1.05},
        Number{"angular_density", &Thresholds::angular_density, "scaat/3", "natural-yaw", "wiimote", 1.05},
        Number{"guessed_density", &Thresholds::guessed_density, "scaat/3", "dropout-one", "wiimote", 1.2},
        Number{"unseen_density", &Thresholds::unseen_density, "scaat", "dropout-both", "wiimote", 1.05},
        Number{"decay", &Thresholds::decay, "scaat", "dropout-one", "wiimote", 1.05},
        Number{"pair_decay", &Thresholds::pair_decay, "scaat/3", "dropout-one", "wiimote", 1.55},
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
        Number{"turn_rate", &Thresholds::turn_rate, "three-led", "dropout-one", "wiimote", 1.5},
        Number{"still_known", &Thresholds::still_known, "three-led", "dropout-one", "wiimote", 1.15}),
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

}  // namespace
}  // namespace verisim::wii::wii_thresholds_test

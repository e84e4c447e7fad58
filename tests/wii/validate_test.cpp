// The validation itself: its figures on made-up errors, its table, its names.
#include "engine/wii/validate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/wii/validation_figures.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii {
namespace {

// A tracker that is always 1 cm off along x and claims 1 cm: rms 1 cm, NEES 1/3 per degree of freedom.
TEST(ValidationFigures, AreThoseOfAConstantError) {
  ValidationFigures figures;
  for (int k = 0; k < 100; ++k) {
    SensedReport truth;
    truth.t = 0.01 * k;
    truth.led_in_view = 3;
    truth.X_LH.position = {0, 0, 1};
    Report report;
    report.valid = k >= 10;
    report.pose.position = {0.01, 0, 1};
    report.covariance = 1e-4 * Matrix6d::Identity();
    figures.add(truth, report);
  }
  const ValidationRow row = figures.result();
  EXPECT_NEAR(row.position.rms, 0.01, 1e-15);
  EXPECT_NEAR(row.position.rms_axis.x(), 0.01, 1e-15);
  EXPECT_NEAR(row.nees, 1.0 / 3, 1e-12);
  EXPECT_NEAR(row.availability, 0.9, 1e-12);
  EXPECT_NEAR(row.longest_return, 0.1, 1e-12);
  EXPECT_EQ(row.within_95, 1);
}

// A report that is right about 20 ms ago trails by 20 ms.
TEST(ValidationFigures, MeasureLatency) {
  ValidationFigures figures;
  for (int k = 0; k < 1000; ++k) {
    const auto z = [](double t) { return 1 + 0.3 * std::sin(2 * t); };
    SensedReport truth;
    truth.t = 0.01 * k;
    truth.X_LH.position = {0, 0, z(truth.t)};
    Report report;
    report.valid = true;
    report.pose.position = {0, 0, z(truth.t - 0.02)};
    report.covariance = Matrix6d::Identity();
    figures.add(truth, report);
  }
  EXPECT_NEAR(figures.result().latency, 0.02, 0.001);
}

TEST(Validate, GivesARowForEveryCombinationAndTheSameOneTwice) {
  ValidationOptions options;
  options.trajectories = {"static", "tilted"};
  options.sensors = {"wiimote"};
  options.measure_time = false;
  const std::vector<ValidationRow> rows = validate(options);
  EXPECT_EQ(rows.size(), 2 * (tracker_names().size() + 1));
  EXPECT_EQ(csv_of(rows), csv_of(validate(options)));
  for (const std::string& name : tracker_names()) EXPECT_NE(table_of(rows).find(name), std::string::npos);
}

TEST(Validate, RefusesUnknownNames) {
  EXPECT_THROW((void)row_of("geometric", "statik"), Error);
  EXPECT_THROW((void)row_of("geometri", "static"), Error);
  EXPECT_THROW((void)row_of("geometric", "static", "idael"), Error);
}

}  // namespace
}  // namespace verisim::wii

// The validation itself: its figures on made-up errors, its table, its names.
#include "engine/wii/validate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/wii/validation_figures.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii::validate_test {
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
    report.pose.rotation = rotation_from_vector({0, 0.03, 0});
    report.covariance = 1e-4 * Matrix6d::Identity();
    figures.add(truth, report);
  }
  const ValidationRow row = figures.result();
  EXPECT_NEAR(row.position.rms, 0.01, 1e-15);
  EXPECT_NEAR(row.position.rms_axis.x(), 0.01, 1e-15);
  EXPECT_NEAR(row.nees, 1.0 / 3, 1e-12);
  EXPECT_NEAR(row.orientation_nees, 0.03 * 0.03 / 1e-4 / 3, 1e-9);  // 0.03 rad, claimed to be 0.01
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

// A quarter of the way between two samples, and held beyond the last.
TEST(RecordedTrajectory, InterpolatesBetweenItsSamples) {
  const Pose last{{0.4, 0, 1}, rotation_from_vector({0, 0, 0.8})};
  const Trajectory path = recorded_trajectory("nod", {5, 7}, {Pose{{0, 0, 1}, Quaterniond::Identity()}, last});
  EXPECT_EQ(path.duration, 2);
  const Pose quarter = path.at(0.5).X_WH;
  EXPECT_NEAR(quarter.position.x(), 0.1, 1e-15);
  EXPECT_NEAR(vector_from_rotation(quarter.rotation).z(), 0.2, 1e-15);
  EXPECT_EQ(path.at(9).X_WH.position, last.position);
  EXPECT_EQ(path.at(-1).X_WH.position.x(), 0);
}

TEST(RecordedTrajectory, RefusesTooLittleAndTimeThatDoesNotGrow) {
  EXPECT_THROW((void)recorded_trajectory("nod", {5}, {Pose()}), Error);
  EXPECT_THROW((void)recorded_trajectory("nod", {5, 5}, {Pose(), Pose()}), Error);
}

// A mean of squares that is far below one is said to be so, and one far above too: n = 3 x 1000 independent samples.
TEST(ValidationFigures, KnowBothBoundsOfConsistency) {
  ValidationFigures careful;
  const RandomStream random(1, "errors");
  Report report;
  report.valid = true;
  report.covariance = Matrix6d::Identity() * 1e-4;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    SensedReport truth;
    truth.t = 0.01 * static_cast<double>(k);
    truth.led_in_view = 3;
    report.pose.position = 0.001 * Vector3d(random.normal(3 * k), random.normal(3 * k + 1), random.normal(3 * k + 2));
    careful.add(truth, report);
  }
  const ValidationRow row = careful.result();
  EXPECT_NEAR(row.nees, 0.01, 0.001);
  EXPECT_NEAR(row.nees_lower, 0.95, 0.02);  // 1 - 1.96 sqrt(2 / 3000)
  EXPECT_NEAR(row.nees_upper, 1.05, 0.02);
}

TEST(Validate, RefusesUnknownNames) {
  EXPECT_THROW((void)row_of("geometric", "statik"), Error);
  EXPECT_THROW((void)row_of("geometri", "static"), Error);
  EXPECT_THROW((void)row_of("geometric", "static", "idael"), Error);
}

}  // namespace
}  // namespace verisim::wii::validate_test

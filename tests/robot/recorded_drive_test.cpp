// Recorded ticks of another mecanum robot through odometry and speed estimation, against motion capture: the recordings
// of
// ../shared/data/traces/mecanum_omni4, whose README states the fitted geometry and the end errors that are expected
// here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/record/trace.hpp"
#include "engine/robot/odometry.hpp"
#include "tests/record/small_run.hpp"
#include "tests/support/paths.hpp"

namespace verisim::robot::recorded_drive_test {
namespace {

constexpr double kTicks = 11520;  // per wheel turn (README of the recording)

struct Recording {
  const char* file;
  double end_error;  ///< with the fitted geometry, as the README states it [m]
};
const Recording kRecordings[] = {
    {"circular_080920201015/080920201015_run-01", 0.155}, {"circular_080920201015/080920201015_run-04", 0.155},
    {"circular_080920201015/080920201015_run-10", 0.214}, {"square_080920201205/080920201205_run-01", 0.012},
    {"square_080920201205/080920201205_run-02", 0.003},   {"square_080920201205/080920201205_run-03", 0.038}};

/// Wheel turns per dx, dy [m], dtheta [rad], as fitted by the README. Its wheels 1 to 4 are FL, FR, RL, RR, the right
/// ones mounted the other way around.
CountsPerDisplacement fitted() {
  CountsPerDisplacement turns;
  turns << 4.806, -4.986, -0.994, -4.751, -5.021, -0.993, 4.783, 5.002, -1.001, -4.772, 4.963, -1.001;
  return turns * kTicks;
}

Trace converted(const std::string& content) {
  ConvertOptions options{.kind = "encoder", .time_column = "1", .cumulative = true};
  for (const char* map : {"e0=5*11520", "e1=6*11520", "e2=7*11520", "e3=8*11520", "x=2", "y=3", "theta=4"})
    options.mappings.push_back(parse_mapping(map));
  return convert_csv("recording.csv", content, options);
}

Counts counts_at(const Trace& trace, std::size_t row) {
  Counts counts;
  for (std::size_t i = 0; i < kWheels; ++i) counts[i] = std::llround(trace.at(row, 1 + i));
  return counts;
}

PlanarPose truth_at(const Trace& trace, std::size_t row) {
  const auto column = [&](const char* name) { return trace.at(row, static_cast<std::size_t>(trace.column(name))); };
  return {column("x"), column("y"), column("theta")};
}

/// Motion from one pose to another, in the coordinates of the first.
PlanarTwist between(const PlanarPose& a, const PlanarPose& b) {
  const double c = std::cos(a.theta), s = std::sin(a.theta);
  return {c * (b.x - a.x) + s * (b.y - a.y), c * (b.y - a.y) - s * (b.x - a.x), b.theta - a.theta};
}

std::string shared(const char* file) {
  return small_run::content_of(paths::in_shared_data("traces/mecanum_omni4/") + file + ".csv");
}

#define SKIP_WITHOUT(content)                                                          \
  if ((content).empty())                                                               \
  GTEST_SKIP() << "no recordings in " << paths::in_shared_data("traces/mecanum_omni4") \
               << ": their drives were not replayed"

TEST(RecordedDrive, EndsWhereTheFittedGeometrySays) {
  for (const auto& [file, end_error] : kRecordings) {
    SCOPED_TRACE(file);
    const std::string content = shared(file);
    SKIP_WITHOUT(content);
    const Trace trace = converted(content);
    Odometry odometry(WheelMap(fitted()), truth_at(trace, 0), counts_at(trace, 0));
    for (std::size_t row = 1; row < trace.rows(); ++row) odometry.advance(counts_at(trace, row));
    const PlanarPose end = odometry.pose(), truth = truth_at(trace, trace.rows() - 1);
    const double error = std::hypot(end.x - truth.x, end.y - truth.y);
    std::printf("%s: %.4f m, %.4f rad; README %.3f m\n", file, error, end.theta - truth.theta, end_error);
    // The README's coefficients have 3 decimals: half of the last turns by 5e-4 * 13 rad, which moves an end by 1 mm.
    EXPECT_NEAR(error, end_error, 0.01 * end_error + 1e-3);
  }
}

TEST(RecordedDrive, HasTheSpeedsOfMotionCapture) {
  for (const auto& recording : kRecordings) {
    SCOPED_TRACE(recording.file);
    const std::string content = shared(recording.file);
    SKIP_WITHOUT(content);
    const Trace trace = converted(content);
    const WheelMap map(fitted());
    constexpr std::size_t kWindow = 50;  // 0.5 s: motion capture is noisy (README)
    CountRate rate(0.01, 0.5);
    double squares = 0, turn_squares = 0, fastest = 0, fastest_turn = 0;
    for (std::size_t row = 0; row < trace.rows(); ++row) {
      const PlanarTwist speed = map.displacement(rate.advance(counts_at(trace, row)));
      if (row < kWindow) continue;
      const PlanarTwist way = between(truth_at(trace, row - kWindow), truth_at(trace, row));
      const PlanarPose arc = moved({}, {speed.vx * 0.5, speed.vy * 0.5, speed.omega * 0.5});
      squares += (std::pow(arc.x - way.vx, 2) + std::pow(arc.y - way.vy, 2)) / 0.25;
      turn_squares += std::pow(arc.theta - way.omega, 2) / 0.25;
      fastest = std::max(fastest, std::hypot(speed.vx, speed.vy));
      fastest_turn = std::max(fastest_turn, std::abs(speed.omega));
    }
    const auto windows = static_cast<double>(trace.rows() - kWindow);
    std::printf("%s: %.2f mm/s rms, %.2f mrad/s rms, up to %.0f mm/s, %.0f mrad/s\n", recording.file,
                std::sqrt(squares / windows) * 1e3, std::sqrt(turn_squares / windows) * 1e3, fastest * 1e3,
                fastest_turn * 1e3);
    EXPECT_GT(fastest, 0.04);
    // Motion capture's noise (0.4 mm, 3 mrad; README) over 0.5 s, and some 5 % of the drive's fastest: the geometry is
    // one fit to all drives, and in corners wheels slip.
    EXPECT_LT(std::sqrt(squares / windows), std::sqrt(2.0) * 0.4e-3 / 0.5 + 0.055 * fastest);
    EXPECT_LT(std::sqrt(turn_squares / windows), std::sqrt(2.0) * 3e-3 / 0.5 + 0.05 * fastest_turn);
  }
}

// In the recorder's order the right wheels count backwards; as FL, FR, RL, RR their residual tells whether they
// slipped.
TEST(RecordedDrive, DidNotSlip) {
  for (const auto& recording : kRecordings) {
    SCOPED_TRACE(recording.file);
    const std::string content = shared(recording.file);
    SKIP_WITHOUT(content);
    const Trace trace = converted(content);
    SlipDetector detector({}, kTicks, 0.01);
    double largest = 0;
    for (std::size_t row = 0; row < trace.rows(); ++row) {
      const Counts c = counts_at(trace, row);
      EXPECT_FALSE(detector.advance({c[0], -c[1], c[2], -c[3]})) << row;
      largest = std::max(largest, std::abs(detector.residual()));
    }
    std::printf("%s: residual up to %.3f rad/s\n", recording.file, largest);
  }
}

}  // namespace
}  // namespace verisim::robot::recorded_drive_test

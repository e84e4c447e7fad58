// A user's own set-up: glasses, remote and imperfections reach the virtual remote and the trackers, and nothing else.
#include "engine/wii/set_up.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/wii/sensed_run.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::wii::set_up_test {
namespace {

using Given = wii::SetUp;  // a test class has a SetUp of its own

std::vector<Sensed> sensed(const Given& set_up, const Trajectory& path) {
  const LedLayout leds = set_up.leds.value_or(LedLayout());
  return sense_run(remote_settings(RemoteSettings(), path, leds, set_up), placed(path, set_up), 1, 1,
                   set_up.latency.value_or(0));
}

/// Where a point of the head is seen, from the truth alone. An ideal pinhole, ORACLES section 2.
Eigen::Vector2d seen_at(const Pose& X_RH, const Vector3d& p_H, const FieldOfView& fov) {
  const Vector3d p = X_RH * p_H;
  return {512 + 512 / std::tan(fov.horizontal / 2) * p.x() / p.z(),
          384 + 384 / std::tan(fov.vertical / 2) * p.y() / p.z()};
}

TEST(SetUps, GlassesAndFieldOfViewAreSeen) {
  Given set_up;
  set_up.leds = LedLayout();
  set_up.leds->p_H = {Vector3d(0.06, 0.01, 0.02), Vector3d(-0.05, 0, 0), Vector3d(0, 0.05, -0.03), Vector3d::Zero()};
  set_up.leds->count = 3;
  set_up.fov = FieldOfView{33 * kDegree, 23 * kDegree};
  for (const Sensed& s : sensed(set_up, trajectory("static")))
    for (int led = 0; led < 3; ++led) {
      const auto slot = static_cast<std::size_t>(4 + 3 * led);
      const Eigen::Vector2d pixel =
          seen_at(s.report.X_LH, set_up.leds->p_H[static_cast<std::size_t>(led)], *set_up.fov);
      EXPECT_NEAR(s.report.channels[slot], pixel.x(), 0.5001);
      EXPECT_NEAR(s.report.channels[slot + 1], pixel.y(), 0.5001);
    }
}

// The remote stands elsewhere: a trajectory's head stays where it is in the room, a recorded one goes with the remote.
TEST(SetUps, TheRemoteIsPutElsewhere) {
  Given set_up;
  set_up.X_WR = Pose{{0.2, -0.1, 0.1}, rotation_from_vector({0, 0.1, 0}) * rotation_from_vector({-0.2, 0, 0})};
  const Trajectory path = trajectory("natural");
  const Situation was = path.at(3);
  const Situation is = placed(path, set_up).at(3);
  EXPECT_EQ(is.X_WH.position, was.X_WH.position);
  EXPECT_EQ(is.X_WR.position, set_up.X_WR->position);

  std::vector<double> t = {0, 1, 2};
  std::vector<Pose> X_LH = {{{0.1, 0.2, 1}, rotation_from_vector({0.1, 0.2, 0})},
                            {{0.2, 0.1, 1.2}, rotation_from_vector({0, 0.3, 0.1})},
                            {{0, 0, 1.5}, Quaterniond::Identity()}};
  const Trajectory recorded = placed(recorded_trajectory("head", t, X_LH), set_up);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Pose there = levelled_pose(recorded.at(t[i]));
    EXPECT_LT((there.position - X_LH[i].position).norm(), 1e-12);
    EXPECT_LT(vector_from_rotation(there.rotation * X_LH[i].rotation.conjugate()).norm(), 1e-12);
  }
  EXPECT_THROW((void)placed(trajectory("moving-remote"), set_up), Error);
}

TEST(SetUps, LatencyShowsTheSensorAnEarlierMoment) {
  Given late;
  late.latency = 0.05;
  const std::vector<Sensed> a = sensed(Given(), trajectory("sweep-x"));
  const std::vector<Sensed> b = sensed(late, trajectory("sweep-x"));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 5; k < a.size(); ++k) {
    EXPECT_EQ(b[k].report.channels[4], a[k - 5].report.channels[4]);
    EXPECT_EQ(b[k].report.X_LH.position, a[k].report.X_LH.position);
  }
}

TEST(SetUps, NoiseRateAndStepsReachTheRemote) {
  Given set_up;
  set_up.rate = 50;
  set_up.accelerometer_bits = 8;
  const std::vector<Sensed> coarse = sensed(set_up, trajectory("tilted"));
  EXPECT_EQ(coarse.size(), 500U);
  for (const Sensed& s : coarse)
    for (int axis = 1; axis <= 3; ++axis) {
      const double counts = 26 * s.report.channels[static_cast<std::size_t>(axis)];
      EXPECT_NEAR(counts, std::round(counts), 1e-9);
    }
  Given noisy;
  noisy.pixel_noise = 3;
  noisy.accelerometer_noise = 0.02;
  double squares = 0;
  double up_squares = 0;
  const std::vector<Sensed> run = sensed(noisy, trajectory("static"));
  for (const Sensed& s : run) {
    const double off = s.report.channels[4] - (512 + 512 / std::tan(21.5 * kDegree) * 0.075);
    squares += off * off;
    up_squares += s.report.channels[1] * s.report.channels[1];
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(run.size())), 3, 0.4);
  EXPECT_NEAR(std::sqrt(up_squares / static_cast<double>(run.size())), 0.02, 0.002);
}

TEST(SetUps, WhatIsGivenFirstCounts) {
  Given user;
  user.rate = 60;
  Given recording;
  recording.rate = 90;
  recording.fov = FieldOfView{33 * kDegree, 23 * kDegree};
  const Given both = first_of(user, recording);
  EXPECT_EQ(*both.rate, 60);
  EXPECT_EQ(both.fov->horizontal, 33 * kDegree);
  EXPECT_FALSE(both.leds.has_value());
}

// Several seeds: the mean of their rows, an interval about it, the greatest of the greatest.
TEST(Seeds, GiveTheMeanAndItsInterval) {
  ValidationOptions options;
  options.trackers = {"geometric"};
  options.trajectories = {"natural"};
  options.sensors = {"noisy"};
  options.measure_time = false;
  std::vector<double> rms;
  double largest = 0;
  for (std::uint64_t seed = 7; seed < 12; ++seed) {
    options.seed = seed;
    const ValidationRow one = validate(options).front();
    rms.push_back(one.position.rms);
    largest = std::max(largest, one.position.max);
  }
  options.seed = 7;
  options.seeds = 5;
  const ValidationRow row = validate(options).front();
  double mean = 0;
  for (const double r : rms) mean += r / 5;
  double variance = 0;
  for (const double r : rms) variance += (r - mean) * (r - mean) / 4;
  EXPECT_NEAR(row.position.rms, mean, 1e-15);
  EXPECT_EQ(row.position.max, largest);
  EXPECT_EQ(row.seeds, 5);
  const double half = 2.7764 * std::sqrt(variance / 5);  // Student's t, 97.5 %, 4 degrees of freedom
  EXPECT_NEAR(row.position_rms_95.first, mean - half, 0.01 * half);
  EXPECT_NEAR(row.position_rms_95.second, mean + half, 0.01 * half);
}

}  // namespace
}  // namespace verisim::wii::set_up_test

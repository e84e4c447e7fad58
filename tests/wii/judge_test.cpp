// Judging a tracker of the user's own: the row of the validation where times agree, and what is done where they do not.
#include "engine/wii/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/wii/sensed_run.hpp"
#include "tests/support/broken.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii::judge_test {
namespace {

struct Case {
  std::vector<SensedReport> samples;
  std::vector<Report> reports;
};

/// As validate_one runs it: two LEDs, one remote, seed 1.
Case run_of(const std::string& tracker, const std::string& path, const std::string& sensor) {
  const RemoteSettings settings =
      remote_settings(sensor_case(sensor).settings, trajectory(path), LedLayout(), wii::SetUp());
  const std::unique_ptr<Tracker> judged = make_tracker(tracker, TrackerSettings());
  Case run;
  for (const Sensed& s : sense_run(settings, trajectory(path), 1, 1, 0)) {
    run.samples.push_back(s.report);
    run.reports.push_back(judged->update(s.report.t, s.report.channels));
  }
  return run;
}

double position_at(double t) {
  return 0.2 * std::sin(1.7 * t) + 0.05 * std::sin(5.1 * t + 1);
}

/// Three axes of motion at 100 Hz for 10 s, and a tracker that saw each moment `late` seconds before its stamp.
Case moving(double late, double rate = 100) {
  Case run;
  const auto pose = [](double t) {
    return Pose{{position_at(t), 0.5 * position_at(1.3 * t + 2), 1 + position_at(0.7 * t + 1)},
                rotation_from_vector({0, 0.3 * std::sin(t), 0.1})};
  };
  for (int k = 0; k < 1000; ++k) {
    SensedReport s;
    s.t = 0.01 * k;
    s.X_LH = pose(s.t);
    s.led_in_view = 3;
    run.samples.push_back(s);
  }
  for (int k = 0; k / rate < 9.9901; ++k) {
    Report r;
    r.t = k / rate;
    r.valid = true;
    r.pose = pose(r.t - late);
    r.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    run.reports.push_back(r);
  }
  return run;
}

TEST(Judge, GivesTheValidationsOwnRowWhereTimesAgree) {
  for (const char* tracker : {"geometric", "scaat", "vrpn-compatible"})
    for (const char* path : {"natural", "edges", "dropout-both", "tilted"}) {
      SCOPED_TRACE(fmt::format("{} {}", tracker, path));
      const Case run = run_of(tracker, path, "wiimote");
      const ValidationRow judged = judge(run.samples, run.reports, {}).row;
      const ValidationRow row = row_of(tracker, path, "wiimote");
      EXPECT_EQ(judged.reports, row.reports);
      EXPECT_EQ(judged.valid, row.valid);
      EXPECT_EQ(judged.position.rms, row.position.rms);
      EXPECT_EQ(judged.position.max, row.position.max);
      EXPECT_EQ(judged.orientation.rms, row.orientation.rms);
      EXPECT_EQ(judged.availability, row.availability);
      EXPECT_EQ(judged.false_validity, row.false_validity);
      EXPECT_EQ(judged.latency, row.latency);
      EXPECT_EQ(judged.nees, row.nees);
      EXPECT_EQ(judged.orientation_nees, row.orientation_nees);
      EXPECT_EQ(judged.reacquired, row.reacquired);
    }
}

TEST(Judge, WithoutACovarianceSaysNothingOfConsistency) {
  const Case run = moving(0);
  const Judgement j = judge(run.samples, run.reports, {});
  EXPECT_LT(j.row.position.max, 1e-12);
  EXPECT_TRUE(std::isnan(j.row.nees));
  EXPECT_TRUE(std::isnan(j.row.orientation_nees));
  EXPECT_TRUE(std::isnan(j.row.within_95));
}

// Whether a tracker trails or its clock is another: the offset that fits best is told, and added only on request.
TEST(Judge, FindsTheTimeOffset) {
  for (const double late : {-0.113, -0.02, 0.0, 0.0347, 0.4}) {
    const Case run = moving(late);
    JudgeOptions options;
    const Judgement as_it_is = judge(run.samples, run.reports, options);
    EXPECT_EQ(as_it_is.offset, 0);
    ASSERT_TRUE(as_it_is.offset_better.has_value());
    EXPECT_NEAR(*as_it_is.offset_better, -late, 1e-4) << late;
    options.time_offset.kind = TimeOffset::Kind::found;
    const Judgement found = judge(run.samples, run.reports, options);
    EXPECT_NEAR(found.offset, -late, 1e-4) << late;
    EXPECT_LT(found.row.position.rms, 2e-4);  // truth is interpolated
    if (std::abs(late) > 0.01) {
      EXPECT_GT(as_it_is.row.position.rms, 10 * found.row.position.rms);
    }
  }
}

TEST(Judge, PutsAnotherClocksTimesOntoTheSamples) {
  Case run = moving(0);
  for (Report& r : run.reports) r.t += 1.6e9;
  JudgeOptions options;
  EXPECT_THROW((void)judge(run.samples, run.reports, options), Error);
  options.time_offset.kind = TimeOffset::Kind::start;
  EXPECT_LT(judge(run.samples, run.reports, options).row.position.rms, 1e-6);
  options.time_offset = {TimeOffset::Kind::given, -1.6e9};
  EXPECT_LT(judge(run.samples, run.reports, options).row.position.rms, 1e-6);
}

TEST(Judge, AlignsByYawOrAnyTurnAndTurnsTheCovarianceToo) {
  const Pose X_ET = {{0.3, -0.2, 1.5}, rotation_from_vector({0, 2.1, 0})};
  const Pose X_any = {{-1, 0.4, 0.2}, rotation_from_vector({0.4, -1.2, 2})};
  for (const auto& [alignment, X] : {std::pair(Alignment::yaw, X_ET), std::pair(Alignment::se3, X_any)}) {
    Case run = moving(0);
    for (Report& r : run.reports) {
      r.pose.position += Vector3d(0.01, 0, 0) * std::sin(40 * r.t);
      r.covariance = Matrix6d::Identity() * 1e-6;
      r.covariance(0, 0) = 1e-4 / 2;  // as large as that error along x, and no other axis
    }
    const Judgement plain = judge(run.samples, run.reports, {});
    for (Report& r : run.reports) {
      r.pose = {X * r.pose.position, (X.rotation * r.pose.rotation).normalized()};
      Matrix6d turn = Matrix6d::Zero();
      turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = X.rotation.toRotationMatrix();
      r.covariance = turn * r.covariance * turn.transpose();
    }
    JudgeOptions options;
    options.alignment = alignment;
    const Judgement j = judge(run.samples, run.reports, options);
    EXPECT_NEAR(j.row.position.rms, plain.row.position.rms, 1e-5);
    EXPECT_LT(j.row.orientation.max, 0.2);
    EXPECT_NEAR(j.row.nees, plain.row.nees, 0.05 * plain.row.nees);
    EXPECT_LT((j.X_TE.position - X.inverse().position).norm(), 1e-2);
  }
}

TEST(Judge, RefusesToAlignAHeadThatHardlyMoves) {
  Case run = moving(0);
  for (SensedReport& s : run.samples) s.X_LH = Pose{{0, 0, 1}, Quaterniond::Identity()};
  for (Report& r : run.reports) r.pose = Pose{{0, 0, 1}, Quaterniond::Identity()};
  JudgeOptions options;
  EXPECT_FALSE(judge(run.samples, run.reports, options).offset_better.has_value());
  for (const Alignment alignment : {Alignment::yaw, Alignment::se3}) {
    options.alignment = alignment;
    EXPECT_THROW((void)judge(run.samples, run.reports, options), Error);
  }
}

// A tracker of another rate is judged at its own times; a slow one leaves no sample unanswered, a silent one does.
TEST(Judge, TakesTrackersOfAnyRate) {
  for (const double rate : {30.0, 60.0, 250.0}) {
    const Case run = moving(0, rate);
    const Judgement j = judge(run.samples, run.reports, {});
    EXPECT_LE(j.unanswered, 1) << rate;  // the last sample, after the last report
    EXPECT_EQ(j.row.reports, static_cast<int>(run.reports.size()) + j.unanswered);
    EXPECT_GT(j.row.availability, 0.996);
    EXPECT_LT(j.row.position.max, 1e-3);
  }
  Case run = moving(0);
  std::erase_if(run.reports, [](const Report& r) { return r.t > 3.995 && r.t < 5.995; });
  const Judgement j = judge(run.samples, run.reports, {});
  EXPECT_EQ(j.unanswered, 200);
  EXPECT_NEAR(j.row.availability, 0.8, 0.002);
}

TEST(Judge, SaysWhichReportsStandBesideNoSample) {
  Case run = moving(0);
  run.samples.erase(run.samples.begin() + 300, run.samples.begin() + 350);  // half a second without truth
  run.samples.erase(run.samples.begin(), run.samples.begin() + 10);
  const Judgement j = judge(run.samples, run.reports, {});
  EXPECT_EQ(j.outside, 60);
  EXPECT_EQ(j.row.reports, 940);
}

TEST(Judge, RefusesWhatItCannotJudge) {
  const Case run = moving(0);
  EXPECT_THROW((void)judge({}, run.reports, {}), Error);
  EXPECT_THROW((void)judge(run.samples, {}, {}), Error);
  std::vector<Report> back = run.reports;
  std::swap(back[5], back[6]);
  EXPECT_THROW((void)judge(run.samples, back, {}), Error);
  std::vector<Report> none = run.reports;
  for (Report& r : none) r.valid = false;
  EXPECT_THROW((void)judge(run.samples, none, {}), Error);
}

}  // namespace
}  // namespace verisim::wii::judge_test

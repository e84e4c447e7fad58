// The doors of engine/wii. Trackers survive any channels (bad_input_test); here is what only the program itself could
// get wrong, and what users can and are refused.
#include <gtest/gtest.h>

#include <limits>

#include "engine/wii/acquisition.hpp"
#include "engine/wii/admission.hpp"
#include "engine/wii/coverage.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/head.hpp"
#include "engine/wii/head_filter.hpp"
#include "engine/wii/place.hpp"
#include "engine/wii/trajectories.hpp"
#include "engine/wii/two_led_covariance.hpp"
#include "tests/support/broken.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::wii::wii_contracts_test {
namespace {

using test::expect_refused;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Pose kStretched{{0, 0, 1}, Quaterniond(2, 0, 0, 0)};
const FieldOfView kNoView{0, 1};

Reading two_blobs() {
  Reading reading;
  reading.blobs[0] = {609, 384, 4};
  reading.blobs[1] = {415, 384, 4};
  reading.blob_count = 2;
  return reading;
}

TEST(PinholeDeathTest, SeesWhatIsBeforeIt) {
  EXPECT_BROKEN(Pinhole{kNoView}, "is_field_of_view(fov)");
  EXPECT_BROKEN((Pinhole{{pinned::kPi, 1}}), "is_field_of_view(fov)");
  const Pinhole pinhole{FieldOfView()};
  EXPECT_BROKEN(pinhole.project({0, 0, 0}), "p_R.z() > 0");
}

TEST(GravityDeathTest, HasADirection) {
  EXPECT_BROKEN(levelling({0, kNaN, 0}), "is_finite(up_R)");
  EXPECT_BROKEN(levelling({0, 0, 0}), "!up_R.isZero(0)");
  EXPECT_BROKEN(GravityFilter(0), "is_positive(time_constant)");
  GravityFilter filter(0.1);
  EXPECT_BROKEN(filter.C_LR(), "known_");
  EXPECT_BROKEN(filter.add(-1, {0, 1, 0}), "is_not_negative(dt)");
  EXPECT_BROKEN(filter.add(0, {0, kInfinity, 0}), "is_finite(force_R)");
  EXPECT_BROKEN(filter.add(0, {0, 0, 0}), "!force_R.isZero(0)");
}

TEST(TwoPointsDeathTest, AreTwoRaysToTwoLeds) {
  const Matrix3d level = Matrix3d::Identity();
  const Vector3d ahead = Vector3d::UnitZ();
  EXPECT_BROKEN(solve_two_points({}, 2 * ahead, ahead, level), "ray0_R.z() == 1");
  EXPECT_BROKEN(solve_two_points({}, ahead, 2 * ahead, level), "ray1_R.z() == 1");
  EXPECT_BROKEN(solve_two_points({{0, 0, 0}, {0, 0, 1}}, ahead, ahead, level),
                "!(leds.p0_H - leds.p1_H).head<2>().isZero(0)");
  EXPECT_BROKEN(rotation_about_z(1, 0.1),
                "std::abs(cos_angle * cos_angle + sin_angle * sin_angle - 1) < kUnitTolerance");
  const Vector3d nowhere(0, 0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_BROKEN(two_led_covariance({}, Pinhole{FieldOfView()}, nowhere, 1, 0), "is_finite(p_L)");
}

TEST(AssignmentDeathTest, NamesBlobsOfItsReading) {
  const Reading reading = two_blobs();
  const std::array<Eigen::Vector2d, kLedsMax + 1> five = {};
  EXPECT_BROKEN(nearest_assignment(reading, five, 10), "expected.size() <= kLedsMax");
  EXPECT_BROKEN(nearest_assignment(reading, std::span(five).first(2), kNaN), "is_not_negative(gate)");
  const Pinhole pinhole{FieldOfView()};
  LedLayout leds;
  leds.count = 1;
  EXPECT_BROKEN(PairFollower(leds, pinhole), "leds.count >= 2");
  leds.count = kLedsMax + 1;
  EXPECT_BROKEN(PairFollower(leds, pinhole), "leds.count <= kLedsMax");
  PairFollower follower(LedLayout(), pinhole);
  PairFollower::Match match;
  EXPECT_BROKEN(follower.follow(0, reading, match), "std::min(match.blob[0], match.blob[1]) >= 0");
  match.blob = {0, 2};
  EXPECT_BROKEN(follower.follow(0, reading, match), "std::max(match.blob[0], match.blob[1]) < reading.blob_count");
  match.blob = {0, 1};
  EXPECT_BROKEN(follower.follow(kInfinity, reading, match), "std::isfinite(t)");
  std::array<Sighting, 1> one;
  EXPECT_BROKEN(sightings_of(reading, LedLayout(), {0, 1, -1, -1}, 0, one),
                "sightings.size() >= static_cast<std::size_t>(leds.count)");
  std::array<Sighting, kLedsMax> four;
  EXPECT_BROKEN(sightings_of(reading, LedLayout(), {0, 3, -1, -1}, 0, four), "assignment[led] < reading.blob_count");
}

TEST(PoseSolverDeathTest, FitsSightingsOfTwoRemotes) {
  TrackerSettings settings;
  settings.pixel_sigma = 0;
  EXPECT_BROKEN(PoseSolver{settings}, "is_positive(settings.pixel_sigma)");
  settings = {};
  settings.X_R1R2 = kStretched;
  EXPECT_BROKEN(PoseSolver{settings}, "!settings.X_R1R2 || is_placement(*settings.X_R1R2)");
  const PoseSolver solver{TrackerSettings()};
  Eigen::Vector2d pixel;
  EXPECT_BROKEN(solver.project(Pose(), {0, 0, 1}, 2, pixel), "remote == 0 || remote == 1");
  std::array<Sighting, kSightingsMax + 1> sightings = {};
  EXPECT_BROKEN(solver.solve(sightings, {}, Pose()), "sightings.size() <= kSightingsMax");
  sightings[0].remote = -1;
  EXPECT_BROKEN(solver.solve(std::span(sightings).first(1), {}, Pose()), "s.remote == 0 || s.remote == 1");
  const auto with = [&](double Upright::*sigma) {
    Upright upright;
    upright.*sigma = 0;
    return solver.solve({}, upright, Pose());
  };
  EXPECT_BROKEN(with(&Upright::sigma_x), "upright.sigma_x > 0");
  EXPECT_BROKEN(with(&Upright::sigma_y), "upright.sigma_y > 0");
  EXPECT_BROKEN(with(&Upright::sigma_roll), "upright.sigma_roll > 0");
  Upright upright;
  upright.C_LR.setZero();
  EXPECT_BROKEN(acquire_head(two_blobs(), {}, Pinhole{FieldOfView()}, solver, upright),
                "is_unit(Vector3d(upright.C_LR.row(i)))");
}

TEST(HeadFilterDeathTest, StartsFromAPoseAndIsCorrectedByMeasurements) {
  HeadFilter filter;
  const Matrix6d P = Matrix6d::Identity();
  EXPECT_BROKEN(filter.start(kStretched, P), "is_placement(X_RH)");
  EXPECT_BROKEN(filter.start(Pose(), kNaN * P), "covariance.allFinite()");
  EXPECT_BROKEN(filter.predict(-0.01, HeadFilter::View::all), "is_not_negative(dt)");
  const Vector3d g = Vector3d::UnitX();
  EXPECT_BROKEN(filter.correct(g, g, 0, 0, 5), "variance > 0");
  EXPECT_BROKEN(filter.correct_across(g, g, 0, kNaN, 5), "variance > 0");
}

TEST(VirtualRemoteDeathTest, WatchesAHeadThatIsSomewhere) {
  VirtualRemote remote({}, 1, "remote");
  Situation s;
  s.X_WH.position = {0, kNaN, 1};
  EXPECT_BROKEN(remote.sense(0, s), "is_placement(situation.X_WH)");
  s = {};
  s.X_WR = kStretched;
  EXPECT_BROKEN(remote.sense(0, s), "is_placement(situation.X_WR)");
  EXPECT_BROKEN(levelled_pose(s), "is_unit(situation.X_WR.rotation)");
}

TEST(CoverageDeathTest, CountsBetweenTwoDistances) {
  const FieldOfView fov;
  EXPECT_BROKEN(trackable_area(fov, -0.1, 1), "is_not_negative(spacing)");
  EXPECT_BROKEN(trackable_area(fov, 0.1, kInfinity), "is_not_negative(d)");
  EXPECT_BROKEN(trackable_volume(fov, 0.1, 2, 1), "d1 <= d2");
  EXPECT_BROKEN(trackable_volume(fov, 5, 1, 2), "2 * d1 * th >= spacing");
  EXPECT_BROKEN(count_trackable_area(fov, 0.1, 1, 0, 1), "count > 0");
  EXPECT_BROKEN(count_trackable_volume(fov, kNaN, 1, 2, 10, 1), "is_not_negative(spacing)");
  EXPECT_BROKEN(count_trackable_volume(fov, 0.1, -1, 2, 10, 1), "is_not_negative(d1)");
  EXPECT_BROKEN(count_trackable_volume(fov, 0.1, 1, kInfinity, 10, 1), "std::isfinite(d2)");
  EXPECT_BROKEN(count_trackable_volume(fov, 0.1, 2, 1, 10, 1), "d1 <= d2");
}

TEST(HeadDeathTest, HasASourceAndAPlace) {
  const auto source = [] { return make_virtual_source({}); };
  EXPECT_BROKEN(Head("head", nullptr, "scaat", Pose()), "source != nullptr");
  EXPECT_BROKEN(Head("head", source(), "scaat", kStretched), "is_placement(X_WL)");
  Head head("head", source(), "scaat", Pose());
  EXPECT_BROKEN(head.advance(kNaN), "std::isfinite(t)");
}

TEST(RecordingDeathTest, HasChannelsForEveryTime) {
  Recording recording;
  recording.t = {0};
  EXPECT_BROKEN(make_recorded_source(recording), "recording.channels.size() == recording.t.size()");
  recording.channels.resize(1);
  recording.truth.resize(2);
  EXPECT_BROKEN(make_recorded_source(recording),
                "recording.truth.empty() || recording.truth.size() == recording.t.size()");
}

TEST(AdmissionDeathTest, JudgesAtATime) {
  Admission admission;
  Vector3d p = {0, 0, 1};
  EXPECT_BROKEN(admission.judge(kNaN, 1e-4, p), "std::isfinite(t)");
}

// Before, the way that the head can have gone was negative, and a head 5 cm further on was thrown back by as much.
TEST(Admission, ATimeThatGoesBackALittleCountsAsThatFarApart) {
  Admission admission;
  Vector3d p = {0, 0, 1};
  (void)admission.judge(1, 1e-4, p);
  p = {0, 0, 1.05};
  EXPECT_EQ(admission.judge(0.98, 1e-4, p), Admission::Verdict::continued);
  EXPECT_EQ(p.z(), 1.05);
}

TEST(PlaceDeathTest, IsJudgedForHeads) {
  EXPECT_BROKEN(judge_place({}, {0, 0, 0}, 0, 0), "!options.heads.empty()");
  PlaceOptions options;
  options.heads = {Pose()};
  EXPECT_BROKEN(judge_place(options, {kNaN, 0, 0}, 0, 0), "is_finite(p_WR)");
  EXPECT_BROKEN(modelled_heads({0, 0, 1}, {0, 0, 0}, {0, 0, 0}, -1, 1), "count >= 0");
}

// '# leds: 0 0 0; 0 0 0' in a trace's header reached a division by their distance.
TEST(Place, RefusesGlassesAndLensesThatNoTrackerTakes) {
  PlaceOptions options;
  options.heads = {{{0, 0, 1}, Quaterniond::Identity()}};
  options.tracker.leds.p_H[1] = options.tracker.leds.p_H[0];
  expect_refused([&] { return good_places(options).front(); }, "leds: the first two are 0 m apart");
  options.tracker = {};
  options.tracker.fov = kNoView;
  expect_refused([&] { return good_places(options).front(); }, "horizontal field of view");
  options.tracker = {};
  options.room_max.x() = kInfinity;
  expect_refused([&] { return good_places(options).front(); }, "a corner of the room is not finite");
}

TEST(Tracker, RefusesASecondRemoteThatIsNowhere) {
  TrackerSettings settings;
  settings.X_R1R2 = kStretched;
  expect_refused([&] { return make_tracker("stereo", settings); }, "the second remote's placement");
}

TEST(Trajectory, RefusesPosesThatAreNone) {
  expect_refused(
      [] {
        return recorded_trajectory("motion", {0, 1}, {Pose(), kStretched});
      },
      "motion: sample 1 is not a finite pose");
}

}  // namespace
}  // namespace verisim::wii::wii_contracts_test

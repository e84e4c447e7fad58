// The covariance of a two-LED estimate against its errors: heads are drawn, projected to pixels by this file's own
// pinhole, solved, and compared with the truth.
#include "engine/wii/two_led_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "engine/base/random.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/trajectories.hpp"
#include "tests/length.hpp"

namespace verisim::wii {
namespace {

/// A remote, a place of the head and glasses, drawn: lens pitched and rolled, head 0.5 to 2.5 m away, up to 12 degrees
/// off the axis and rolled; LEDs 0.1 to 0.2 m apart, a little off the head's x axis where `skew` is not 0.
struct Scene {
  Scene(std::uint64_t seed, double skew) : random(seed, "scene") {
    const auto in = [&](std::uint64_t k, double low, double high) { return low + (high - low) * random.uniform(k); };
    X_WR = tilted_remote(in(0, -0.4, 0.4), in(1, -0.5, 0.5));
    const double z = in(2, 0.5, 2.5);
    p_L = (X_WR.rotation * Vector3d(z * in(3, -0.2, 0.2), z * in(4, -0.15, 0.15), z));
    roll = in(5, -0.6, 0.6);
    const double half = in(6, 0.05, 0.1);
    settings.leds.p_H[0] = {half, skew * random.normal(10), skew * random.normal(11)};
    settings.leds.p_H[1] = {-half, skew * random.normal(12), skew * random.normal(13)};
  }
  RandomStream random;
  TrackerSettings settings;
  Pose X_WR;
  Vector3d p_L;
  double roll = 0;
};

/// Of one drawn head of a scene: its error squared over the covariance, per degree of freedom of position and of
/// orientation.
struct Nees {
  double position = 0, orientation = 0;
};
Nees nees_of(const Scene& scene, double yaw_sigma, double pitch_sigma, double pixel_sigma, double tilt_sigma,
             std::uint64_t draw) {
  TrackerSettings settings = scene.settings;
  settings.yaw_sigma = yaw_sigma;
  settings.pitch_sigma = pitch_sigma;
  settings.pixel_sigma = pixel_sigma;
  const auto normal = [&](std::uint64_t k) { return scene.random.normal(100 + 16 * draw + k); };
  const Quaterniond R_LH = head_rotation(yaw_sigma * normal(0), pitch_sigma * normal(1), scene.roll);
  const Pinhole pinhole(settings.fov);
  std::array<Vector3d, 2> rays;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector3d p_R = scene.X_WR.rotation.conjugate() * (scene.p_L + R_LH * settings.leds.p_H[i]);
    rays[i] = {p_R.x() / p_R.z() + pixel_sigma / pinhole.fx * normal(2 + 2 * i),
               p_R.y() / p_R.z() + pixel_sigma / pinhole.fx * normal(3 + 2 * i), 1};
  }
  const Vector3d up_L(tilt_sigma * normal(8), 1, tilt_sigma * normal(9));
  const Matrix3d C_LR = levelling(scene.X_WR.rotation.conjugate() * up_L.normalized());
  const TwoPointPose pose = solve_two_points({settings.leds.p_H[0], settings.leds.p_H[1]}, rays[0], rays[1], C_LR);
  EXPECT_TRUE(pose.found);
  Matrix6d covariance = two_led_covariance(settings, pinhole, pose.p_L, pose.cos_roll, pose.sin_roll);
  add_tilt(covariance, pose.p_L, C_LR, tilt_sigma * tilt_sigma);
  Vector6d error;
  error << pose.p_L - scene.p_L,
      vector_from_rotation((rotation_about_z(pose.cos_roll, pose.sin_roll) * R_LH.conjugate()).normalized());
  const auto square = [&](Eigen::Index at) {
    const Matrix3d c = covariance.block<3, 3>(at, at);
    return error.segment<3>(at).dot(c.ldlt().solve(error.segment<3>(at))) / 3;
  };
  return {square(0), square(3)};
}

struct Spread {
  const char* name;
  double yaw, pitch, pixel, tilt, skew;  ///< rad, rad, pixel, rad, m
  friend void PrintTo(const Spread& s, std::ostream* out) { *out << s.name; }
};
class OfSpreads : public ::testing::TestWithParam<Spread> {};
INSTANTIATE_TEST_SUITE_P(TwoLedCovariance, OfSpreads,
                         ::testing::Values(Spread{"AsTrackersAssume", 9 * kDegree, 5 * kDegree, 0.4, 0.003, 0},
                                           Spread{"WithSkewGlasses", 9 * kDegree, 5 * kDegree, 0.4, 0.003, 0.01},
                                           Spread{"OfPixelsAlone", 1e-6, 1e-6, 0.4, 1e-7, 0.01},
                                           Spread{"OfTurns", 5 * kDegree, 3 * kDegree, 0.1, 1e-7, 0.01},
                                           Spread{"OfTilt", 9 * kDegree, 5 * kDegree, 0.1, 0.02, 0}),
                         [](const auto& s) { return std::string(s.param.name); });

TEST_P(OfSpreads, IsWhatErrorsAre) {
  const Spread& s = GetParam();
  const int scenes = test::by_length(20, 200, 2000);
  double position = 0, orientation = 0;
  for (int i = 0; i < scenes; ++i) {
    const Scene scene(static_cast<std::uint64_t>(i), s.skew);
    for (std::uint64_t draw = 0; draw < 20; ++draw) {
      const Nees nees = nees_of(scene, s.yaw, s.pitch, s.pixel, s.tilt, draw);
      position += nees.position / (20 * scenes);
      orientation += nees.orientation / (20 * scenes);
    }
  }
  // 1 if it is right; some 20 % for what is of third order, and for chance.
  EXPECT_GT(position, 0.8);
  EXPECT_LT(position, 1.25);
  EXPECT_GT(orientation, 0.8);
  EXPECT_LT(orientation, 1.25);
}

}  // namespace
}  // namespace verisim::wii

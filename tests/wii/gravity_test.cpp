// The gravity filter against what a remote may do: it rests, sways, is turned and put down, creeps. The ruler is the
// true direction; beside it, double exponential smoothing alone, which is what follows best while a remote moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "engine/base/random.hpp"
#include "engine/wii/gravity.hpp"
#include "tests/length.hpp"

namespace verisim::wii {
namespace {

constexpr double kRate = 100;  // readings per s

/// Tilt about x and z [rad] at a time; few and slow enough angles that their order does not matter.
using Tilt = std::function<Eigen::Vector2d(double)>;

Vector3d up_of(const Eigen::Vector2d& tilt) {
  return Vector3d(tilt.y(), 1, tilt.x()).normalized();
}

/// The smoothing that TrackerSettings::gravity_time_constant describes, without a thought of rest.
class Smoothing {
 public:
  Vector3d add(double dt, const Vector3d& a) {
    if (first_) up_ = a;
    first_ = false;
    const double keep = 0.1 / (0.1 + dt);
    const Vector3d expected = up_ + dt * rate_;
    up_ = expected + (1 - keep * keep) * (a - expected);
    rate_ += (1 - keep) / (0.1 + dt) * (a - expected);
    return up_.normalized();
  }

 private:
  bool first_ = true;
  Vector3d up_ = Vector3d::UnitY(), rate_ = Vector3d::Zero();
};

struct Accelerometer {
  const char* name;
  double noise, step;  ///< g

  friend void PrintTo(const Accelerometer& a, std::ostream* out) { *out << a.name; }
  [[nodiscard]] Vector3d read(const Vector3d& up_R, const RandomStream& random, int k) const {
    Vector3d reading = up_R;
    for (int i = 0; i < 3; ++i) {
      reading[i] += noise * random.normal(static_cast<std::uint64_t>(4 * k + i + 4));
      if (step > 0) reading[i] = step * std::floor(reading[i] / step + 0.5);
    }
    return reading;
  }
};
constexpr std::array kAccelerometers = {Accelerometer{"Exact", 0, 0},
                                        Accelerometer{"Of10Bits", 0, 1.0 / 104},
                                        Accelerometer{"Of10BitsWithHalfAStep", 0.005, 1.0 / 104},
                                        Accelerometer{"WithAHundredthOfG", 0.01, 0},
                                        Accelerometer{"Of8BitsWithAHundredth", 0.01, 1.0 / 26},
                                        Accelerometer{"Of8Bits", 0, 1.0 / 26},
                                        Accelerometer{"WithThreeHundredthsOfG", 0.03, 0}};

struct Rms {
  double filter = 0, smoothing = 0, worst = 0;  ///< rad, of the direction of gravity
  double nees = 0;  ///< over two degrees of freedom; rounding errors repeat, so they count beside the variance
};
/// Of a motion from `settle` to `until` [s].
Rms rms_over(const Tilt& tilt, double until, const Accelerometer& accelerometer, std::uint64_t seed,
             double settle = 0) {
  const RandomStream random(seed, "accelerometer");
  GravityFilter filter(0.1);
  Smoothing smoothing;
  Rms sum;
  int n = 0;
  for (int k = 0; k < static_cast<int>(until * kRate); ++k) {
    const Vector3d truth = up_of(tilt(k / kRate));
    const Vector3d reading = accelerometer.read(truth, random, k);
    filter.add(k == 0 ? 0 : 1 / kRate, reading);
    const Vector3d smooth = smoothing.add(k == 0 ? 0 : 1 / kRate, reading);
    if (k < settle * kRate) continue;
    const double square = (Vector3d(filter.C_LR().row(1)) - truth).squaredNorm();
    sum.filter += square;
    sum.smoothing += (smooth - truth).squaredNorm();
    sum.worst = std::max(sum.worst, std::sqrt(square));
    sum.nees += square / (2 * (filter.tilt_variance() + accelerometer.step * accelerometer.step / 12));
    ++n;
  }
  return {std::sqrt(sum.filter / n), std::sqrt(sum.smoothing / n), sum.worst, sum.nees / n};
}

/// Two angles that sway at 1 and 0.7 times a frequency [Hz], each from anywhere.
Tilt sway(double frequency, double amplitude, std::uint64_t seed) {
  const RandomStream random(seed, "sway");
  const double x = 2 * M_PI * random.uniform(0), z = 2 * M_PI * random.uniform(1);
  const double w = 2 * M_PI * frequency;
  return [=](double t) -> Eigen::Vector2d {
    return {amplitude * std::sin(w * t + x), 0.75 * amplitude * std::sin(0.7 * w * t + z)};
  };
}

/// At rest, turned from 5 s on within half a second, and at rest again.
Tilt turned_once(std::uint64_t seed) {
  const RandomStream random(seed, "turn");
  const Eigen::Vector2d from(0.3 * random.normal(0), 0.3 * random.normal(1));
  const Eigen::Vector2d by(0.2 * random.normal(2), 0.2 * random.normal(3));
  return [=](double t) -> Eigen::Vector2d { return from + by * std::clamp((t - 5) / 0.5, 0.0, 1.0); };
}

/// Root mean square over seeds of what one seed gives.
Rms over_seeds(int seeds, const std::function<Rms(std::uint64_t)>& one) {
  Rms all;
  for (int seed = 0; seed < seeds; ++seed) {
    const Rms here = one(static_cast<std::uint64_t>(seed));
    all.filter += here.filter * here.filter / seeds;
    all.smoothing += here.smoothing * here.smoothing / seeds;
    all.worst = std::max(all.worst, here.worst);
  }
  all.filter = std::sqrt(all.filter);
  all.smoothing = std::sqrt(all.smoothing);
  return all;
}

class OfAccelerometers : public ::testing::TestWithParam<Accelerometer> {};
INSTANTIATE_TEST_SUITE_P(Gravity, OfAccelerometers, ::testing::ValuesIn(kAccelerometers),
                         [](const auto& a) { return std::string(a.param.name); });

// From the first reading on: the mean of n readings is off by noise / sqrt(n) about either axis. What rounding without
// noise leaves, no mean takes away, so the mean itself, computed here, is the ruler.
TEST_P(OfAccelerometers, IsTheMeanOfAllReadingsAtRest) {
  const Accelerometer& a = GetParam();
  for (const int readings : {1, 3, 10, 100, 1000}) {
    double filter_square = 0, mean_square = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const RandomStream random(seed, "accelerometer");
      const Vector3d truth = up_of({0.3 * random.normal(1), 0.3 * random.normal(2)});
      GravityFilter filter(0.1);
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < readings; ++k) {
        const Vector3d reading = a.read(truth, random, k);
        filter.add(k == 0 ? 0 : 1 / kRate, reading);
        sum += reading;
      }
      filter_square += (Vector3d(filter.C_LR().row(1)) - truth).squaredNorm();
      mean_square += (sum.normalized() - truth).squaredNorm();
    }
    // Of thousands of readings the older ones count less: the remote might have moved.
    EXPECT_LE(std::sqrt(filter_square), (readings < 1000 ? 1.15 : 1.9) * std::sqrt(mean_square) + 1e-12) << readings;
  }
}

TEST_P(OfAccelerometers, FollowsAMovingRemoteAsSmoothingAloneDoes) {
  const Accelerometer& a = GetParam();
  const int seeds = test::by_length(1, 5, 100);
  for (const double frequency : {0.02, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0, 2.0})
    for (const double degrees : {0.3, 1.0, 4.0, 15.0}) {
      const Rms rms = over_seeds(
          seeds, [&](std::uint64_t seed) { return rms_over(sway(frequency, degrees * kDegree, seed), 20, a, seed); });
      EXPECT_LE(rms.filter, 1.15 * rms.smoothing + 0.0002) << frequency << " Hz, " << degrees << " degrees";
    }
}

TEST_P(OfAccelerometers, NoticesThatItWasTurnedAndRestsAgain) {
  const Accelerometer& a = GetParam();
  const auto rms = [&](double from, double to) {
    return over_seeds(test::by_length(10, 100, 1000),
                      [&](std::uint64_t seed) { return rms_over(turned_once(seed), to, a, seed, from); });
  };
  const Rms turning = rms(5, 6), after = rms(7, 10);
  EXPECT_LE(turning.filter, 1.15 * turning.smoothing + 0.0002);
  EXPECT_LE(after.filter, a.noise > 0 ? 0.6 * after.smoothing : 1.01 * after.smoothing + 0.0002);
}

// Slower than anybody turns a remote: what is not noticed is within what the readings scatter.
TEST_P(OfAccelerometers, FollowsACreepingRemote) {
  const Accelerometer& a = GetParam();
  for (const double speed : {1e-4, 3e-4, 1e-3, 3e-3, 1e-2}) {  // rad/s
    const Tilt creep = [=](double t) -> Eigen::Vector2d { return {speed * t, 0}; };
    const Rms rms = over_seeds(5, [&](std::uint64_t seed) { return rms_over(creep, 60, a, seed); });
    EXPECT_LE(rms.filter, 1.15 * rms.smoothing + 0.0003) << speed;
  }
}

// The variance that the filter states, against the errors that it makes: at rest, swaying and just turned.
TEST_P(OfAccelerometers, StatesHowFarTheTiltMayBeOff) {
  const Accelerometer& a = GetParam();
  if (a.noise == 0) return;  // rounding alone repeats
  for (const auto& motion : {sway(0, 0, 1), sway(0.3, 4 * kDegree, 1), turned_once(1)}) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) sum += rms_over(motion, 10, a, seed, 0.1).nees / 20;
    EXPECT_GT(sum, a.step == 0 ? 0.3 : 0);
    EXPECT_LT(sum, 2.5);
  }
}

// A knock on the table: one reading that is 0.25 g off decides nothing.
TEST(Gravity, ForgetsAKnock) {
  GravityFilter filter(0.1);
  const RandomStream random(1, "accelerometer");
  for (int k = 0; k < 500; ++k) filter.add(0.01, kAccelerometers[3].read(Vector3d::UnitY(), random, k));
  filter.add(0.01, {0.25, 1, 0});
  EXPECT_GT(filter.rest(), 0.5);
  for (int k = 500; k < 530; ++k) filter.add(0.01, kAccelerometers[3].read(Vector3d::UnitY(), random, k));
  EXPECT_GT(filter.rest(), 0.95);
  EXPECT_LT(std::abs(filter.C_LR()(1, 0)), 0.003);
}

}  // namespace
}  // namespace verisim::wii

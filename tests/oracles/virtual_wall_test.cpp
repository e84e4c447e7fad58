// ORACLES section 2: the virtual wall, as a small explicit model in this file. No engine code takes part: these are the
// numbers that the engine's contact and its passivity observers are later measured against.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "engine/base/pinned_math.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::virtual_wall_test {
namespace {

using test::tolerance;

/// A handle held by a hand (spring and damper to the hand's target) touches a wall at 0.030 m. Explicit Euler.
struct HandOnWall {
  double mass = 0.04, damping = 0.8;                  ///< kg, N s/m, of the device
  double hand_stiffness = 400, hand_damping = 8;      ///< N/m, N s/m
  double wall_at = 0.030, target = 0.035, x = 0.020;  ///< m
  double v = 0;                                       ///< m/s
  /// Passivity observer: E += T f_wall v, the energy that the wall has given to the handle [J]. A passive wall only
  /// stores and takes, so E never rises above what rounding explains; E > 0 is energy out of nothing.
  double energy = 0;
  double x_low = 0, x_high = 0;  ///< range of x over the last fifty steps
};

HandOnWall push(double wall_stiffness, double period, HandOnWall s = {}) {
  const int steps = static_cast<int>(std::lround(1.5 / period)) + 1;  // at 0, T, ... 1.5 s inclusive
  for (int i = 0; i < steps; ++i) {
    const double wall = s.x > s.wall_at ? -wall_stiffness * (s.x - s.wall_at) : 0;
    const double force = wall + s.hand_stiffness * (s.target - s.x) - (s.hand_damping + s.damping) * s.v;
    s.energy += period * wall * s.v;
    s.x += period * s.v;
    s.v += period * force / s.mass;
    if (i == steps - 50) s.x_low = s.x_high = s.x;
    s.x_low = std::min(s.x_low, s.x);
    s.x_high = std::max(s.x_high, s.x);
  }
  return s;
}

// Rest where both springs balance: 400 (0.035 - x) = 400 (x - 0.030). The wall holds 1.25 mJ less what the sampling
// made.
TEST(GoldenWall, ASoftWallAt1msComesToRestPassively) {
  const HandOnWall s = push(400, 1e-3);
  EXPECT_LE(std::abs(s.x - 0.0325), tolerance(1e-15));
  EXPECT_LE(std::abs(s.energy - -1.1445e-3), tolerance(0.5e-7));  // as many digits as the oracle gives
  EXPECT_LT(s.energy, 0);
}

TEST(GoldenWall, AStiffWallAt5msChattersAndMakesEnergy) {
  const HandOnWall s = push(2500, 5e-3);
  EXPECT_GT(s.x_high - s.x_low, 1e-3) << "it came to rest";
  EXPECT_LE(std::abs(s.energy - 0.527), tolerance(0.5e-3));
}

TEST(GoldenWall, TheSameAt1msRests) {
  const HandOnWall s = push(2500, 1e-3);
  EXPECT_LE(std::abs(s.x - 0.03068966), tolerance(0.5e-8));
  EXPECT_LE(std::abs(s.x - 89.0 / 2900), tolerance(1e-15));  // 400 (0.035 - x) = 2500 (x - 0.030)
}

TEST(GoldenWall, WithoutTheHandsDamperItDiverges) {
  HandOnWall bare;
  bare.hand_damping = 0;
  EXPECT_GT(std::abs(push(2500, 5e-3, bare).x), 1e3);
  EXPECT_GT(push(2500, 1e-3, bare).energy, 1);
}

/// Largest eigenvalue (absolute) of a mass with damping b against the sampled wall u = -K x - B (x - x_before)/T, held
/// over the period (zero-order hold), the handle's motion between samples exact. State (x, v, x_before).
double spectral_radius(double mass, double b, double K, double B, double T) {
  const double decay = std::exp(-b * T / mass);
  const double x_by_v = mass / b * (1 - decay);
  const double x_by_u = T / b - mass / (b * b) * (1 - decay);
  const double v_by_u = (1 - decay) / b;
  const double u_by_x = -(K + B / T), u_by_before = B / T;
  Eigen::Matrix3d A;
  A << 1 + x_by_u * u_by_x, x_by_v, x_by_u * u_by_before,  //
      v_by_u * u_by_x, decay, v_by_u * u_by_before,        //
      1, 0, 0;
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

/// The wall stiffness at which stability ends, by bisection.
double stiffness_bound(double mass) {
  double stable = 1, unstable = 1e4;
  for (int i = 0; i < 60; ++i) {
    const double K = (stable + unstable) / 2;
    (spectral_radius(mass, 0.8, K, 0.4, 1e-3) < 1 ? stable : unstable) = K;
  }
  return stable;
}

// "b=0.8, B=0.4, T=1 ms: stable below 2400 N/m (heavy-mass limit; 2384 exactly at 0.04 kg, 2398 at 0.4)." The delay t_d
// is 0: K < (b + B)/(T/2).
TEST(SampledWall, IsStableUpToTheWorkedStiffness) {
  EXPECT_LE(std::abs(stiffness_bound(0.04) - 2384), tolerance(0.5));
  EXPECT_LE(std::abs(stiffness_bound(0.4) - 2398), tolerance(0.5));
  EXPECT_LE(std::abs(stiffness_bound(40) - (0.8 + 0.4) / (1e-3 / 2)), tolerance(0.02));  // what is left goes as 1/m
}

/// The least device damping that makes the wall H(z) = K + B (z - 1)/(T z) passive (Colgate and Schenkel's general
/// form).
double damping_for_passivity(double K, double B, double T) {
  using Complex = std::complex<double>;
  double most = 0;
  const int steps = 10000;
  for (int i = 1; i <= steps; ++i) {
    const double wT = pinned::kPi * i / steps;
    const Complex backward = 1.0 - std::exp(Complex(0, -wT));  // 1 - z^-1
    const Complex H = K + B / T * backward;
    most = std::max(most, T / 2 / (1 - std::cos(wT)) * (backward * H).real());
  }
  return most;
}

// "Passive below 800": b > K T/2 + |B| with b = 0.8 and B = 0.4; and the general form agrees with the special one. Near
// w = 0 its quotient cancels to about 1e-16/1e-7.
TEST(SampledWall, IsPassiveUpToTheWorkedStiffness) {
  EXPECT_LE(std::abs(damping_for_passivity(800, 0.4, 1e-3) - 0.8), tolerance(1e-8));
  for (const double K : {100.0, 800.0, 5000.0})
    for (const double B : {0.0, 0.4, 2.0})
      EXPECT_LE(std::abs(damping_for_passivity(K, B, 1e-3) - (K * 1e-3 / 2 + B)), tolerance(1e-8)) << K << " " << B;
}

// The two criteria are different promises: between 800 and 2384 N/m the wall is stable and not passive.
TEST(SampledWall, MayBeStableWithoutBeingPassive) {
  EXPECT_LT(spectral_radius(0.04, 0.8, 1600, 0.4, 1e-3), 1);
  EXPECT_GT(damping_for_passivity(1600, 0.4, 1e-3), 0.8);
}

}  // namespace
}  // namespace verisim::virtual_wall_test

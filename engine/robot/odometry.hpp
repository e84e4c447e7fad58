// What encoders tell: where the base is (dead reckoning), how fast its wheels turn, and whether they slip.
// Floor and robot coordinates as in mecanum.hpp; counts cumulative, in the order FL, FR, RL, RR. No allocation after
// construction; tens of flops a call.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/robot/mecanum.hpp"

namespace verisim::robot {

using Counts = std::array<std::int64_t, kWheels>;
inline constexpr double kCountsPerWheelTurn = 3072;  ///< 48 * 64 (ORACLES section 2); 0.1023 mm of floor a count

/// `pose` after a displacement in robot coordinates along which the twist did not change: an arc, exactly.
[[nodiscard]] PlanarPose moved(const PlanarPose& pose, const PlanarTwist& displacement);

/// Counts of each wheel (rows) per dx, dy [m] and dtheta [rad] of the base (columns).
using CountsPerDisplacement = Eigen::Matrix<double, kWheels, 3>;
[[nodiscard]] CountsPerDisplacement counts_per_displacement(const MecanumGeometry& geometry, double counts_per_turn);

/// Displacement of the base from counts, by least squares over the four wheels.
class WheelMap {
 public:
  /// @pre the columns are independent: each motion turns a wheel
  explicit WheelMap(const CountsPerDisplacement& counts);
  /// Also of speeds: counts per second give m/s and rad/s.
  [[nodiscard]] PlanarTwist displacement(const PerWheel& counts) const;

 private:
  Eigen::Matrix<double, 3, kWheels> inverse_;
};

/// Dead reckoning. Exact for a twist that stays between two calls; slip and what the map is wrong by add up.
class Odometry {
 public:
  /// begins at `pose`, where the counts are `counts`
  Odometry(const WheelMap& map, const PlanarPose& pose, const Counts& counts)
      : map_(map), pose_(pose), counts_(counts) {}
  const PlanarPose& advance(const Counts& counts);
  [[nodiscard]] const PlanarPose& pose() const { return pose_; }

 private:
  WheelMap map_;
  PlanarPose pose_;
  Counts counts_;
};

/// Counts per second over the last `window`: late by half of it, coarse by one count per window, right for a constant
/// speed. Until a window has passed it looks back as far as it can.
class CountRate {
 public:
  /// @pre period > 0, window >= period [s]
  CountRate(double period, double window);
  /// Call once a period.
  PerWheel advance(const Counts& counts);

 private:
  double period_;
  std::vector<Counts> past_;  ///< a ring of as many as the window has periods
  std::size_t calls_ = 0;
};

struct SlipLimits {
  double window = 0.05;  ///< over which speeds are taken [s]
  double bound = 1;      ///< of the residual of four wheels [rad/s]; 50 mm/s of floor, 10 times its coarseness
  double hold = 0.1;     ///< as long must it last [s]: taking up the gears' backlash (4 degrees at most) does not
};

/// Says that wheels slip when the four speeds fit no motion: |w_FL + w_FR - w_RL - w_RR| above the bound for as long as
/// `hold`. A residual that jumps to R > bound is told after window * bound / R + hold, 0.15 s at most. It cannot see
/// what the wheels do not: a base that a push turns or shifts while all four stand.
class SlipDetector {
 public:
  /// @pre period > 0 [s], limits positive
  SlipDetector(const SlipLimits& limits, double counts_per_turn, double period);
  /// Call once a period. Whether wheels slip.
  bool advance(const Counts& counts);
  [[nodiscard]] double residual() const { return residual_; }  ///< [rad/s]

 private:
  CountRate rate_;
  double radians_per_count_, bound_;
  std::size_t hold_, above_ = 0;  ///< periods
  double residual_ = 0;
};

}  // namespace verisim::robot

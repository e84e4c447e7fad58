#include "engine/robot/odometry.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

std::size_t periods(double time, double period) {
  VERISIM_ASSERT(is_positive(period));
  VERISIM_ASSERT(time >= period);
  return static_cast<std::size_t>(std::llround(time / period));
}

}  // namespace

// Below 1e-8 rad the next terms of the series are 1e-17 of the way.
PlanarPose moved(const PlanarPose& pose, const PlanarTwist& displacement) {
  const auto [dx, dy, turn] = displacement;
  const bool is_small = std::abs(turn) < 1e-8;
  const double half = pinned::sin(turn / 2);
  const double along = is_small ? 1 : pinned::sin(turn) / turn;
  const double across = is_small ? turn / 2 : 2 * half * half / turn;  // (1 - cos turn) / turn
  const double x = along * dx - across * dy, y = across * dx + along * dy;
  const double c = pinned::cos(pose.theta), s = pinned::sin(pose.theta);
  return {pose.x + c * x - s * y, pose.y + s * x + c * y, pose.theta + turn};
}

CountsPerDisplacement counts_per_displacement(const MecanumGeometry& geometry, double counts_per_turn) {
  VERISIM_ASSERT(is_positive(counts_per_turn));
  CountsPerDisplacement counts;
  const PlanarTwist units[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int column = 0; column < 3; ++column) {
    const PerWheel angles = wheel_speeds(geometry, units[column]);
    for (int row = 0; row < 4; ++row)
      counts(row, column) = angles[static_cast<std::size_t>(row)] * counts_per_turn / pinned::kFullTurn;
  }
  return counts;
}

WheelMap::WheelMap(const CountsPerDisplacement& counts) {
  VERISIM_ASSERT(counts.allFinite());
  const Eigen::LDLT<Eigen::Matrix3d> normal(counts.transpose() * counts);
  VERISIM_ASSERT(normal.vectorD().minCoeff() > 0);
  inverse_ = normal.solve(counts.transpose());
}

PlanarTwist WheelMap::displacement(const PerWheel& counts) const {
  PlanarTwist d;
  for (int i = 0; i < 4; ++i) {
    const double count = counts[static_cast<std::size_t>(i)];
    d.vx += inverse_(0, i) * count;
    d.vy += inverse_(1, i) * count;
    d.omega += inverse_(2, i) * count;
  }
  return d;
}

const PlanarPose& Odometry::advance(const Counts& counts) {
  PerWheel change{};
  for (std::size_t i = 0; i < kWheels; ++i) change[i] = static_cast<double>(counts[i] - counts_[i]);
  counts_ = counts;
  pose_ = moved(pose_, map_.displacement(change));
  return pose_;
}

CountRate::CountRate(double period, double window) : period_(period), past_(periods(window, period)) {}

PerWheel CountRate::advance(const Counts& counts) {
  const std::size_t back = std::min(calls_, past_.size());
  Counts& oldest = past_[calls_ % past_.size()];
  const Counts& before = calls_ < past_.size() ? past_[0] : oldest;
  PerWheel rate{};
  for (std::size_t i = 0; back > 0 && i < kWheels; ++i)
    rate[i] = static_cast<double>(counts[i] - before[i]) / (static_cast<double>(back) * period_);
  oldest = counts;
  ++calls_;
  return rate;
}

SlipDetector::SlipDetector(const SlipLimits& limits, double counts_per_turn, double period)
    : rate_(period, limits.window),
      radians_per_count_(pinned::kFullTurn / counts_per_turn),
      bound_(limits.bound),
      hold_(periods(limits.hold, period)) {
  VERISIM_ASSERT(is_positive(counts_per_turn));
  VERISIM_ASSERT(is_positive(limits.bound));
}

bool SlipDetector::advance(const Counts& counts) {
  residual_ = slip_residual(rate_.advance(counts)) * radians_per_count_;
  above_ = std::abs(residual_) > bound_ ? above_ + 1 : 0;
  return above_ >= hold_;
}

}  // namespace verisim::robot

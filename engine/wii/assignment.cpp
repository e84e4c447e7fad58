#include "engine/wii/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

double distance_square(const Blob& a, const Blob& b) {
  return (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
}

/// Depth-first over all injective assignments, cut off at the best cost so far.
struct Search {
  const Reading& reading;
  std::span<const Eigen::Vector2d> expected;
  double gate_square;
  Assignment best = {-1, -1, -1, -1};
  double best_cost = std::numeric_limits<double>::infinity();
  Assignment current = {-1, -1, -1, -1};

  void descend(std::size_t led, unsigned used, double cost) {
    if (cost >= best_cost) return;
    if (led == expected.size()) {
      best_cost = cost;
      best = current;
      return;
    }
    for (int b = 0; b < reading.blob_count; ++b) {
      const Blob& blob = reading.blobs[static_cast<std::size_t>(b)];
      const double d = (Eigen::Vector2d(blob.u, blob.v) - expected[led]).squaredNorm();
      if ((used >> b & 1U) != 0 || !(d <= gate_square)) continue;
      current[led] = b;
      descend(led + 1, used | 1U << b, cost + d);
    }
    current[led] = -1;
    descend(led + 1, used, cost + gate_square);
  }
};

}  // namespace

Assignment nearest_assignment(const Reading& reading, std::span<const Eigen::Vector2d> expected, double gate) {
  VERISIM_ASSERT(expected.size() <= kLedsMax);
  VERISIM_ASSERT(is_not_negative(gate));
  Search search{reading, expected, gate * gate};
  search.descend(0, 0, 0);
  return search.best;
}

PairFollower::PairFollower(const LedLayout& leds, const Pinhole& pinhole, const Thresholds& thresholds)
    : leds_(leds), pinhole_(pinhole), pair_{leds.p_H[0], leds.p_H[1]}, thresholds_(thresholds), clutter_(thresholds) {
  VERISIM_ASSERT(leds.count >= 2);
  VERISIM_ASSERT(leds.count <= kLedsMax);
}

PairFollower::Match PairFollower::solve(const Reading& reading, int first, int second, const Matrix3d& C_LR) const {
  const Blob& b0 = reading.blobs[static_cast<std::size_t>(first)];
  const Blob& b1 = reading.blobs[static_cast<std::size_t>(second)];
  return {solve_two_points(pair_, pinhole_.ray(b0.u, b0.v), pinhole_.ray(b1.u, b1.v), C_LR, thresholds_.forward_min),
          {first, second}};
}

PairFollower::Match PairFollower::match(double t, const Reading& reading, const Matrix3d& C_LR) {
  if (reading.blob_count < 2) return {};
  if (followed_ && t - t_ <= thresholds_.pair_memory) {
    const Match match = continue_pair(t - t_, reading, C_LR);
    return match.found() ? reconsidered(reading, match, C_LR) : match;
  }
  return acquire(reading, C_LR);
}

PairFollower::Match PairFollower::reconsidered(const Reading& reading, const Match& current, const Matrix3d& C_LR) {
  Match other;
  if (reading.blob_count > 2) {
    const Match now = current.found() ? current : solve(reading, current.blob[0], current.blob[1], C_LR);
    double cost = cost_of(reading, now, C_LR) - thresholds_.cost_margin;
    if (cost > 0) other = least_cost_pair(reading, C_LR, true, cost);
  }
  // One image does not confirm a jump. Once confirmed, the other pair is returned until it is followed.
  confirmations_ = other.found() ? std::min(confirmations_ + 1, thresholds_.confirmations) : 0;
  return confirmations_ < thresholds_.confirmations ? current : other;
}

PairFollower::Match PairFollower::continue_pair(double age, const Reading& reading, const Matrix3d& C_LR) const {
  // The gate: half the spacing of the two blobs is further than a head moves between reports (5 m/s at any distance)
  // and nearer than a swap of the two.
  const double way = thresholds_.pair_speed * age;
  const double gate_square =
      thresholds_.pair_gate * thresholds_.pair_gate + 0.25 * distance_square(last_[0], last_[1]) + way * way;
  const auto cost = [&](int b, std::size_t led) {
    const Blob& blob = reading.blobs[static_cast<std::size_t>(b)];
    const double moved = distance_square(blob, last_[led]);
    const bool another = std::abs(blob.size - last_[led].size) > thresholds_.size_spread;
    return moved > gate_square || another || clutter_.distance_square(blob) < moved
               ? std::numeric_limits<double>::infinity()
               : moved;
  };
  std::array<int, 2> best = {-1, -1};
  double best_cost = std::numeric_limits<double>::infinity();
  for (int i = 0; i < reading.blob_count; ++i)
    for (int j = 0; j < reading.blob_count; ++j) {
      const double both = i == j ? std::numeric_limits<double>::infinity() : cost(i, 0) + cost(j, 1);
      if (both >= best_cost) continue;
      best = {i, j};
      best_cost = both;
    }
  return best[0] < 0 ? Match{} : solve(reading, best[0], best[1], C_LR);
}

PairFollower::Match PairFollower::acquire(const Reading& reading, const Matrix3d& C_LR) const {
  // Without the yaw, the places of further LEDs are known only roughly: they choose among pairs and refuse none.
  double cost = thresholds_.pair_cost_max + thresholds_.missing_led_cost * (leds_.count - 2);
  return least_cost_pair(reading, C_LR, false, cost);
}

PairFollower::Match PairFollower::least_cost_pair(const Reading& reading, const Matrix3d& C_LR, bool clutter_too,
                                                  double& cost) const {
  const auto is_near_clutter = [&](int b) {
    return !clutter_too && clutter_.holds(reading.blobs[static_cast<std::size_t>(b)]);
  };
  Match best;
  for (int i = 0; i < reading.blob_count; ++i)
    for (int j = 0; j < reading.blob_count; ++j) {
      if (i == j || is_near_clutter(i) || is_near_clutter(j)) continue;
      const Match match = solve(reading, i, j, C_LR);
      if (!match.found() || match.pose.cos_roll <= 0) continue;
      const double here = cost_of(reading, match, C_LR);
      if (here >= cost) continue;
      best = match;
      cost = here;
    }
  return best;
}

double PairFollower::cost_of(const Reading& reading, const Match& match, const Matrix3d& C_LR) const {
  const TwoPointPose& pose = match.pose;
  const auto size = [&](std::size_t i) { return reading.blobs[static_cast<std::size_t>(match.blob[i])].size; };
  const double roll = pose.sin_roll / thresholds_.roll_sigma;
  const double unequal = (size(0) - size(1)) / thresholds_.size_scale;
  double cost = roll * roll + unequal * unequal;
  if (size_at_1m_ > 0) {
    const double expected = std::clamp(size_at_1m_ / pose.p_L.norm(), 1.0, 15.0);
    const double other = ((size(0) + size(1)) / 2 - expected) / thresholds_.size_scale;
    cost += std::min(other * other, thresholds_.size_cost_max);
  }
  const Matrix3d R_LH = rotation_about_z(pose.cos_roll, pose.sin_roll).toRotationMatrix();
  for (std::size_t led = 2; led < static_cast<std::size_t>(leds_.count); ++led) {
    const Vector3d p_R = C_LR.transpose() * (pose.p_L + R_LH * leds_.p_H[led]);
    if (!(p_R.z() > 0)) continue;
    const Eigen::Vector2d pixel = pinhole_.project(p_R);
    double nearest = kWidth * kWidth;
    for (int b = 0; b < reading.blob_count; ++b)
      if (b != match.blob[0] && b != match.blob[1])
        nearest = std::min(nearest,
                           distance_square(reading.blobs[static_cast<std::size_t>(b)], Blob{pixel.x(), pixel.y(), 0}));
    cost += std::min(nearest / (thresholds_.led_scale * thresholds_.led_scale), thresholds_.missing_led_cost);
  }
  return cost;
}

void PairFollower::follow(double t, const Reading& reading, const Match& match) {
  VERISIM_ASSERT(std::isfinite(t));
  VERISIM_ASSERT(std::min(match.blob[0], match.blob[1]) >= 0);
  VERISIM_ASSERT(std::max(match.blob[0], match.blob[1]) < reading.blob_count);
  followed_ = true;
  t_ = t;
  for (std::size_t i = 0; i < 2; ++i) last_[i] = reading.blobs[static_cast<std::size_t>(match.blob[i])];
  const double size_at_1m = (last_[0].size + last_[1].size) / 2 * match.pose.p_L.norm();
  size_at_1m_ = size_at_1m_ > 0 ? size_at_1m_ + thresholds_.size_learning * (size_at_1m - size_at_1m_) : size_at_1m;
  clutter_.learn(reading, match.blob);
}

}  // namespace verisim::wii

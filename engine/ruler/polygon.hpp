// A small linear problem: a convex polygon in the square [-1, 1]^2, cut by half planes, and the largest value there of
// the least of a few linear functions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "engine/base/pose.hpp"

namespace verisim::ruler {

/// at + u du + v dv
struct Linear {
  double at = 0, du = 0, dv = 0;
  [[nodiscard]] double operator()(const Eigen::Vector2d& p) const { return at + du * p.x() + dv * p.y(); }
};

class Polygon {
 public:
  Polygon() : count_(4) { corners_ = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}; }

  [[nodiscard]] std::span<const Eigen::Vector2d> corners() const { return {corners_.data(), count_}; }
  [[nodiscard]] bool is_empty() const { return count_ == 0; }

  /// Keeps where f <= 0. Once there are too many corners nothing more is cut: the polygon is then too large, never too
  /// small.
  void keep_below(const Linear& f) {
    if (count_ + 1 > corners_.size()) return;
    std::array<Eigen::Vector2d, kCornersMax> kept;
    std::size_t n = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Eigen::Vector2d& a = corners_[i];
      const Eigen::Vector2d& b = corners_[(i + 1) % count_];
      const double fa = f(a), fb = f(b);
      if (fa <= 0) kept[n++] = a;
      if ((fa <= 0) != (fb <= 0)) kept[n++] = a + fa / (fa - fb) * (b - a);
    }
    corners_ = kept;
    count_ = n;
  }

 private:
  static constexpr std::size_t kCornersMax = 24;
  std::array<Eigen::Vector2d, kCornersMax> corners_;
  std::size_t count_;
};

/// The largest value of f on the polygon. @pre the polygon is not empty
[[nodiscard]] inline double largest(const Linear& f, const Polygon& polygon) {
  double most = f(polygon.corners().front());
  for (const Eigen::Vector2d& corner : polygon.corners()) most = std::max(most, f(corner));
  return most;
}

/// A bound of the largest value of min(f, g): the best of their mixtures (exact, by duality, to the search's 40
/// halvings).
[[nodiscard]] inline double largest_of_lesser(const Linear& f, const Linear& g, const Polygon& polygon) {
  const auto mixed = [&](double s) {
    return largest({s * f.at + (1 - s) * g.at, s * f.du + (1 - s) * g.du, s * f.dv + (1 - s) * g.dv}, polygon);
  };
  double low = 0, high = 1;  // the bound is convex in s
  double best = std::min(mixed(0), mixed(1));
  for (int i = 0; i < 24; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    const double at_a = mixed(a), at_b = mixed(b);
    best = std::min({best, at_a, at_b});
    if (at_a < at_b)
      high = b;
    else
      low = a;
  }
  return best;
}

}  // namespace verisim::ruler

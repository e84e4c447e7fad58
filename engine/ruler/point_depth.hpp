// The depth of a point in a solid: the nearest of the solid's own points on its faces, edges and corners. Private to
// this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/ruler/foot.hpp"
#include "engine/ruler/values.hpp"

namespace verisim::ruler {

class PointDepth {
 public:
  explicit PointDepth(const Csg& csg) : csg_(csg), values_(csg), there_(csg) {}

  double operator()(const Vector3d& x) {
    values_.at(x);
    const double tree = values_.tree();
    if (tree >= 0 && !is_between_touching()) return 0;
    least_ = kInfinity;
    near_.clear();
    order_.clear();
    for (std::uint32_t i = 0; i < values_.size(); ++i) order_.push_back({std::abs(values_[i]), i});
    std::sort(order_.begin(), order_.end());
    for (const auto& [distance, i] : order_) {
      if (distance >= least_) break;
      if (is_own({{i}}, 1, foot(csg_.dividers(), x, {{i}}, 1)))
        least_ = distance;
      else
        near_.push_back(i);
    }
    edges_and_corners(x);
    return std::isinf(least_) ? std::max(0.0, -tree) : least_;
  }

 private:
  using Set = DividerSet;
  static constexpr std::size_t kNearMax = 8;

  /// On a surface where two primitives of the solid touch the tree's value is 0; the solid goes on on both sides.
  bool is_between_touching() {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (std::abs(values_[i]) > kOnSurface) continue;
      if (values_.tree_with(i, -kInfinity) < 0 && values_.tree_with(i, kInfinity) < 0) return true;
    }
    return false;
  }

  /// Is y, on the first n of the set, a point of the solid's surface? Not if all of these dividers' sides are inside.
  bool is_own(const Set& set, std::size_t n, const Vector3d& y) {
    if (!y.allFinite()) return false;
    there_.at(y);
    bool some_in = false, some_out = false;
    for (std::size_t sides = 0; sides < (std::size_t{1} << n); ++sides) {
      for (std::size_t k = 0; k < n; ++k) {
        if (std::abs(there_[set[k]]) > kOnSurface && sides == 0) return false;
        there_[set[k]] = (sides >> k & 1) != 0 ? kInfinity : -kInfinity;
      }
      const double tree = there_.tree();
      some_in = some_in || tree <= kOnSurface;
      some_out = some_out || tree >= -kOnSurface;
    }
    return some_in && some_out;
  }

  void edges_and_corners(const Vector3d& x) {
    // Every divider nearer than the least so far that has no foot of its own can have an edge or a corner.
    const std::size_t n = std::min(near_.size(), kNearMax);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < values_.size(); ++j) {
        const auto second = static_cast<std::uint32_t>(j);
        if (second == near_[i] || std::abs(values_[j]) >= least_) continue;
        meet(x, {near_[i], second}, 2);
        for (std::size_t k = j + 1; k < values_.size(); ++k)
          if (k != near_[i] && std::abs(values_[k]) < least_)
            meet(x, {near_[i], second, static_cast<std::uint32_t>(k)}, 3);
      }
  }
  void meet(const Vector3d& x, const Set& set, std::size_t n) {
    const Vector3d y = foot(csg_.dividers(), x, set, n);
    const double distance = (y - x).norm();
    if (distance < least_ && is_own(set, n, y)) least_ = distance;
  }

  const Csg& csg_;
  Values values_, there_;
  std::vector<std::pair<double, std::uint32_t>> order_;
  std::vector<std::uint32_t> near_;
  double least_ = kInfinity;
};

}  // namespace verisim::ruler

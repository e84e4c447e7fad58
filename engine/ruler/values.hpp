// The values of a solid's dividers at a point, and its tree with some of them on a side of our choice. Private to this
// folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/ruler/csg.hpp"

namespace verisim::ruler {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// m, within which a point counts as on a surface: far above roundings (1e-16 of a scene of metres), far below what is
/// measured.
inline constexpr double kOnSurface = 1e-11;
inline constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

/// The values of a solid's dividers at a point.
class Values {
 public:
  explicit Values(const Csg& csg) : csg_(csg), values_(csg.dividers().size()) {}
  void at(const Vector3d& x) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = value_at(csg_.dividers()[i], x);
  }
  double& operator[](std::size_t i) { return values_[i]; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] double tree() const { return csg_.value(values_); }
  /// The tree with one divider on a side of our choice.
  [[nodiscard]] double tree_with(std::size_t divider, double value) {
    const double kept = values_[divider];
    values_[divider] = value;
    const double result = tree();
    values_[divider] = kept;
    return result;
  }

 private:
  const Csg& csg_;
  std::vector<double> values_;
};

/// The side of a divider on which nothing of the solid is near: +1 where the divider's values are above 0, -1 where
/// they are below, 0: there is none. `margin` [m]: the solid is farther off than that, on that side.
///
/// A point x within the solid can then be no deeper than its distance |g(x)| to the divider if |g(x)| and what x is
/// away from here are together less than the margin: the straight way to the divider and a step further leads out of
/// the solid, and so through its surface.
struct OutSide {
  double sign = 0, margin = 0;
};

/// Looks no further once there is as much margin as is wanted.
inline OutSide out_side_of(Values& values, std::size_t divider, double wanted) {
  const double below = values.tree_with(divider, -kInfinity), above = values.tree_with(divider, kInfinity);
  OutSide out = above >= below ? OutSide{1, above} : OutSide{-1, below};
  if (out.margin < 0) return {};
  // Where another divider bounds two primitives (a hole as deep as its block is high) the tree is 0 on it, though both
  // of its sides are outside.
  const double kept = values[divider];
  values[divider] = out.sign * kInfinity;
  for (std::size_t i = 0; i < values.size() && out.margin < wanted; ++i) {
    if (i == divider || std::abs(values[i]) != out.margin) continue;  // not the one that decides
    out.margin = std::max(out.margin, std::min(values.tree_with(i, -kInfinity), values.tree_with(i, kInfinity)));
  }
  values[divider] = kept;
  return out;
}

}  // namespace verisim::ruler

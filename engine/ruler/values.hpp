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
  double operator[](std::size_t i) const { return values_[i]; }
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

/// The side of a solid's surface, as Csg::side; where that leaves it open, both sides of the dividers of both senses
/// are tried, two of them at once at most. What lies on such a divider is outside if what lies beside it is.
inline int side_of(const Csg& csg, std::vector<std::int8_t>& sides, int splits = 2) {
  const int side = csg.side(sides);
  if (side != 0 || splits == 0) return side;
  for (const std::uint32_t i : csg.of_both_senses()) {
    if (sides[i] != 0) continue;
    sides[i] = -1;
    const int below = side_of(csg, sides, splits - 1);
    sides[i] = 1;
    const int above = below != 0 ? side_of(csg, sides, splits - 1) : 0;
    sides[i] = 0;
    if (below != 0 && below == above) return below;
  }
  return 0;
}

}  // namespace verisim::ruler

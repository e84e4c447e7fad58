// Conditions that contracts speak of. VERISIM_ASSERT asks them of arguments at the doors of a folder; checks at the
// edge ask the same of input and throw an Error, so that what the edge let in never breaks a contract.
//
// All are false for what is not a number, but is_symmetric: a simulation that diverges fills its matrices with
// infinities within a frame, and that is found, and told to the user, at the frame's end.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/pose.hpp"

namespace verisim {

/// How far the square of a unit vector's length may be from 1. Files give directions with six or seven digits; nothing
/// computed here is off by more than 1e-14. What uses a direction then errs by 1e-6 of its result at most.
inline constexpr double kUnitTolerance = 1e-6;

/// How far mirrored entries of a symmetric matrix may differ, relative to its largest entry. Sums of a million products
/// round to 1e-10 of that; a matrix put together wrongly is off by far more.
inline constexpr double kSymmetryTolerance = 1e-9;

[[nodiscard]] inline bool is_positive(double x) {
  return std::isfinite(x) && x > 0;
}
[[nodiscard]] inline bool is_not_negative(double x) {
  return std::isfinite(x) && x >= 0;
}
/// In [0, 1].
[[nodiscard]] inline bool is_fraction(double x) {
  return x >= 0 && x <= 1;
}

[[nodiscard]] inline bool is_finite(const Vector3d& v) {
  return v.allFinite();
}
[[nodiscard]] inline bool is_unit(const Vector3d& v) {
  return std::abs(v.squaredNorm() - 1) < kUnitTolerance;
}
[[nodiscard]] inline bool is_unit(const Quaterniond& q) {
  return std::abs(q.squaredNorm() - 1) < kUnitTolerance;
}
/// Somewhere, and turned by a rotation: what a body or a device can have.
[[nodiscard]] inline bool is_placement(const Pose& X) {
  return is_finite(X.position) && is_unit(X.rotation);
}

template <typename Square>
[[nodiscard]] bool is_symmetric(const Square& m) {
  const double largest = m.cwiseAbs().maxCoeff();
  return !((m - m.transpose()).cwiseAbs().maxCoeff() > kSymmetryTolerance * largest);
}

/// Each element above the one before.
template <typename Range>
[[nodiscard]] bool is_ascending(const Range& range) {
  return std::adjacent_find(std::begin(range), std::end(range),
                            [](const auto& a, const auto& b) { return !(a < b); }) == std::end(range);
}

}  // namespace verisim

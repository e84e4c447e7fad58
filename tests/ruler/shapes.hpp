// Solids as texts, and what the ruler says of two of them.
#pragma once

#include <cmath>
#include <string>

#include "engine/base/random.hpp"
#include "engine/ruler/ruler.hpp"

namespace verisim::ruler::test {

inline Shape shape(const std::string& solid) {
  return Shape({{"part", solid, {}}});
}

inline Pose at(double x, double y, double z, const Vector3d& turn = Vector3d::Zero()) {
  return {{x, y, z}, rotation_from_vector(turn)};
}

/// Ends late, so that what it misses is small.
inline constexpr Accuracy kFine{.absolute = 1e-9, .relative = 1e-3, .pieces_max = 60'000};

inline Overlap of(const std::string& a, const Pose& X_WA, const std::string& b, const Pose& X_WB = {},
                  const Accuracy& accuracy = kFine) {
  return overlap(shape(a), X_WA, shape(b), X_WB, accuracy);
}

/// A placement near the origin, any way up.
inline Pose random_pose(const RandomStream& random, std::uint64_t first, double reach) {
  const auto between = [&](std::uint64_t k) { return 2 * random.uniform(first + k) - 1; };
  const Vector3d turn(between(3), between(4), between(5));
  return {reach * Vector3d(between(0), between(1), between(2)), rotation_from_vector(3 * turn)};
}

}  // namespace verisim::ruler::test

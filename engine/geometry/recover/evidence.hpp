// Is a surface that passes through some points what they stand for, or would others pass through them as well?
#pragma once

#include <span>

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

/// How many points a surface of this kind must pass through to be meant by them.
[[nodiscard]] std::size_t fewest_points(Kind kind);

/// Five different places around each circle that makes the surface, or four at equal steps: a circle through three
/// points, or through the corners of a trapezoid, says nothing.
[[nodiscard]] bool is_evident(const SurfaceValue& surface, std::span<const Vector3d> points, double tolerance,
                              const RecoverThresholds& thresholds);

}  // namespace verisim::recover

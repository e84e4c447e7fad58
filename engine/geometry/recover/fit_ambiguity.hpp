// Guards against ambiguous fits: do some points determine a surface, or would other surfaces pass through them as well?
#pragma once

#include <span>

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

/// True if the points determine the surface. They must be enough, leave their best plane, and determine each circle
/// that generates the surface: by five different places around it, or by four at equal steps. A circle through three
/// points, or through the corners of a trapezoid, is no evidence. Planes: always true.
/// @param tolerance  m, of points from the surface
/// @pre the tolerance is finite and above 0
[[nodiscard]] bool is_unambiguous(const SurfaceValue& surface, std::span<const Vector3d> points, double tolerance,
                                  const RecoverThresholds& thresholds);

}  // namespace verisim::recover

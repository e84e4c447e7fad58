// Solids described by primitives and booleans of them, for scenes without files. A description only: load_solid (see
// loader.hpp) has OpenCASCADE build it, so a Solid has exact b-reps like a STEP file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim {

/// Axis along z, centred at the origin. Lengths [m].
struct Solid {
  enum class Kind { box, cylinder, cone, sphere, tube, torus, difference, sum, intersection, placed };
  Kind kind = Kind::box;
  /// box: x, y, z.  cylinder: radius, height.  cone: radius1 (at -z), radius2, height.  sphere: radius.
  /// tube: outer, inner, height.  torus: ringRadius (of the middle of its tube), radius (of the tube).  others: none.
  std::vector<double> sizes;
  std::vector<std::shared_ptr<const Solid>> children;  ///< difference, sum, intersection: two; placed: one
  Pose placement;                                      ///< placed only: applied to the child

  /// A canonical text, equal for equal solids: the name under which a run file stores the result. @pre no child is null
  [[nodiscard]] std::string text() const;
};

/// Throws Error(input) with the reason if a size is not finite, not positive, or does not fit (inner >= outer …).
void check(const Solid& solid);

}  // namespace verisim

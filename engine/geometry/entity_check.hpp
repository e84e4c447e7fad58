// Is a surface or curve one? Everything that takes entities from outside asks here, so that a cone of negative radius
// is as little a cone to the voxels as it is to a script.
#pragma once

#include <optional>
#include <string>

#include "engine/geometry/entity.hpp"

namespace verisim {

/// What is wrong with a surface, and what to give instead: a sentence's end, to be put after "a cone", for instance
/// "has a radius of -0.01 m but it must be 0 or more". Nothing for one that is sound:
///   - its numbers are finite, its directions have length 1 (to 1e-6) and its x axis is square to them;
///   - cylinder, sphere and torus have radii above 0, a cone's is 0 or more (at 0 it begins at its tip);
///   - a cone's half angle lies between 0 and pi/2, both excluded.
/// A torus may meet itself (minor radius above the major one). OtherSurface is always sound: it promises nothing.
[[nodiscard]] std::optional<std::string> fault_of(const Surface& surface);

/// The same for a curve: radii above 0, directions of length 1. OtherCurve is always sound.
[[nodiscard]] std::optional<std::string> fault_of(const Curve& curve);

}  // namespace verisim

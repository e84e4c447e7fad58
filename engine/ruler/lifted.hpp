// A part's triangles lifted onto the surfaces that its faces were recognized or recovered as: to say what the bodies
// overlap by, measured by those surfaces, beside what they do by the triangles as they came.
//
// Corners move to the nearest point of their faces' surfaces (one, two or three at once); sides that are farther than a
// tolerance from these are halved, and the middles move too, until none is. What has no known surface stays.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/ruler/divider.hpp"

namespace verisim::ruler {

/// A part's triangles with the surface that each stands for, if one is known.
struct FacedTriangles {
  std::vector<Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> face_of_triangle;  ///< kNoFace: none
  std::vector<std::optional<Divider>> faces;    ///< nothing: of a kind that is not known
};
inline constexpr std::uint32_t kNoFace = static_cast<std::uint32_t>(-1);

struct Lifted {
  FacedTriangles triangles;
  double off = 0;         ///< m, from the surfaces at most (to second order in the sides' length)
  double moved = 0;       ///< m, the farthest that a corner went
  std::size_t known = 0;  ///< triangles whose surface is known
};

/// @param tolerance [m] of the middles of sides. 1 us for each triangle that results.
/// @pre as many faces of triangles as triangles; indices are below what they count; tolerance > 0
[[nodiscard]] Lifted lifted(FacedTriangles part, double tolerance);

}  // namespace verisim::ruler

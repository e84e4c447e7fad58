// The facets of a mesh and what they border on.
#pragma once

#include <vector>

#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// Two facets that meet at a smaller angle can be pieces of one round surface: a tessellation of 12 facets around is
/// taken for round, one of 10 for a prism.
inline constexpr double kSmooth = 0.8526401643540922;  // cosine of 31.5 degrees

/// Where a facet meets another.
struct FacetSide {
  std::uint32_t facet;  ///< the other; kNone: open or shared by more than two
  double length;        ///< m
  Vector3d middle;
  Vector3d direction;  ///< of the longest piece, unit
  bool smooth;
};

struct Facet {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> vertices;  ///< ascending
  std::vector<FacetSide> sides;         ///< ascending by facet
  Vector3d normal = Vector3d::Zero(), center = Vector3d::Zero();
  double area = 0;
};

struct Facets {
  std::vector<Facet> all;
  std::vector<std::uint32_t> of_triangle;
};

/// @param tolerance  m
[[nodiscard]] Facets facets_of(const CanonicalMesh& mesh, double tolerance);

}  // namespace verisim::recover

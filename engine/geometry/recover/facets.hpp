// The facets of a mesh and what they border on.
#pragma once

#include <vector>

#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// Where a facet meets another.
struct FacetSide {
  std::uint32_t facet;  ///< the other; kNone: open or shared by more than two
  double length;        ///< m
  Vector3d middle;
  Vector3d direction;  ///< of the longest piece, unit
  bool smooth;         ///< they can be pieces of one round surface
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

/// @param tolerance  m  @param cos_smooth  cosine of the angle between normals up to which a side is smooth
[[nodiscard]] Facets facets_of(const CanonicalMesh& mesh, double tolerance, double cos_smooth);

}  // namespace verisim::recover

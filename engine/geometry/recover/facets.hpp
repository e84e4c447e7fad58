// The facets of a mesh (maximal flat pieces) and their adjacency. Part coordinates [m].
#pragma once

#include <vector>

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// The border between a facet and one neighbour.
struct FacetSide {
  std::uint32_t facet;  ///< the neighbour; kNone: open, or more than two facets meet
  double length;        ///< m
  Vector3d middle;      ///< m
  Vector3d direction;   ///< unit, of its longest segment
  bool smooth;          ///< the angle between the normals is small enough for one curved surface
};

struct Facet {
  std::vector<std::uint32_t> triangles;  ///< ascending
  std::vector<std::uint32_t> vertices;   ///< ascending
  std::vector<FacetSide> sides;          ///< ascending by facet
  Vector3d normal = Vector3d::Zero(), center = Vector3d::Zero();
  double area = 0;  ///< m^2
};

struct Facets {
  std::vector<Facet> all;
  std::vector<std::uint32_t> of_triangle;  ///< number of each triangle's facet
};

/// @param tolerance   m, of vertices from their facet's plane
/// @param cos_smooth  cosine of the largest angle between normals at which a side is smooth
[[nodiscard]] Facets facets_of(const CanonicalMesh& mesh, double tolerance, double cos_smooth,
                               const RecoverThresholds& thresholds);

}  // namespace verisim::recover

// Faces and edges of a part that came as bare triangles: planes, cylinders, cones, spheres and tori found in them, the
// lines, circles and ellipses between those, and `other` for what fits nothing.
//
// Source: region growing (CGAL's Shape_detection for facets, own regions on top of it for round surfaces), least
// squares through vertices: a tessellation's vertices lie on the surface it stands for, so parameters are as exact as
// the file's numbers. Part coordinates, m. The result is the same for every order of triangles and vertices, every
// time.
//
// What it cannot know: a prism of 12 or more equal sides is taken for a cylinder; a round surface of fewer than four
// facets becomes planes; coplanar or coaxial pieces that do not touch are faces of their own; `Face::area` is that of
// the triangles.
#pragma once

#include "engine/geometry/part.hpp"

namespace verisim {

struct RecoverOptions {
  /// m, of vertices from their surface; 0: found out. Single precision's is tried first; a hundred times as much at
  /// most (numbers of five digits) where that explains far more.
  double tolerance = 0;
  /// rad, 31.5 degrees: the largest angle between neighbouring facets that still counts as round.
  double round_step_max = 0.5497787143782138;
};

/// Fills faces, edges and face_of_triangle of a part that has none, with a note on what was found. `exact` stays false.
/// About 20 us per triangle, 0.5 ms where nothing fits. @pre !part.has_brep()
void recover_brep(Part& part, const RecoverOptions& options = {});

}  // namespace verisim

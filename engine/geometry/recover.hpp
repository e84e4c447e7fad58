// B-rep recovery (reverse engineering): faces and edges of a part that came as bare triangles. Finds planes, cylinders,
// cones, spheres and tori, and the lines, circles and ellipses between them. Triangles that no surface fits become
// faces of kind `other`. Part coordinates, m.
//
// Method: region growing (CGAL's Shape_detection for facets, own code for curved surfaces) with least-squares fits to
// vertices, then region merging. A tessellation's vertices lie on the surface that it stands for, so parameters are as
// exact as the file's numbers. The result does not depend on the order of triangles and vertices.
//
// Limits.
//   Cylinder or prism  A mesh cannot tell: a regular prism has the vertices of the cylinder around it. Cylinders of
//                      12 to 24 facets are far more common in files than such prisms, so the angle between facets
//                      decides: up to `round_step_max` they are curved. By default 12 sides are a cylinder and 11 are
//                      planes.
//   Few facets         A curved surface of fewer than four facets becomes planes.
//   Separate pieces    Coplanar or coaxial pieces that do not touch are separate faces.
//   Area               Face::area is that of the triangles.
//   Free forms         A piece of a free form that is a torus to the tolerance, with more than 200 triangles, becomes
//                      one.
#pragma once

#include "engine/geometry/part.hpp"

namespace verisim {

/// When a fitted surface is taken for the part's. Heuristic: chosen on drawn and recorded models; how little what is
/// found hangs on the numbers is in recover_thresholds_test.
struct RecoverThresholds {
  double longer_step = 1.1;         ///< one chord against the mean of two, which the angle between facets measures
  double tight_fit = 0.5;           ///< of the tolerance, for a region's final fit: a worse one is cut from a free form
  double sagitta_min = 50;          ///< tolerances off the best plane: flatter points fit any kind
  double equal_step = 0.02;         ///< relative: steps around a circle that differ by less are meant as equal
  double nearly_tangent = 0.9;      ///< cosine of an inlier's normal to the surface's
  double parameter_area_min = 0.5;  ///< of a triangle's own area, for its image in the surface's parameters
  double sharp_edge_slack = 30;     ///< tolerances: drawings are less exact than numbers
  double larger_by = 1.001;         ///< in area: required of a kind that is less simple
  double narrower = 0.25;           ///< of a plane's width: the width of a neighbour that curves away from it
  double mostly_sharp = 0.6;        ///< of a plane's border, by length
  double mostly_smooth = 0.7;       ///< of the border of a patch of a free form, by length
};

struct RecoverOptions {
  /// m, largest distance of a face's vertices from its surface. 0: chosen automatically. The rounding of single
  /// precision (3e-7 of the extent) is tried first; at most 150 times as much (numbers of five digits) is taken if the
  /// description by faces becomes much shorter. Where a torus ends at a sharp edge, vertices may be off by 30 times the
  /// tolerance, as the edges of CAD programs are.
  double tolerance = 0;
  /// rad, the largest angle between neighbouring facets of one curved surface: 31.5 degrees.
  double round_step_max = 0.5497787143782138;
  RecoverThresholds thresholds = {};
};

/// Fills faces, edges and face_of_triangle of a part, and adds a note on the kinds found. `exact` stays false.
/// About 10 us per triangle, 0.1 ms where nothing fits. @pre !part.has_brep(); is_whole(part.mesh); vertices are
/// finite; the tolerance is finite and not negative, the step between 0 and pi
void recover_brep(Part& part, const RecoverOptions& options = {});

}  // namespace verisim

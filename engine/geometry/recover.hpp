// Faces and edges of a part that came as bare triangles: planes, cylinders, cones, spheres and tori found in them, the
// lines, circles and ellipses between those, and `other` for what fits nothing.
//
// Source: region growing (CGAL's Shape_detection for facets, own regions on top of it for round surfaces), least
// squares through vertices: a tessellation's vertices lie on the surface it stands for, so parameters are as exact as
// the file's numbers. Part coordinates, m. The result is the same for every order of triangles and vertices, every
// time.
//
// Round or a prism: a mesh does not say. A regular prism has the vertices of the cylinder around it, facet by facet,
// and cylinders of 12 to 24 facets are far more common in files than such prisms. So the angle at which facets meet
// decides: up to `round_step_max` they are round. By default 12 sides are a cylinder, 11 are planes; who knows better
// says so.
//
// What else it cannot know: a round surface of fewer than four facets becomes planes; coplanar or coaxial pieces that
// do not touch are faces of their own; `Face::area` is that of the triangles. Free forms are `other`, but for the piece
// of one that is, to the tolerance, a torus of more than 200 triangles.
#pragma once

#include "engine/geometry/part.hpp"

namespace verisim {

/// What a surface has to be to be believed. Heuristic: chosen on drawn and recorded models; how little what is found
/// hangs on the numbers is in recover_thresholds_test.
struct RecoverThresholds {
  double longer_step = 1.1;  ///< of one chord, against the mean of two that the angle between facets is
  double snug = 0.5;  ///< of the tolerance: all vertices of a grown surface are within, or it is cut from a free form
  double bulge = 50;  ///< tolerances off the nearest plane: what is flatter fits anything
  double equal_step = 0.02;      ///< relative: by so much steps around a circle may differ and still be meant as equal
  double nearly_tangent = 0.9;   ///< cosine of a regular triangle's normal to the surface's
  double covers = 0.5;           ///< of a triangle's area, in the surface's coordinates
  double rim = 30;               ///< tolerances, at sharp edges: of drawings, against that of numbers
  double larger_by_far = 1.001;  ///< in area: what a kind that is less simple has to explain
  double narrower = 0.25;        ///< of a plane's width: a neighbour that curves away from it
  double mostly_sharp = 0.6;     ///< of a plane's border
  double mostly_smooth = 0.7;    ///< of a patch's border: it is of a free form
};

struct RecoverOptions {
  /// m, of every vertex of a face from its surface; 0: found out. Single precision's is tried first (3e-7 of the
  /// extent); 150 times as much at most (numbers of five digits) where that explains far more. Where a torus ends
  /// at a sharp edge, vertices may be off by 30 times that: as far as drawing programs' own edges are.
  double tolerance = 0;
  /// rad, 31.5 degrees: the largest angle at which neighbouring facets meet that can be pieces of one round surface.
  double round_step_max = 0.5497787143782138;
  RecoverThresholds thresholds = {};
};

/// Fills faces, edges and face_of_triangle of a part that has none, with a note on what was found. `exact` stays false.
/// About 10 us per triangle, 0.1 ms where nothing fits. @pre !part.has_brep(), vertices finite,
/// is_whole(part.mesh); the tolerance is finite and not negative, the step between 0 and pi
void recover_brep(Part& part, const RecoverOptions& options = {});

}  // namespace verisim

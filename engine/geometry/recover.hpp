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

#include <array>
#include <cstddef>

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
  double description_gain = 2;      ///< times shorter: what a larger tolerance has to make of a description by faces

  // Facets and their surroundings.
  double same_normal = 0.9998476951563913;  ///< cosine of 1 degree: normals of one facet differ by no more
  double sliver = 20;                       ///< tolerances: the normal of a triangle of less height is unreliable
  double noise = 4;                         ///< tolerances: nearer to an axis, to each other, or lower, is noise
  double fillet_span = -0.2;    ///< cosine of 102 degrees: a fan spans at most a quarter of a tube, a fillet
  double side_parallel = 0.7;   ///< cosine: a facet's sides that a strip leaves through, along or across
  std::size_t strip_steps = 4;  ///< facets of a strip to each side
  std::array<std::size_t, 4> ring_sizes = {2, 3, 6, 12};  ///< smooth sides from a seed: samples from narrow to wide
  std::size_t retry_steps = 3;   ///< smooth sides from a new region: facets within are tried again
  std::size_t failed_steps = 2;  ///< smooth sides from a seed without a fit: facets within are not tried
  std::size_t few_facets = 4;    ///< that meet smoothly: they are planes, a curved surface has more

  // Fits.
  /// By SurfaceKind. Through fewer points a surface passes by chance: kinds have 3, 5, 6, 4 and 7 parameters, and a
  /// whole mesh of points to choose from.
  std::array<std::size_t, 5> points_min = {3, 8, 8, 9, 14};
  std::size_t places_min = 5;        ///< around a circle; one fewer at equal steps
  std::size_t points_of_a_fit = 64;  ///< of a first fit: more say no more of seven parameters
  double near_fit = 30;              ///< tolerances, root of the mean square: a fit this near may improve slowly
  double fine_fit = 1e-3;            ///< tolerances, likewise: a fit this near is finished
  double fast = 0.5;                 ///< times the cost after a step: what is not near has to get there fast
  double settled = 0.99;             ///< times the cost after a step: one that lowers it by less is the last
  double narrowest_cone = 0.005;     ///< tangent of the half angle: less is a cylinder
  double widest_cone = 200;          ///< likewise: more is a plane
  double largest_radius = 1000;      ///< sizes of the sample: beyond it is flat

  // Free forms: their patches pass for surfaces by chance.
  std::size_t patch_triangles_max = 200;  ///< a larger region is a surface
  std::size_t cluster_min = 12;           ///< patches of a cluster
  std::size_t triangles_each_max = 30;    ///< mean triangles of its patches

  // Edges.
  double curve_slack = 3;            ///< tolerances: the intersection of two surfaces is off where both are
  double not_parallel = 1e-8;        ///< 1 - cosine: axes that differ by more than 1.4e-4 rad are not one
  double section_cosine_min = 1e-3;  ///< of a plane's normal to a cylinder's axis: less cuts no ellipse, but lines
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

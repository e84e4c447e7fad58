// The collision model of a body whose entities are known precisely. It has two parts: faces (surface, trim, edges to
// the neighbours), and features, the curves and points of the body that can touch another body's faces first. Made
// once, at load; constant afterwards. Body coordinates [m].
//
// A feature is a curve or point that carries a ball of some radius:
//   - an edge or a corner (radius 0);
//   - the centre of a sphere, the ring of a torus;
//   - the axis of a pin or cone. The balls that fill a cone have a radius that grows along the axis.
// Along a straight line the distance to a plane, a hole or a conical hole is linear or concave, so its least value lies
// at an end of the line. The side of a pin or cone therefore touches such a face first at its end edges, and these are
// enough. The axes are needed only against the sides of other pins and cones (Feature::is_axis): a ball or torus has a
// feature of its own, that finds every contact with such a side.
//
// Sampling and contact reduction. A curve is cut into segments no longer than the spacing. A segment has one sample,
// its middle; the search moves it to the closest place of the segment (exact_link.hpp). A group of neighbouring
// segments makes one row, that of its closest place. A group has at most four segments; on an arc it spans at most half
// a radian, because farther places push in different directions. A group that coincides with the face, or lies beside
// a plane, has rows at its ends as well.
//
// Stiffness. An edge is a line of springs with `line_stiffness` per metre; a point counts as `point_length` of it. The
// sum over samples so tends to an integral over the line as the spacing shrinks. The default is that of steel on steel
// (half of E / (1 - nu^2) = 2.3e11 N/m^2). With it, a pin of 150 mm that leans by half a degree and is pressed into
// both rims of its hole with 250 N overlaps by 1 % of a clearance of 0.01 mm.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/exact/box_tree.hpp"
#include "engine/exact/trim.hpp"
#include "engine/geometry/part.hpp"

namespace verisim::exact {

struct BodyOptions {
  double spacing = 0;               ///< m, > 0: longest segment; usually the voxel size
  double line_stiffness = 1.15e11;  ///< N/m per m of an edge
  double point_length = 0.004;      ///< m: a corner is as stiff as an edge of this length
  // Heuristic: exact_thresholds_test says how little results depend on these.
  double smooth = 0.0087;    ///< sine of the angle between its two faces, 0.5 degrees: below it an edge is smooth
  double group_angle = 0.5;  ///< rad, largest arc of a group: farther segments push in different directions
  int cells_max = 48;  ///< of a trim along each side of its chart: 2,304 cells are 20 kB, and borders a fiftieth wide
  double near_pole = 0.9;  ///< sine of a latitude: beyond it a ball's turns are so short that all are near each other
  double sagitta =
      0.03;  ///< of its box: how far a round face may bulge out of that of its triangles; chords of 0.5 rad
  /// m. How far beyond an edge's end at a corner with a concave edge a place counts as within: deeper than contacts go.
  double beyond_end = 5e-5;
  double convex_corner = 0.25;  ///< sine: a curve's first chord leaves its tangent by up to pi / 16, 0.2
  double same_corner = 1e-7;    ///< m: ends nearer than this are one corner; CAD kernels' own tolerance
};

/// Convex: the angle inside the material is below 180 degrees. Smooth: the faces are tangent (to 0.5 degrees).
enum class Convexity : std::uint8_t { convex, concave, smooth };

/// An edge between two faces, and for which points it decides which of the two owns them (edge_ownership.hpp).
struct ExactEdge {
  std::array<std::uint32_t, 2> faces{};  ///< numbers in ExactBody::faces
  Convexity convexity = Convexity::smooth;

  /// How the extent of the edge is tested. Full circles and other curves: `all`, everywhere within.
  ///   line  within where |direction . (p - center)| <= half
  ///   arc   center: of the circle; direction: towards the arc's middle; perpendicular: a quarter turn on; half: cosine
  ///         of half the arc
  enum class Extent : std::uint8_t { line, arc, all };
  Extent extent = Extent::all;
  Vector3d center = Vector3d::Zero(), direction = Vector3d::Zero(), perpendicular = Vector3d::Zero();
  double half = 0;
  double beyond_end = 0, same_corner = 0;  ///< m, those of BodyOptions
  /// [face][0: at its beginning, 1: at its end] Does the edge limit the face beyond that end too? True in two cases:
  /// all edges at that corner are convex, so the material is inside of all of their faces; or the face's own corner
  /// there is convex (below 180 degrees), so whoever is across the edge is off the face.
  std::array<std::array<bool, 2>, 2> limits_beyond_end = {};
  /// [face][end] At a corner of the face that is sharper than 270 degrees, as that of a triangular hole, the strip
  /// beside this edge goes on behind the edge that it meets there. Then the direction that leaves the face across that
  /// edge; else zero.
  std::array<std::array<Vector3d, 2>, 2> sharp_corner = {
      {{Vector3d::Zero(), Vector3d::Zero()}, {Vector3d::Zero(), Vector3d::Zero()}}};
  std::array<bool, 2> has_sharp_corner = {};                            ///< [face]
  std::array<Vector3d, 2> ends = {Vector3d::Zero(), Vector3d::Zero()};  ///< m, where it begins and ends, if it does

  /// True if the edge limits `face` near the point p: p lies within the extent, or limits_beyond_end holds. At a corner
  /// with a concave edge the material is inside of either of two faces; a point that is inside of the face across
  /// (distance < 0) counts as within up to `beyond_end` beyond the end, and behind the other edge of a sharp corner.
  /// Farther behind that one it does not limit. One that is outside counts as within up to `same_corner`: what lies in
  /// the corner may be beyond the ends of both of its edges, by a rounding.
  /// @param distance  of p from the face across the edge [m]
  [[nodiscard]] bool limits_face_at(std::uint32_t face, const Vector3d& p, double distance) const;

  /// Smooth edges only: points along the edge, and at each the direction that leaves either face across the edge.
  struct Mark {
    Vector3d point;
    std::array<Vector3d, 2> outward;
  };
  std::vector<Mark> marks;
  Bounds bounds;
};

struct ExactFace {
  std::optional<AnalyticSurface> surface;  ///< none: freeform; contacts with it are the voxels'
  std::optional<Trim> trim;                ///< present if the surface is
  Bounds bounds;
};

/// A curve and the ball that it carries.
struct Feature {
  enum class Kind : std::uint8_t { line, arc, point };
  Kind kind = Kind::point;
  /// line: p(t) = origin + t x.  arc: p(t) = origin + cos t x + sin t y (circles and ellipses).  point: origin.
  Vector3d origin = Vector3d::Zero(), x = Vector3d::Zero(), y = Vector3d::Zero();
  double radius = 0;                 ///< m, of the ball; of a line's at t = 0
  double radius_slope = 0;           ///< of a line's radius, by t
  double half_width = 0;             ///< of a segment, in t
  double half_length = 0;            ///< m, of a segment
  double stiffness = 0;              ///< N/m of one segment
  std::uint32_t group = 1;           ///< up to so many neighbouring segments make one row; at most kGroupMax
  std::uint32_t own_face = kNoFace;  ///< the face that the ball belongs to; a contact must lie on it
  bool is_axis = false;              ///< of a pin or cone
  bool closed = false;               ///< a full circle or ellipse
  std::uint32_t begin = 0, end = 0;  ///< samples [begin, end)
  /// Does the curve go on beyond the end of a sample's segment at which t has this sign?
  [[nodiscard]] bool goes_on(std::uint32_t sample, double t) const {
    return closed || (t < 0 ? sample > begin : sample + 1 < end);
  }
  [[nodiscard]] double radius_at(double c) const { return radius + radius_slope * c; }  ///< c as in sample_c
};

inline constexpr std::uint32_t kGroupMax = 4;

/// Neighbouring samples of one feature that the search tests together: at most kBlockSize.
struct SampleBlock {
  std::uint32_t feature, begin, end;  ///< samples [begin, end)
};
inline constexpr std::uint32_t kBlockSize = 32;

struct ExactBody {
  /// Parts that move as one, in body coordinates. A part without b-rep adds nothing, nor does a face without triangles
  /// or an edge without a polyline. @pre spacing and line_stiffness are finite and above 0, the other options not
  /// negative; meshes are whole (is_whole), edges name faces of their part
  ExactBody(std::span<const Part> parts, const BodyOptions& options);
  ExactBody() = default;  ///< of nothing: body_bytes.hpp fills it

  /// True if at least one face has a precise surface.
  [[nodiscard]] bool has_precise_faces() const { return precise_face_count > 0; }

  BodyOptions options;
  std::vector<ExactFace> faces;  ///< of all parts, one part after the other
  std::vector<ExactEdge> edges;
  std::vector<Feature> features;
  // n samples, the middles of the segments.
  std::vector<double> sample_c, sample_s;  ///< (n) arc: cosine and sine of t; line: t and 0; point: 0
  /// (n + 1) Where each sample's directions begin in `cone_directions`. They span the tangent cone of the body at the
  /// sample. A contact's normal must have no negative component along any of them (it lies in the normal cone), or the
  /// body would pass through the other's surface beside the sample.
  std::vector<std::uint32_t> cone_begin = {0};
  std::vector<Vector3d> cone_directions;  ///< unit
  std::vector<SampleBlock> blocks;
  BoxTree face_tree;   ///< over the faces with a surface
  BoxTree edge_tree;   ///< over the convex edges
  BoxTree block_tree;  ///< over the blocks, their balls included
  std::size_t precise_face_count = 0;
};

}  // namespace verisim::exact

// What a body collides by where its entities are known precisely: faces with their surfaces, trims and neighbours, and
// the features that can touch another body's faces first. Made once, at load; constant afterwards.
//
// Body coordinates [m]. A feature is a curve (or point) of the body that carries a ball of some radius: an edge or a
// corner (radius 0), the middle of a ball, the ring of a torus, the axis of a pin or cone (along which the balls that
// fill a cone grow). Along straight lines the distance to a plane, a hole or a conical hole is linear or concave, so
// where a pin's or a cone's side meets one of those, the side's ends decide: its edges are enough. What is left are
// round outsides against round outsides, and balls and rings.
//
// A curve is cut into segments no longer than the spacing. In the search a segment's sample slides along its own
// segment to the nearest place (exact_link.hpp); a group of neighbouring segments makes one row, that of the nearest of
// them: up to four, and on an arc those within half a radian, beyond which they push in different directions; where a
// group lies flush its ends have rows of their own.
//
// Stiffness: an edge is a line of springs with `line_stiffness` per metre, a point counts as `point_length` of it. So
// the sum over samples tends to an integral over the line as the spacing shrinks. The default is that of steel on steel
// (half of E / (1 - nu^2) = 2.3e11 N/m^2); it is what leaves an overlap of 1 % of a clearance of 0.01 mm where a lean
// of half a degree presses a pin of 150 mm into both rims of its hole with 250 N.
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
  double line_stiffness = 1.15e11;  ///< N/m per m
  double point_length = 0.004;      ///< m
  // Heuristic: how little results hang on these is in exact_thresholds_test.
  double smooth = 0.0087;  ///< sine of the angle between its two faces, 0.5 degrees: below it an edge is smooth
  double group_angle =
      0.5;  ///< rad: segments of an arc further apart push in different directions, each in its own row
};

/// How the material lies at an edge.
enum class Fold : std::uint8_t { convex, concave, smooth };

/// An edge between two faces, as each of them sees it.
struct ExactEdge {
  std::array<std::uint32_t, 2> faces{};  ///< numbers in ExactBody::faces
  Fold fold = Fold::smooth;
  /// A point may lie beyond the edge's end, and then the edge says nothing about it, unless the end is a corner where
  /// all edges are convex: there the material is inside of all of them. Nor is there a doubt for one of the two faces
  /// if its own corner there is less than half a turn wide: who is across the edge is off that face. Lines: `along` .
  /// (p - middle) beyond +-half. Arcs of circles: middle the circle's centre, `along` and `on` towards the arc's middle
  /// and a quarter turn on, half the cosine of half the arc. Others and full circles always speak. At a corner with a
  /// concave edge the material is inside of this or of the next: a little beyond the end the edge still speaks for a
  /// point inside of both.
  enum class Extent : std::uint8_t { line, arc, all };
  Extent extent = Extent::all;
  Vector3d middle = Vector3d::Zero(), along = Vector3d::Zero(), on = Vector3d::Zero();
  double half = 0;
  std::array<std::array<bool, 2>, 2> speaks_beyond = {};  ///< to either face: its beginning, its end
  /// Is it this edge that ends `face` there?
  /// @param distance  of p from the face across the edge [m]
  [[nodiscard]] bool speaks_for(std::uint32_t face, const Vector3d& p, double distance) const;

  /// Smooth edges only: points along the edge with, per point, the directions out of either face across the edge.
  struct Mark {
    Vector3d point;
    std::array<Vector3d, 2> out_of;
  };
  std::vector<Mark> marks;
};

struct ExactFace {
  std::optional<PreciseSurface> surface;  ///< none: another surface; the voxels answer for it
  std::optional<Trim> trim;               ///< with the surface
  Bounds bounds;
};

/// A curve and the ball that it carries.
struct Feature {
  enum class Kind : std::uint8_t { line, arc, point };
  Kind kind = Kind::point;
  /// line: p(t) = origin + t x.  arc: p(t) = origin + cos t x + sin t y (circles and ellipses).  point: origin.
  Vector3d origin = Vector3d::Zero(), x = Vector3d::Zero(), y = Vector3d::Zero();
  double radius = 0;                 ///< m, of the ball; of a line's at t = 0
  double growth = 0;                 ///< of a line's radius with t
  double half_width = 0;             ///< of a segment, in t
  double reach = 0;                  ///< m, half the length of a segment
  double stiffness = 0;              ///< N/m of one segment
  std::uint32_t group = 1;           ///< up to so many neighbouring segments make one row; at most kGroupMax
  std::uint32_t own_face = kNoFace;  ///< the face that the ball belongs to; must contain the place of contact
  bool against_round_only = false;   ///< axes of pins and cones: their ends decide against everything else
  [[nodiscard]] double radius_at(double c) const { return radius + growth * c; }  ///< c as in sample_c
};

inline constexpr std::uint32_t kGroupMax = 4;

/// Neighbouring segments of one feature, as the search takes them: at most kRun samples.
struct Run {
  std::uint32_t feature, begin, end;  ///< samples [begin, end)
};
inline constexpr std::uint32_t kRun = 32;

struct ExactBody {
  /// Parts that move as one, in body coordinates. Any part may be without b-rep: it then adds nothing. A face or edge
  /// that no triangle or polyline belongs to adds nothing. @pre spacing and line_stiffness are finite and above 0,
  /// the other options not negative; meshes are whole (is_whole), edges name faces of their part
  ExactBody(std::span<const Part> parts, const BodyOptions& options);

  /// Is anything known precisely?
  [[nodiscard]] bool knows_anything() const { return known_faces > 0; }

  BodyOptions options;
  std::vector<ExactFace> faces;  ///< of all parts, one part after the other
  std::vector<ExactEdge> edges;
  std::vector<Feature> features;
  // Samples, the middles of the segments; n of them.
  std::vector<double> sample_c, sample_s;  ///< (n) arc: cosine and sine of t; line: t and 0; point: 0
  /// (n + 1) Where each sample's wedge begins in `wedges`: directions from there into the body along its boundary. The
  /// normal of a contact has no negative part along any of them, for else the body would reach through the other's
  /// surface right beside it.
  std::vector<std::uint32_t> wedge_begin = {0};
  std::vector<Vector3d> wedges;
  std::vector<Run> runs;
  BoxTree face_tree;  ///< over the faces with a surface
  BoxTree run_tree;   ///< over the runs, their balls included
  std::size_t known_faces = 0;
};

}  // namespace verisim::exact

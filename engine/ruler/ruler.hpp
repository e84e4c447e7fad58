// The true overlap of two placed bodies, from their poses and their shapes alone: what judges the contacts that the
// engine computed, and so shares no code with engine/exact, engine/voxel, engine/geometry or engine/contact. A shape
// comes as data: the text of a Solid, and the tables of a part as a run file stores them (vertices, triangles, flags).
//
// The overlap of A and B is the larger of two depths: of A's surface in B, and of B's surface in A. The depth of A's
// surface in B is the largest distance to B's surface of the points of A's surface that lie within B, 0 if none does.
// It is d for a ball, a corner or an edge that reaches d below a plane, and for faces that overlap by d. Of two edges
// that cross it is the distance to the nearer face, not the way along which they would part: d sqrt(1/2) for square
// ones. No motion without rotation that is shorter than the overlap parts the bodies.
//
// Analytic where both parts are solids (solid_depth.hpp); else between triangles (triangle_depth.hpp): as they are, and
// lifted onto the surfaces that the parts' faces were recognized or recovered as (lifted.hpp). Two numbers, because a
// mesh is off from what it stands for, and contact may be judged by either. World coordinates, m. Deterministic.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/named_array.hpp"
#include "engine/ruler/csg.hpp"
#include "engine/ruler/depth.hpp"
#include "engine/ruler/lifted.hpp"
#include "engine/ruler/triangle_depth.hpp"

namespace verisim::ruler {

/// A part as data.
struct PartData {
  std::string name;
  std::string solid;  ///< text of a Solid in the body's coordinates; empty: it was not made from one
  /// vertices, triangles, flags; face_of_triangle, face_kind, face_surface; may be empty where there is a solid
  std::vector<NamedArray> tables;
};

/// What was measured. Surfaces: triangles that were lifted onto them.
enum class Source : std::uint8_t { solids, triangles, surfaces };

/// A body's shape, ready to be measured.
class Shape {
 public:
  /// Error(input) for texts and tables that are damaged.
  explicit Shape(const std::vector<PartData>& parts);
  /// Makes what overlap_of_surfaces needs. Seconds for large meshes.
  void lift();

 private:
  friend struct Measurer;
  friend double largest_move(const Shape& a, const Pose& X_BA, const Pose& Y_BA);
  friend std::string why_not(const Shape& a, const Shape& b);
  friend bool has_surfaces(const Shape& a, const Shape& b);
  struct Piece {
    std::string name;
    std::optional<Csg> solid;
    std::optional<Triangles> mesh;
    FacedTriangles faced;              ///< with its faces' surfaces; empty if none is known
    std::optional<Triangles> surface;  ///< `faced`, lifted
    double surface_off = 0;            ///< m, of `surface` from the surfaces
  };
  std::vector<Piece> pieces_;
};

struct Overlap {
  double depth = 0;                     ///< m
  double bound = 0;                     ///< m; the true overlap is in [depth, depth + bound]
  Vector3d place_W = Vector3d::Zero();  ///< where it is that deep
  Source source = Source::solids;       ///< triangles or surfaces, if any pair of parts was measured so
};

/// Why these two cannot be measured; empty: they can. A part that is neither a solid nor closed has no inside.
[[nodiscard]] std::string why_not(const Shape& a, const Shape& b);

/// @pre why_not(a, b) is empty; the poses are finite, their rotations unit
[[nodiscard]] Overlap overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                              const Accuracy& accuracy = {});

/// m; how far at most a point of `a` is, against b, in X_BA and in Y_BA. The overlap changes by no more.
[[nodiscard]] double largest_move(const Shape& a, const Pose& X_BA, const Pose& Y_BA);

/// Is there a pair of parts that is measured between triangles, and a known surface for some of these?
[[nodiscard]] bool has_surfaces(const Shape& a, const Shape& b);
/// As `overlap`, with the lifted triangles where there are some; what these are off widens the bound.
/// @pre Shape::lift was called for both
[[nodiscard]] Overlap overlap_of_surfaces(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                          const Accuracy& accuracy = {});

}  // namespace verisim::ruler

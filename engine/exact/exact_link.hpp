// The contacts between the precise entities of two bodies: all places where they touch or may touch by the end of the
// step, as rows of a convex problem (convex_step.hpp). One ExactLink per pair of bodies. Source: issue "hybrid method",
// item 7.
//
// The features of either body (exact_body.hpp) are tested against the faces of the other.
//   Closest place   Newton's method moves a sample to the place of its segment that is closest to the face. A segment
//                   has one: of an edge whose segment (a voxel long) passes a ring or pin twice, one place is found.
//   Gap and normal  are those of the precise surface, less the radius of the feature's ball.
//   Trim            A place whose foot is beyond the border of a face gives no row with it, unless it comes onto the
//                   face within the step.
//                   An edge that another edge of the face hides from the place does not border it there: the nearest
//                   edge says on which side a place is. So the far side of a key or hole says nothing.
//   Ownership       At a convex edge the solid is where both signed distances are negative, so the face with the
//                   larger distance owns the place. At a concave edge each face has its row, so the smaller distance
//                   counts.
//                   A face owns only what it can push: where its normal, and that of edge against edge, is outside of
//                   the mover's normal cone, the place stays with the face across. So a rim that lies on an edge, or
//                   comes down on it, is held by the one face that can hold it.
//   Concave corners Of a curve that ends at a concave corner, the end stays with a face that it meets there, where the
//                   face across has its row at another place of the curve.
//   Thin walls      A place behind a face, and not inside of the body or hardly so, is no place of that face: it comes
//                   through another one. What is behind a face and beside its border comes to it through another one.
//   Sharp corners   Beside a corner of a face that is sharper than 270 degrees (a triangular hole) the strip along one
//                   edge reaches behind the other one; there it does not limit (ExactEdge::sharp_corner).
//   In a corner     What lies in a corner of a hole is limited by its edges, though rounding may put it beyond the
//                   ends of both.
//   Edge and edge   The mover's curves are tested against the convex edges, too. Where a segment crosses from one face
//                   of an edge to the other, there is a row with the normal perpendicular to both curves; it crosses
//                   now or, where it does not yet, after the step (edge_crossing.hpp).
//                   Beside its end at a corner that is not convex an edge goes on, as far as contacts are deep: what
//                   slides down such a corner leaves the material through both of its walls, and has both rows.
//                   A straight edge whose end lies on one of the two faces crosses no edge of it there.
//   Before contact  A place outside of both faces of a convex edge is owned by the face that it would pass last
//                   within the step. So the plane around a hole does not stop a pin that enters the hole beside its
//                   rim. A place that lies on one of the two faces and slides is judged by its last velocity.
//   Passing by      The edge of a body that is flush with the one that carries the mover lies in front of it and below.
//                   What slides or rolls over it lies on another face already, or is outside of both faces of the edge
//                   by every motion, or comes to the end of the step without touching: then there is no row, or one
//                   that does not act (curving.hpp).
//   After the step  Edges that do not cross now may do so after the step: one slopes the same way from both faces of
//                   the other, or is beside both. Then the crossing is looked for where the motion without contact
//                   ends, and where the assumed one does. Its row has the gap from which that motion leads to it.
//   Culling         On coincident faces most samples are owned by another face or see the face from behind. Such
//                   samples are rejected a block at a time (ownership_culling.hpp).
//   Reduction       A group of segments has one row, at its closest place at the end of the step. A coincident group
//                   has rows at its ends too, which share its stiffness; on a plane every end within the margin has a
//                   row. If the closest place has little weight, the candidate of the largest weight has a row too.
//   Hollows         A rim that slides round within a hollow, or a hollow one round a pin, has the row of its closest
//                   place alone: one beside it would brake. Where the hollow is hardly wider, the closest place passes
//                   much of it within a step: all of the rim's groups have rows, a ball or a corner has rows all round
//                   (conforming_normals.hpp), and so have a ring and a rim that is held, beside it along the curve.
//                   They have them, too, where their closest place is beyond the hollow's mouth: places inside of it
//                   may be hardly farther.
//   Own face        A ball that a curve carries touches only where the curve is closest; within the step that may be
//                   another place than now.
//   Normal cone     The weight of a row falls from 1 to 0 as its normal leaves the normal cone of the feature by 25
//                   to 40 degrees.
// A row first appears with a gap of the margin or more and so without force, except for those of a group's ends.
//
// Accuracy. Rows are linear; motion and surfaces are curved. A row knows what curves take from its gap within the step,
// (v dt)^2 / (2 rho) for a place that slides with speed v along a wall of radius of curvature rho, if the bodies move
// as BodyMotion::during says (ContactRow::curving). Where a blow makes that wrong by more than some micrometres, the
// contacts are found again for the motion that it gave (simulation/stages/exact_response.cpp). What is left is of third
// order. Where two rims of nearly the same radius cross, the crossing point is faster than either body. For that there
// is no formula: in scenarios/pins.lua light plates that fall over a hole's rim at 0.1 to 2 m/s overlapped by up to 7
// um. A straight edge that comes down on a plane with another end than is nearest now is looked at as the free motion
// turns it.
#pragma once

#include <memory>
#include <optional>

#include "engine/exact/contact_rows.hpp"
#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// Pose and velocity of a body; world coordinates.
struct BodyMotion {
  Pose X_WB;
  Vector3d p_WC = Vector3d::Zero();  ///< centre of mass [m]
  Twist twist;                       ///< of the centre of mass, without contact
  Twist last_twist = {};             ///< likewise, at the end of the last step, contacts included
  std::optional<Twist> during = {};  ///< likewise, that of the step, if known: what curves is of it; else of last_twist
  bool is_found_again = false;       ///< is `during` the answer to contacts that were found in this step before?
  [[nodiscard]] const Twist& taken() const { return during ? *during : last_twist; }
};

/// Thresholds of the search. Heuristic: chosen so that rows fade in and out instead of jumping. exact_thresholds_test
/// says how little results depend on them.
struct SearchThresholds {
  /// m. A ball that a curve carries is the body's boundary only where it touches the face that it belongs to; elsewhere
  /// it is inside the body. A candidate's weight falls from 1 to 0 between these distances of its contact point from
  /// that face. So the end of a segment does not stand for the closest place if that lies in the next segment. Above
  /// the error of the closest place (1e-10), below any clearance (1e-5).
  double own_face_full = 1e-7, own_face_none = 1e-6;
  /// m: a point that rests on a face overlaps it by less, but for loads of some 20 N on a corner and more. Below a
  /// fiftieth of the tightest fits, which it limits: a place is taken for one on the edge until it is so deep.
  double coincident = 4e-8;
  /// Sines of 25 and 40 degrees. A contact normal should lie in the mover's normal cone at the sample. Outside of it
  /// the contact's weight falls from 1 to 0 between these angles out of the cone: more than a body tilts in its fit.
  double cone_full = 0.42, cone_none = 0.64;
  /// Of these, for edge against edge: beyond the cone one edge lies on the face behind the other, and the row is that
  /// face's.
  double cone_of_edges = 0.5;
  double slow = 1e-5;  ///< m: what moves by less within a step moves along a line
  /// Of its way: a gap that leaves its linear change by more has passed a kink, not a curve; and, in radians, so has a
  /// normal that turns by more.
  double kink = 0.4;
  double touching = 1e-6;      ///< m: a part of a segment as near as this touches
  double weight_enough = 0.5;  ///< below this weight the closest place does not carry its group alone
  double end_apart = 0.25;  ///< of a group's length: an end that is nearer to the closest place needs no row of its own
  double lead_enough =
      1;  ///< times its change to the next sample: by so much another face has to own a sample to cull it
  /// rad: a hollow of which the closest place passes less within a step needs one row; and so does a rim
  double conforms = 0.1, held = 0.003;
  /// Smallest length of the blend of two unit normals: faces that meet at less than 12 degrees are a blade without a
  /// useful normal.
  double blade = 0.1;
};

/// Work of one search. The same for the same input.
struct SearchCost {
  std::uint64_t samples = 0;         ///< compared with a face
  std::uint64_t closest_places = 0;  ///< of a segment, found by Newton's method
  std::uint64_t rows = 0;
};

class ExactLink {
 public:
  /// @pre neither is null; each `full` threshold is below its `none`
  ExactLink(std::shared_ptr<const ExactBody> first, std::shared_ptr<const ExactBody> second,
            std::size_t rows_max = 4096, const SearchThresholds& thresholds = {});

  /// Replaces rows() by the contacts of these poses. No allocation. A pose or velocity that is not finite gives no row.
  /// The order of rows is that of features and faces, whatever the poses.
  /// @param dt      s, the step
  /// @param margin  m, largest gap that makes a row; include the distance that the bodies can close within the step
  /// @param overlap  m, by which their contacts were pressed in the last step: a place flush with an edge that is so
  ///        deep has come through the face
  /// @pre dt is finite and above 0; margin >= 0; overlap >= 0; rotations are unit, if finite
  void find(const BodyMotion& first, const BodyMotion& second, double dt, double margin, double overlap = 0);

  [[nodiscard]] const RowList& rows() const { return rows_; }
  void make_room() { rows_.make_room(); }                         ///< for more rows than the last find; between steps
  [[nodiscard]] const SearchCost& cost() const { return cost_; }  ///< of the last find
  [[nodiscard]] double depth_max() const { return depth_max_; }   ///< m, deepest overlap at the start of the step

 private:
  std::shared_ptr<const ExactBody> first_, second_;
  RowList rows_;
  SearchThresholds thresholds_;
  SearchCost cost_;
  double size_ = 0;  ///< m, half the diagonal of the smaller body
  double depth_max_ = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
};

}  // namespace verisim::exact

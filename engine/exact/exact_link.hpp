// One ExactLink per pair of bodies: finds the places where their precise entities touch or may touch within the step.
//
// Source: issue "hybrid method", item 7. Features of either body (exact_body.hpp) meet the faces of the other:
//   - a feature's sample slides within its own segment to the place that is nearest to the face (Newton's method);
//   - gap and normal are those of the precise surface, less the ball's radius;
//   - trims: beyond a face's border there is no row. At a convex edge between two faces the material is where both
//     distances are negative: the larger of the two decides, and where the sample's segment crosses from one to the
//     other, the row is that of edge against edge, with the normal across both. At a concave edge either face has its
//     row, so the smaller distance decides;
//   - before anything touches, the face that would be passed last within the step decides, so that a pin that enters a
//     hole beside its rim does not stumble over the plane around it; where it lies on one of them and slides, its last
//     velocity says which that is;
//   - where bodies lie flush most samples are near a face that decides nothing there, because the face across an edge
//     does or because it looks the wrong way: these are told a run at a time and not tried one by one;
//   - a group of segments has one row, at the place that will be nearest; where the group lies flush and is pressed
//     on, so that its other end may be instead, that end has one too, and where the nearest place hardly holds, the
//     firmest;
//   - a place that cannot be the nearest because the faces there look the wrong way counts less and less, and not at
//     all from 40 degrees on.
// Every row appears with a gap of the margin or more and so without force, but for those of a group's ends.
//
// Rows are straight where motion and surfaces are curved. What they let through within one step, and take back in the
// next, is half of how far the place moves times how far the normal turns: (v dt)^2 / 2 rho for a place that slides
// with v along a wall with radius of curvature rho, r (omega dt)^2 / 2 for one that turns on a circle of radius r.
// Where two rims of nearly the same radius cross, their crossing runs along them faster than either moves. For that
// there is no formula: in scenarios/pins.lua light plates that fall over a hole's rim at 0.1 to 2 m/s overlapped by up
// to 7 um.
#pragma once

#include <memory>

#include "engine/exact/contact_rows.hpp"
#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// Where a body is and how it would move without contact; world coordinates.
struct BodyMotion {
  Pose X_WB;
  Vector3d p_WC = Vector3d::Zero();  ///< centre of mass [m]
  Twist twist;                       ///< of the centre of mass
  Twist before = {};                 ///< in the last step, with the contacts that it had
};

/// What the search takes for near, flush, leaning or firm. Heuristic: chosen so that rows fade in and out instead of
/// jumping; how little results hang on the numbers is in exact_thresholds_test.
struct SearchThresholds {
  /// m. A ball that a curve carries is the body's boundary where it touches the face it belongs to; elsewhere it is
  /// within the body. Contacts fade out between these distances of their place from that face: a segment's end, where
  /// the nearest place lies in the next segment, shall not stand for it. Above what the search's slide leaves (1e-10),
  /// below what any clearance is (1e-5).
  double own_free = 1e-7, own_none = 1e-6;
  double flush = 1e-7;  ///< m: what lies in a face's plane overlaps it by less
  /// Sines: 25 and 40 degrees. A contact whose normal leans away from all that the mover can touch with fades out
  /// between them: a real one leans by no more than a body tilts in its fit.
  double lean_free = 0.42, lean_none = 0.64;
  double touching = 1e-6;  ///< m: a segment that slopes counts for the part of it that is as near as this
  double firm = 0.5;       ///< share of its stiffness below which a place does not stand for its group alone
};

/// Work of one search; deterministic.
struct SearchCost {
  std::uint64_t samples = 0;  ///< compared with a face
  std::uint64_t slides = 0;   ///< that slid to where they are nearest
  std::uint64_t rows = 0;
};

class ExactLink {
 public:
  /// @pre neither is null; where contacts fade, `free` is below `none`
  ExactLink(std::shared_ptr<const ExactBody> first, std::shared_ptr<const ExactBody> second,
            std::size_t rows_max = 4096, const SearchThresholds& thresholds = {});

  /// Fills `rows` with every place whose gap is at most `margin` [m] (add the distance that the bodies can close within
  /// the step). The list is in the order of features and faces, whatever the poses. No allocation.
  /// A motion that is not finite gives no row. @pre dt is finite and above 0; margin >= 0; rotations are unit, if
  /// finite
  void find(const BodyMotion& first, const BodyMotion& second, double dt, double margin);

  [[nodiscard]] const RowList& rows() const { return rows_; }
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

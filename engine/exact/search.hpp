// One direction of a contact search: the features of one body (the mover) against the faces of the other (the base), in
// the coordinates of the base. exact_link.hpp describes the method. Private to this folder.
#pragma once

#include <optional>

#include "engine/exact/exact_link.hpp"

namespace verisim::exact {

/// Where the mover is, base coordinates.
struct Placement {
  Matrix3d R;  ///< mover's coordinates to the base's
  Vector3d p;  ///< m, mover's origin
};

/// Pose and motion of the mover relative to the base, base coordinates.
struct RelativeMotion {
  Placement now;     ///< at the start of the step
  Twist free_twist;  ///< of the mover's material against the base, at the base's origin, without contact
  Twist last_twist;  ///< likewise, in the last step
  Twist during;      ///< likewise, with which it is taken to move in this step: BodyMotion::during
  Matrix3d R_WB;     ///< base to world
  Vector3d p_WB;     ///< m
  double dt;         ///< s
  double margin;     ///< m, largest gap that makes a row
  double size;       ///< m, half the diagonal of the smaller body
  double overlap;    ///< m, of the two bodies in the last step
  bool mover_is_second;
  bool is_found_again = false;  ///< BodyMotion::is_found_again, of either
  SearchThresholds thresholds;
  const BodyMotion* of_mover = nullptr;  ///< of the call of find() that it is of
  const BodyMotion* of_base = nullptr;

  /// Where the mover is after the step with free_twist, and with `during`. Few pairs ask, some often.
  [[nodiscard]] const Placement& ahead() const { return placed_once(ahead_, of_mover->twist, of_base->twist); }
  [[nodiscard]] const Placement& after() const { return placed_once(after_, of_mover->taken(), of_base->taken()); }
  /// Likewise after a part of the step, from 0 to 1.
  [[nodiscard]] Placement after_part(double part) const;

 private:
  const Placement& placed_once(std::optional<Placement>& placement, const Twist& mover, const Twist& base) const;
  mutable std::optional<Placement> ahead_, after_;
};

/// The bodies at rest, one of them placed elsewhere.
[[nodiscard]] inline RelativeMotion still(RelativeMotion motion, const Placement placed) {
  motion.now = placed;
  motion.free_twist = motion.last_twist = motion.during = {};
  return motion;
}

/// Working memory of a search: pairs of tree nodes yet to be visited.
using NodePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Appends the rows to `rows` and adds the work to `cost`. No allocation if `stack` has its capacity.
/// @returns the deepest overlap found [m], 0 if there is none
double search(const ExactBody& mover, const ExactBody& base, const RelativeMotion& motion, NodePairs& stack,
              RowList& rows, SearchCost& cost);

}  // namespace verisim::exact

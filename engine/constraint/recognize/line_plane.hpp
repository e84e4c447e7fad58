// Straight edge on a plane: other. Leaves two slides, the roll about the edge and the turn about the normal.
//
//    \ | /
//     \|/        The plane gives the normal: it is the face that the edge touches.
//   -------
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct LinePlane {
  using First = Line;
  using Second = Plane;
  static constexpr ConstraintKind kKind = ConstraintKind::other;

  static bool matches(const Bounded<First>& /*a*/, const Bounded<Second>& /*b*/, const Tolerances& /*tolerances*/) {
    return true;
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::on_plane(a, b, kKind, Pairing::axis_plane);
  }
};

}  // namespace verisim

// One direction of a search: the features of one body (the mover) against the faces of the other (the base), in the
// coordinates of the base. Private to this folder.
#pragma once

#include "engine/exact/exact_link.hpp"

namespace verisim::exact {

/// The mover's place and motion as the base sees them.
struct SearchFrame {
  Matrix3d R;     ///< mover's coordinates to the base's
  Vector3d p;     ///< m, mover's origin
  Twist twist;    ///< of the mover's material against the base, at the base's origin, without contact
  Twist before;   ///< likewise, in the last step
  Matrix3d R_WB;  ///< base to world
  Vector3d p_WB;  ///< m
  double dt, margin;
  double size;  ///< m, half the diagonal of the smaller body
  bool mover_is_second;
  SearchThresholds thresholds;
};

/// Fixed working memory of a search.
using NodePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Appends the rows. @returns the deepest overlap found [m]
double search(const ExactBody& mover, const ExactBody& base, const SearchFrame& frame, NodePairs& stack, RowList& rows,
              SearchCost& cost);

}  // namespace verisim::exact

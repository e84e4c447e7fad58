// How deep something reaches into something else, and how well that is known.
#pragma once

#include <cstdint>

#include "engine/base/pose.hpp"

namespace verisim::ruler {

struct Accuracy {
  double absolute = 2e-7;           ///< m; a search ends when it misses no more than this
  double relative = 0.01;           ///< or this part of the depth
  std::uint32_t pieces_max = 1500;  ///< or after so many pieces; `bound` then says what may be missed
};

struct Depth {
  double depth = 0;                   ///< m, that of a point that was found
  double bound = 0;                   ///< m; the true depth is in [depth, depth + bound]
  Vector3d place = Vector3d::Zero();  ///< that point
  std::uint32_t pieces = 0;           ///< of the surface that were looked at
};

}  // namespace verisim::ruler

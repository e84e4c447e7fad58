#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/voxel/overlap.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {

namespace {

/// Distance of x from the nearest whole number.
double from_wall(double x) {
  return std::abs(x - std::round(x));
}

int floor_divide(int a) {
  return a >= 0 ? a / kBrickSide : -((-a + kBrickSide - 1) / kBrickSide);
}

/// Bricks along one axis that lie within the band of the box's two faces, in cells `low` and `high`.
int bricks_in_band(int low, int high) {
  const int low_begin = floor_divide(low - kBand), low_end = floor_divide(low + kBand);
  const int high_begin = floor_divide(high - kBand), high_end = floor_divide(high + kBand);
  return low_end >= high_begin ? high_end - low_begin + 1 : low_end - low_begin + 1 + high_end - high_begin + 1;
}

struct AxisPlacement {
  double center;  ///< of the box [voxel]
  int bricks;
};

AxisPlacement place(double extent) {
  const double half = 0.5 * extent;
  double center = from_wall(half) > from_wall(half + 0.5) ? 0 : 0.5;
  const int low = static_cast<int>(std::floor(center - half - kCandidateMargin));
  const int cells = static_cast<int>(std::floor(center + half + kCandidateMargin)) - low;
  // The border brick comes first; which of the eight cells after it is the box's first decides how many bricks the band
  // around the outer faces fills.
  int best = kBrickSide;
  for (int first = kBrickSide; first < 2 * kBrickSide; ++first) {
    const auto cost = [&](int at) { return bricks_in_band(at, at + cells); };
    if (cost(first) < cost(best)) best = first;
  }
  return {center + (best - low), (best + cells) / kBrickSide + 2};
}

}  // namespace

Vector3d grid_origin(const Bounds& bounds, double voxel_size, Eigen::Vector3i& bricks) {
  VERISIM_ASSERT(is_finite(bounds.min));
  VERISIM_ASSERT(is_finite(bounds.max));
  VERISIM_ASSERT((bounds.min.array() <= bounds.max.array()).all());
  VERISIM_ASSERT(is_positive(voxel_size));
  Vector3d origin;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisPlacement placement = place(bounds.size()[axis] / voxel_size);
    bricks[axis] = placement.bricks;
    origin[axis] = bounds.center()[axis] - voxel_size * placement.center;
  }
  return origin;
}

}  // namespace verisim

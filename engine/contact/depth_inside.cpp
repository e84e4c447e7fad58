#include "engine/contact/depth_inside.hpp"

#include <algorithm>
#include <cmath>

#include "engine/contact/query.hpp"

namespace verisim {

namespace {

double depth_of_points(const VoxelBody& a, const VoxelBody& b, const Pose& X_AB) {
  ContactList inside(b.shell.size());
  QueryCost cost;
  query(a.voxmap, b.shell, X_AB, inside, cost);
  Layer deepest = 0;
  for (std::uint32_t i = 0; i < inside.size; ++i) deepest = std::min(deepest, a.voxmap.layers[inside.slot[i]]);
  return (-deepest - 1) * a.voxmap.voxel_size - 0.5 * std::sqrt(3.0) * b.voxmap.voxel_size;
}

}  // namespace

double depth_inside(const VoxelBody& a, const VoxelBody& b, const Pose& X_AB) {
  return std::max({0.0, depth_of_points(a, b, X_AB), depth_of_points(b, a, X_AB.inverse())});
}

}  // namespace verisim

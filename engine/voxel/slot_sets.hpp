// The feature sets of a body's voxels by slot, as contacts name them, and those behind the surface too.
//
// Why behind: a pointshell point stands at the centre of a surface voxel, so up to 0.87 voxels off the surface that it
// stands for, and may lie in a voxel of the other body one or two layers deep while the parts only touch. That contact
// is one with the surface nearest to it. Without a set there, one contact in ten of a pin in its hole would not be
// known as the fit's.
#pragma once

#include <vector>

#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// How deep: a point that is further behind the surface did not get there through the surface in front of it alone.
inline constexpr int kInheritedLayers = 3;
static_assert(kInheritedLayers <= kBand);

/// For each slot of `map`: the set of that surface voxel, or of a voxel of layer -k, 1 <= k <= kInheritedLayers, what
/// it inherits from its neighbours of layer -k + 1; 0 everywhere else. It inherits the set of the nearest of them (that
/// share a face with it, else an edge, else a corner) if these agree. If not, it lies behind a rim: then the set with
/// the most entities among all of them, which is the rim's, where both faces are; of several such the first in the
/// order of z, y, x. `of_voxel`: the set of each surface voxel. 2 bytes per slot.
/// @pre of_voxel has a set for each of the map's surface voxels, and `sets` has each of these
[[nodiscard]] std::vector<FeatureSetId> sets_by_slot(const Voxmap& map, const std::vector<FeatureSetId>& of_voxel,
                                                     const FeatureSets& sets, unsigned threads);

}  // namespace verisim

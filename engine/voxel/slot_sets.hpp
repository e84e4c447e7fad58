// The feature sets of a body's voxels by slot (as in ContactList), also behind the surface.
//
// Why behind: a pointshell point is the centre of a surface voxel, up to 0.87 voxels off the surface. It may lie in a
// voxel of the other body one or two layers deep while the parts only touch. That contact belongs to the nearest
// surface. Without a set there, one contact in ten of a pin in its hole would not be recognized as one of the fit.
#pragma once

#include <vector>

#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// Layers behind the surface that inherit a set. A deeper point may have come through another surface.
inline constexpr int kInheritedLayers = 3;
static_assert(kInheritedLayers <= kBand);

/// For each slot of `map`: the set of a surface voxel; for a voxel of layer -k, 1 <= k <= kInheritedLayers, the set
/// that it inherits from its neighbours of layer -k + 1; 0 everywhere else. A voxel inherits the set of its nearest
/// such neighbours (by face, else by edge, else by corner) if these agree. If not, it lies behind a rim and inherits
/// the set with the most entities, which is the rim's; of several such the first in the order of z, y, x. 2 bytes per
/// slot.
/// @param of_voxel  the set of each surface voxel
/// @pre of_voxel has a set for each of the map's surface voxels, and `sets` has each of these
[[nodiscard]] std::vector<FeatureSetId> sets_by_slot(const Voxmap& map, const std::vector<FeatureSetId>& of_voxel,
                                                     const FeatureSets& sets, unsigned threads);

}  // namespace verisim

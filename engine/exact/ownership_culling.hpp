// A fast rejection before samples are tested one by one. Where two coplanar faces touch, most samples near a face are
// owned by the face across one of its edges (edge_ownership.hpp). This file rejects them a block at a time.
// Base coordinates [m]. Private to this folder.
#pragma once

#include <span>

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// Rejects samples that the face across a convex edge owns, a group at a time: accept_candidate would refuse each of
/// them. Conservative: a group is rejected only if its whole segments are owned by the other face,
/// and that face can push them (its normal is in their normal cone) or they do not come into it.
/// @param measures    of the block's samples, each at the middle of its segment
/// @param gaps_ahead  kOutOfReach where a sample is not near the face; afterwards also where it was rejected
/// @pre gaps_ahead has an entry for each sample of the block, and at least one is not kOutOfReach
void cull_unowned_samples(const BodyPair& pair, const PlacedFeature& placed, const SampleBlock& block,
                          std::uint32_t face, std::span<const Measure> measures, std::span<double> gaps_ahead);

}  // namespace verisim::exact

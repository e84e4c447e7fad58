// Where two bodies lie flush, most of the samples that are near a face are hidden from it by the face across one of its
// edges. These are told a run at a time. Private to this folder.
#pragma once

#include <span>

#include "engine/exact/placed.hpp"

namespace verisim::exact {

/// A run against one face, at its segments' middles.
struct Sight {
  OfRun distance, change;  ///< m, as in Measure
};

/// Takes out the samples that the face across a convex edge hides, a group at a time: what `admit` would find of them
/// one by one. `ahead`: kNever where a sample is out of reach, and after this also where it is hidden.
/// @pre one of them is near
void hide_beyond_an_edge(const Meeting& meeting, const PlacedFeature& placed, const Run& run, std::uint32_t face,
                         const Sight& sight, std::span<double> ahead);

}  // namespace verisim::exact

// Sums and largest values over the frames of a run.
#pragma once

#include <array>
#include <cstdint>

#include "engine/constraint/constraint.hpp"

namespace verisim {

struct Totals {
  std::uint64_t collision_frames = 0;   ///< frames with a contact
  double force_max = 0;                 ///< N, largest contact force on a body
  const char* penetration_source = "";  ///< what said penetration_max: voxels, surfaces or triangles; empty: no depth
  double penetration_max = 0;           ///< m
  std::uint64_t contacts = 0;
  std::uint64_t by_voxels = 0;  ///< of the contacts: voxels answered them
  /// Frames with a contact of a pair that was to be exact; of those, the frames in which voxels answered one, because
  /// they had to or because a script had switched exact off.
  std::uint64_t exact_frames = 0, exact_frames_by_voxels = 0;
  std::uint64_t cache_hits = 0, cache_misses = 0;
  std::uint64_t null_misses = 0;  ///< of the misses: recognized, and there was no constraint
  std::array<std::uint64_t, kConstraintKindNames.size()>
      constraint_frames{};  ///< frames in which any link had this kind
};

/// The same of one pair.
struct PairTotals {
  std::uint64_t contacts = 0, by_voxels = 0;
  std::uint64_t frames = 0;               ///< with a contact
  std::uint64_t switched_off_frames = 0;  ///< of those: while a script had the method of one of the two switched off
};

}  // namespace verisim

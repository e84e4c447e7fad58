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
  std::uint64_t cache_hits = 0, cache_misses = 0;
  std::uint64_t null_misses = 0;  ///< of the misses: recognized, and there was no constraint
  std::array<std::uint64_t, kConstraintKindNames.size()>
      constraint_frames{};  ///< frames in which any link had this kind
};

}  // namespace verisim

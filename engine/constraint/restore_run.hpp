// restore() of restoration.hpp over a run of contacts under one constraint, as many at once as the CPU takes.
//
// SIMD by run-time dispatch (Google Highway). Elementwise operations only, no fused multiply-add: every target, and the
// plain function, gives the same bits.
#pragma once

#include <cstdint>

#include "engine/constraint/restoration.hpp"

namespace verisim {

/// `count` contacts as columns, relative to one origin. Forces are changed in place.
struct ContactRun {
  const float* x;  ///< m
  const float* y;
  const float* z;
  float* fx;  ///< N
  float* fy;
  float* fz;
  std::uint32_t count;
};

/// `active`: relative to the run's origin. About 1 ns a contact; of cones and rings, whose normals take a root, 5 ns.
/// @pre no column is null, unless the run is empty; active.alpha is in [0, 1]
void restore_run(const ContactRun& run, const ActiveConstraint& active);

}  // namespace verisim

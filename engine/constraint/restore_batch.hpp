// restore() of restoration.hpp for a batch of contacts under one constraint, vectorized.
//
// SIMD by run-time dispatch (Google Highway). Elementwise operations without fused multiply-add: every target gives the
// same bits as the plain function.
#pragma once

#include <cstdint>

#include "engine/constraint/restoration.hpp"

namespace verisim {

/// `count` contacts as columns, relative to one origin. Forces are changed in place.
struct ContactBatch {
  const float* x;  ///< m
  const float* y;
  const float* z;
  float* fx;  ///< N
  float* fy;
  float* fz;
  std::uint32_t count;
};

/// `active` is relative to the batch's origin. About 1 ns per contact; 5 ns for cones and rings, whose normals need a
/// square root. @pre no column is null, unless the batch is empty; active.alpha is in [0, 1]
void restore_batch(const ContactBatch& batch, const ActiveConstraint& active);

}  // namespace verisim

// Pointshell of body B against the voxmap of body A: the innermost loop.
//
// Source: Voxmap PointShell (McNeely et al. 1999), tangent-plane force; dissertation section 8.2.2 (a list of collision
// pairs is returned, separately from summing them). Coordinates: everything in the list is in the body coordinates of A.
//
// A point p with inward normal n (B's, rotated into A) in a voxel of layer L <= 0 with centre c has the depth
//     d = (c - p).n + |L| s          (s: voxel size; the tangent plane through the centre, moved out by whole layers)
// and is in contact if d > 0. The force that separates acts on B along n.
//
// SIMD by run-time dispatch (Google Highway). Every target gives the same bits: no fused multiply-add, elementwise
// operations only, lists in point order, sums in eight fixed strands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// The contacts of one pair of bodies in one frame, as columns. Capacity is fixed when it is made; nothing grows later.
struct ContactList {                   //  unit  meaning
  std::vector<std::uint32_t> point;    //  -     pointshell point of B
  std::vector<std::uint32_t> slot;     //  -     where A's voxel is stored: block * 512 + cell
  std::vector<float> x, y, z;          //  m     the point, body coordinates of A, relative to A's grid origin
  std::vector<float> nx, ny, nz;       //  1     unit normal that pushes B
  std::vector<float> depth;            //  m     > 0
  std::vector<float> fx, fy, fz;       //  N     force on B, body coordinates of A (see penalty.hpp)
  std::uint32_t size = 0;
  explicit ContactList(std::size_t capacity = 0);
};

/// Deterministic work counts of a query: the same on every machine, for any SIMD target and number of threads.
struct QueryCost {
  std::uint64_t clusters = 0;       ///< clusters looked at
  std::uint64_t points = 0;         ///< points transformed and looked up
  std::uint64_t candidates = 0;     ///< points found in a voxel of layer <= 0
};

/// Fills `contacts` (in ascending point order) and adds to `cost`. X_AB places B in A. No allocation, no lock.
void query(const Voxmap& a, const Pointshell& b, const Pose& X_AB, ContactList& contacts, QueryCost& cost);

/// The same, written plainly (double loop, no clusters, no SIMD): what the fast one must equal bit for bit.
void query_plainly(const Voxmap& a, const Pointshell& b, const Pose& X_AB, ContactList& contacts, QueryCost& cost);

/// Names of the SIMD targets compiled in and supported by this CPU ("AVX3", "AVX2", "SSE4", "SSSE3", "EMU128" …);
/// "scalar" is always among them.
[[nodiscard]] std::vector<std::string> simd_targets();

/// Restricts dispatch to one target by name (as simd_targets lists it); "" lifts the restriction.
/// Throws Error(usage) with the list if the name is not among them. Not to be called while a simulation runs.
void use_simd_target(const std::string& name);

}  // namespace verisim

// Pointshell of body B against the voxmap of body A: the narrow phase.
//
// Source: Voxmap PointShell (McNeely et al. 1999), tangent-plane force; dissertation section 8.2.2 (a list of collision
// pairs is returned, separately from summing them). Everything in the list is in the body coordinates of A.
//
// A point p with inward normal n (B's, rotated into A) in a voxel of layer L <= 0 with centre c has the depth
//     d = (c - p).n + |L| s          (s: voxel size; the tangent plane through the centre, moved out by whole layers)
// and is in contact if d > 0. The force that separates acts on B along n.
//
// Arithmetic: each cluster's centre is placed in A's grid in double and split into a cell and a fraction; its points
// are added to that in float, as offsets of a few voxels. So a coordinate is good to about 1e-6 of a voxel however
// large the parts are. query_arithmetic.hpp is the one definition; SIMD repeats it operation by operation.
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
/// Only the first `size` rows are valid. Columns are kPadding longer than the capacity, so that whole vectors may be
/// stored at the end.
struct ContactList {                 //  unit  meaning
  std::vector<std::uint32_t> point;  //  -     pointshell point of B
  std::vector<std::uint32_t> slot;   //  -     where A's voxel is stored: block * 512 + cell
  std::vector<float> x, y, z;        //  m     the point, body coordinates of A, relative to A's grid origin
  std::vector<float> nx, ny, nz;     //  1     normal that pushes B: unit, or shorter if a hybrid method changed it
  std::vector<float> depth;          //  m     > 0
  std::vector<float> fx, fy, fz;     //  N     force on B, body coordinates of A (see penalty.hpp)
  std::uint32_t size = 0;
  static constexpr std::size_t kPadding = 16;
  explicit ContactList(std::size_t capacity = 0);
  [[nodiscard]] std::size_t capacity() const { return point.size() - kPadding; }

  /// Keeps the rows i with keep(i), in their order; what has no force yet loses nothing: forces are not carried along.
  template <typename Keep>
  void keep_if(const Keep& keep) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      if (!keep(i)) continue;
      point[kept] = point[i];
      slot[kept] = slot[i];
      for (auto* column : {&x, &y, &z, &nx, &ny, &nz, &depth}) (*column)[kept] = (*column)[i];
      ++kept;
    }
    size = kept;
  }
};

/// Deterministic work counts of a query: the same on every machine, for any SIMD target and number of threads.
struct QueryCost {
  std::uint64_t clusters = 0;    ///< clusters tested
  std::uint64_t points = 0;      ///< points transformed and looked up
  std::uint64_t candidates = 0;  ///< points found in a voxel of layer <= 0
  std::uint64_t left_out = 0;    ///< contacts beyond the list's capacity (mesh_query.hpp; of voxels, none)
};

/// Bytes of bodies and contacts that a query reads and writes: per cluster its record; per point its coordinates and
/// the block and layer of its voxel; per candidate its normal and a contact.
[[nodiscard]] constexpr std::uint64_t bytes_touched(const QueryCost& cost) {
  constexpr std::uint64_t kPoint = 3 * sizeof(float) + sizeof(std::uint32_t) + sizeof(Layer);
  constexpr std::uint64_t kCandidate = 3 * sizeof(float) + 2 * sizeof(std::uint32_t) + 7 * sizeof(float);
  return cost.clusters * sizeof(Pointshell::Cluster) + cost.points * kPoint + cost.candidates * kCandidate;
}

/// Fills `contacts` (in ascending point order) and adds to `cost`. X_AB places B in A. No allocation, no lock.
/// A pose that is not finite touches nothing. Cost: about 10 ns per cluster and 1 ns per point of those not culled.
/// @pre  contacts.capacity() >= b.size(); b's clusters cover all its points in order (asserted of their end here, of
/// each by CollisionLink); a has a block and a clearance for every brick; the rotation is unit, if finite
void query(const Voxmap& a, const Pointshell& b, const Pose& X_AB, ContactList& contacts, QueryCost& cost);

/// Names of the SIMD targets compiled in and supported by this CPU, best first ("AVX3", "AVX2", "SSE4", "SSSE3" …);
/// the last is always "scalar": the same code in portable C++ (Highway's SCALAR or EMU128).
[[nodiscard]] std::vector<std::string> simd_targets();

/// Restricts dispatch to one target by name (as simd_targets lists it); "" lifts the restriction.
/// Throws Error(usage) with the list if the name is not among them. Not to be called while a simulation runs.
void use_simd_target(const std::string& name);

}  // namespace verisim

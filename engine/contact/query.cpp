#include "engine/contact/query.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/contact/query_arithmetic.hpp"
#include "engine/contact/query_simd.hpp"

namespace verisim {
namespace {

/// Voxel steps (Chebyshev) from `cell`, which may lie outside the grid, to the nearest surface voxel: a lower bound if
/// the cell is outside A, else 0.
///
/// In a brick with or next to one with surface voxels the layer itself is that number (at kBand + 1, a lower bound of
/// it). If the nearest surface voxel is k bricks away, k - 1 whole bricks lie between. And a cell beyond the grid is at
/// least as far as the grid's cell nearest to it.
std::int32_t steps_to_surface(const QueryConstants& f, const std::int32_t cell[3]) {
  std::int32_t clamped[3];
  for (int i = 0; i < 3; ++i) clamped[i] = clamp_cell(cell[i], f.cell_max[i]);
  const Layer clearance = f.brick_clearance[brick_of(f, clamped)];
  if (clearance >= 2) return kBrickSide * (clearance - 1) + 1;
  return std::max<std::int32_t>(f.layers[slot_of(f, clamped)], 0);
}

/// The grid's border is one brick of outside: nothing beyond the inner box can be in contact. False for a centre that
/// is not a number.
bool meets_grid(const QueryConstants& f, const Center& g, double reach) {
  const double low = kBrickSide - reach;
  const double high = reach + 1 - kBrickSide;
  return g.x > low && g.x < f.cell_max[0] + high && g.y > low && g.y < f.cell_max[1] + high && g.z > low &&
         g.z < f.cell_max[2] + high;
}

/// All points of a cluster lie within `reach` voxels of its centre.
double reach_of(const Pointshell::Cluster& cluster, double per_metre) {
  constexpr double kRounding = 0x1p-10;  // voxel; of local coordinates (float) and of the radius; far above both
  return cluster.radius * per_metre * (1 + kRounding) + kRounding;
}

/// True only if every point of the cluster certainly has a layer > 0.
///
/// The points' cells are at most ceil(reach) voxel steps from the centre's. Surface voxels are all that a triangle
/// touches, so two neighbouring cells (by face, edge or corner) of which neither is one lie on the same side. If the
/// centre's cell is outside and the nearest surface voxel more than ceil(reach) steps away, no step on the way to any
/// point's cell meets one: all are outside, layer > 0. A cluster deep inside is not culled: steps_to_surface is 0
/// there.
bool surely_outside(const QueryConstants& f, const PlacedCluster& c, double reach) {
  return steps_to_surface(f, c.base) - 1 >= reach;  // more steps than ceil(reach), as both sides of it are whole
}

void check(const Voxmap& a, const Pointshell& b, const Pose& X_AB, const ContactList& contacts) {
  VERISIM_ASSERT(is_positive(a.voxel_size));
  VERISIM_ASSERT(a.brick_block.size() == static_cast<std::size_t>(a.bricks.cast<std::int64_t>().prod()));
  VERISIM_ASSERT(a.brick_clearance.size() == a.brick_block.size());
  VERISIM_ASSERT(a.layers.size() < (std::size_t{1} << 32));  // slots have 32 bits
  VERISIM_ASSERT(contacts.capacity() >= b.size());
  VERISIM_ASSERT(b.size() == 0 || (!b.clusters.empty() && b.clusters.back().end == b.size()));
  VERISIM_ASSERT(is_unit(X_AB.rotation) || !X_AB.rotation.coeffs().allFinite());
}

}  // namespace

ContactList::ContactList(std::size_t capacity) {
  for (auto* column : {&point, &slot}) column->resize(capacity + kPadding);
  for (auto* column : {&x, &y, &z, &nx, &ny, &nz, &depth, &fx, &fy, &fz}) column->resize(capacity + kPadding);
}

void query(const Voxmap& a, const Pointshell& b, const Pose& X_AB, ContactList& contacts, QueryCost& cost) {
  check(a, b, X_AB, contacts);
  contacts.size = 0;
  const QueryConstants constants = make_query_constants(a, b, X_AB);
  const double per_metre = 1 / a.voxel_size;
  std::array<PlacedCluster, 128> batch;  // small enough to stay in the first-level cache, large enough to hide the call
  std::size_t filled = 0;
  for (const Pointshell::Cluster& cluster : b.clusters) {
    const Center center = center_of(constants, cluster);
    const double reach = reach_of(cluster, per_metre);
    if (!meets_grid(constants, center, reach)) continue;
    place(cluster, center, batch[filled]);
    if (surely_outside(constants, batch[filled], reach)) continue;
    batch[filled].near = reach <= kBrickSide;
    VERISIM_ASSERT(reach < 1 << 20);  // local coordinates stay within the range of kRounder
    VERISIM_ASSERT(cluster.end - cluster.begin <= static_cast<std::uint32_t>(kBrickCells));
    cost.points += cluster.end - cluster.begin;
    if (++filled < batch.size()) continue;
    cost.candidates += append_contacts(constants, b, batch, contacts);
    filled = 0;
  }
  cost.candidates += append_contacts(constants, b, {batch.data(), filled}, contacts);
  cost.clusters += b.clusters.size();
}

}  // namespace verisim

#include "engine/voxel/surface.hpp"

#include "engine/base/error.hpp"
#include "engine/voxel/parallel.hpp"

namespace verisim {

namespace {

BrickMask touched_cells(const GridMesh& mesh, std::span<const std::uint32_t> triangles, const Eigen::Vector3i& corner) {
  const BoxLattice cells = {.corner = corner.cast<double>(), .side = 1, .half_side = 0.5 * (1 + kTouchTolerance)};
  BrickMask mask{};
  for (const std::uint32_t t : triangles) {
    const auto [a, b, c] = mesh.corners(t);
    const BrickMask more = TriangleOverlap(a, b, c).touched(cells);
    for (std::size_t z = 0; z < mask.size(); ++z) mask[z] |= more[z];
  }
  return mask;
}

}  // namespace

SurfaceVoxels find_surface(const GridMesh& mesh, const BrickLists& lists, const Eigen::Vector3i& bricks,
                           unsigned threads) {
  SurfaceVoxels surface{.bricks = bricks, .brick = {}, .cells = {}, .entry = {}};
  VERISIM_ASSERT(lists.begin.size() == static_cast<std::size_t>(bricks.cast<std::int64_t>().prod()) + 1);
  const std::size_t brick_count = lists.begin.size() - 1;
  std::size_t candidates = 0;
  for (std::size_t i = 0; i < brick_count; ++i) candidates += lists.empty(i) ? 0 : 1;
  surface.brick.reserve(candidates);
  for (std::size_t i = 0; i < brick_count; ++i) {
    if (!lists.empty(i)) surface.brick.push_back(static_cast<std::uint32_t>(i));
  }
  surface.cells.resize(candidates);
  for_each_chunk(candidates, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      surface.cells[i] = touched_cells(mesh, lists.of(surface.brick[i]), brick_corner(surface.brick[i], bricks));
    }
  });
  std::size_t kept = 0;  // a candidate may turn out to touch no voxel: lists are generous
  surface.entry.assign(brick_count, kNoSurface);
  for (std::size_t i = 0; i < candidates; ++i) {
    if (!any(surface.cells[i])) continue;
    surface.voxels += static_cast<std::uint64_t>(count(surface.cells[i]));
    surface.entry[surface.brick[i]] = static_cast<std::uint32_t>(kept);
    surface.brick[kept] = surface.brick[i];
    surface.cells[kept++] = surface.cells[i];
  }
  surface.brick.resize(kept);
  surface.cells.resize(kept);
  return surface;
}

}  // namespace verisim

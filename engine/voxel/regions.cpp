#include "engine/voxel/regions.hpp"

#include <algorithm>
#include <numeric>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/voxel/crossings.hpp"

namespace verisim {

namespace {

constexpr BrickMask kWholeBrick = {~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL};

/// The part of `free` that is connected (26 neighbours, within the brick) with its first cell.
BrickMask first_region(const BrickMask& free) {
  BrickMask region{};
  std::size_t z = 0;
  while (free[z] == 0) ++z;
  region[z] = free[z] & (~free[z] + 1);
  for (;;) {
    BrickMask grown = dilated(region);
    for (std::size_t i = 0; i < grown.size(); ++i) grown[i] &= free[i];
    if (grown == region) return region;
    region = grown;
  }
}

/// True if cells of `a` at its upper wall along `axis` touch cells of `b` at its lower wall.
bool meet(const BrickMask& a, const BrickMask& b, int axis) {
  if (axis == 2) return (a[7] & b[0]) != 0;
  const std::uint64_t lower_wall = axis == 0 ? kEveryByte : 0xFF;
  const int shift = axis == 0 ? 7 : 56;
  std::uint64_t common = 0;
  for (std::size_t z = 0; z < a.size(); ++z) common |= a[z] >> shift & b[z] & lower_wall;
  return common != 0;
}

/// Nodes are the regions within surface bricks, numbered first, and the bricks without surface voxels.
class RegionGraph {
 public:
  explicit RegionGraph(const SurfaceVoxels& surface) : surface_(surface) {
    begin_.reserve(surface.brick.size() + 1);
    for (const BrickMask& cells : surface.cells) {
      begin_.push_back(static_cast<std::uint32_t>(regions_.size()));
      BrickMask free;
      for (std::size_t z = 0; z < free.size(); ++z) free[z] = ~cells[z];
      while (any(free)) {
        regions_.push_back(first_region(free));
        for (std::size_t z = 0; z < free.size(); ++z) free[z] &= ~regions_.back()[z];
      }
    }
    begin_.push_back(static_cast<std::uint32_t>(regions_.size()));
    parent_.resize(regions_.size() + surface.entry.size());
    std::iota(parent_.begin(), parent_.end(), 0U);
    brick_of_region_.resize(regions_.size());
    for (std::size_t i = 0; i < surface.brick.size(); ++i) {
      std::fill(brick_of_region_.begin() + begin_[i], brick_of_region_.begin() + begin_[i + 1], surface.brick[i]);
    }
    connect_bricks();
  }

  [[nodiscard]] std::size_t nodes() const { return parent_.size(); }
  [[nodiscard]] std::uint32_t begin(std::uint32_t entry) const { return begin_[entry]; }
  [[nodiscard]] const BrickMask& region(std::uint32_t node) const { return regions_[node]; }
  [[nodiscard]] std::uint32_t node_of_empty(std::size_t brick) const {
    return static_cast<std::uint32_t>(regions_.size() + brick);
  }
  [[nodiscard]] bool exists(std::uint32_t node) const {
    return node < regions_.size() || surface_.entry[node - regions_.size()] == kNoSurface;
  }

  [[nodiscard]] std::uint32_t root(std::uint32_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }

  /// The node of an untouched cell, or kNoSurface if the cell is surface.
  [[nodiscard]] std::uint32_t node_at(const Eigen::Vector3i& cell) const {
    const Eigen::Vector3i brick = cell / kBrickSide;
    const std::size_t index = brick_index(brick.x(), brick.y(), brick.z(), surface_.bricks);
    const std::uint32_t entry = surface_.entry[index];
    if (entry == kNoSurface) return node_of_empty(index);
    for (std::uint32_t node = begin_[entry]; node < begin_[entry + 1]; ++node) {
      if (contains(regions_[node], cell.x() & 7, cell.y() & 7, cell.z() & 7)) return node;
    }
    return kNoSurface;
  }

  /// A node's first cell in raster order (z, y, x).
  [[nodiscard]] Eigen::Vector3i first_cell(std::uint32_t node) const {
    if (node >= regions_.size()) return brick_corner(node - regions_.size(), surface_.bricks);
    const BrickMask& mask = regions_[node];
    int z = 0;
    while (mask[static_cast<std::size_t>(z)] == 0) ++z;
    const int bit = std::countr_zero(mask[static_cast<std::size_t>(z)]);
    return brick_corner(brick_of_region_[node], surface_.bricks) + Eigen::Vector3i(bit & 7, bit >> 3, z);
  }

  [[nodiscard]] std::uint64_t raster_key(std::uint32_t node) const {
    const Eigen::Matrix<std::uint64_t, 3, 1> cell = first_cell(node).cast<std::uint64_t>();
    const Eigen::Matrix<std::uint64_t, 3, 1> cells = (kBrickSide * surface_.bricks).cast<std::uint64_t>();
    return (cell.z() * cells.y() + cell.y()) * cells.x() + cell.x();
  }

 private:
  /// The root of two joined nodes is the one that comes first in raster order.
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (raster_key(b) < raster_key(a)) std::swap(a, b);
    parent_[b] = a;
  }

  void connect_bricks() {
    const Eigen::Vector3i& n = surface_.bricks;
    for (int z = 0; z < n.z(); ++z) {
      for (int y = 0; y < n.y(); ++y) {
        for (int x = 0; x < n.x(); ++x) {
          const std::size_t brick = brick_index(x, y, z, n);
          if (x + 1 < n.x()) connect(brick, brick_index(x + 1, y, z, n), 0);
          if (y + 1 < n.y()) connect(brick, brick_index(x, y + 1, z, n), 1);
          if (z + 1 < n.z()) connect(brick, brick_index(x, y, z + 1, n), 2);
        }
      }
    }
  }

  void connect(std::size_t lower, std::size_t upper, int axis) {
    for_each_node(lower, [&](std::uint32_t a, const BrickMask& cells_a) {
      for_each_node(upper, [&](std::uint32_t b, const BrickMask& cells_b) {
        if (meet(cells_a, cells_b, axis)) join(a, b);
      });
    });
  }

  template <class Visit>
  void for_each_node(std::size_t brick, Visit visit) const {
    const std::uint32_t entry = surface_.entry[brick];
    if (entry == kNoSurface) return visit(node_of_empty(brick), kWholeBrick);
    for (std::uint32_t node = begin_[entry]; node < begin_[entry + 1]; ++node) visit(node, regions_[node]);
  }

  const SurfaceVoxels& surface_;
  std::vector<BrickMask> regions_;
  std::vector<std::uint32_t> begin_;            // (surface bricks + 1): first region of each
  std::vector<std::uint32_t> brick_of_region_;  // (regions)
  std::vector<std::uint32_t> parent_;           // (nodes)
};

/// Winding number of every root, by node; other nodes are zero.
std::vector<std::int32_t> winding_of_roots(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface,
                                           RegionGraph& graph) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> roots;  // by raster order
  for (std::uint32_t node = 0; node < graph.nodes(); ++node) {
    if (graph.exists(node) && graph.root(node) == node) roots.emplace_back(graph.raster_key(node), node);
  }
  std::sort(roots.begin(), roots.end());
  std::vector<std::int32_t> winding(graph.nodes(), 0);
  for (std::size_t i = 1; i < roots.size(); ++i) {  // the first is the outside: it holds cell (0, 0, 0)
    const std::uint32_t node = roots[i].second;
    const Eigen::Vector3i cell = graph.first_cell(node);
    Eigen::Vector3i known = cell - Eigen::Vector3i::UnitX();
    while (graph.node_at(known) == kNoSurface) --known.x();
    const std::uint32_t neighbour = graph.root(graph.node_at(known));
    VERISIM_ASSERT(graph.raster_key(neighbour) < roots[i].first);
    winding[node] = winding[neighbour] + winding_change(mesh, lists, surface.bricks, known, cell.x());
  }
  return winding;
}

}  // namespace

Sides find_sides(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface) {
  VERISIM_ASSERT(lists.begin.size() == surface.entry.size() + 1);
  VERISIM_ASSERT(surface.cells.size() == surface.brick.size());
  VERISIM_ASSERT(is_ascending(surface.brick));
  RegionGraph graph(surface);
  const std::vector<std::int32_t> winding = winding_of_roots(mesh, lists, surface, graph);
  Sides sides;
  sides.inside.assign(surface.brick.size(), BrickMask{});
  for (std::uint32_t entry = 0; entry < surface.brick.size(); ++entry) {
    for (std::uint32_t node = graph.begin(entry); node < graph.begin(entry + 1); ++node) {
      if (winding[graph.root(node)] <= 0) continue;
      for (std::size_t z = 0; z < 8; ++z) sides.inside[entry][z] |= graph.region(node)[z];
    }
  }
  sides.brick.assign(surface.entry.size(), 0);
  for (std::size_t brick = 0; brick < surface.entry.size(); ++brick) {
    if (surface.entry[brick] != kNoSurface) continue;
    sides.brick[brick] = winding[graph.root(graph.node_of_empty(brick))] > 0 ? 1 : 0;
  }
  return sides;
}

}  // namespace verisim

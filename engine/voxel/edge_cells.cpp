#include "engine/voxel/edge_cells.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/voxel/brick_lists.hpp"
#include "engine/voxel/surface.hpp"

namespace verisim {

namespace {

struct CellRange {
  Eigen::Vector3i low, high;  // both included
};

CellRange cells_around(const Vector3d& low, const Vector3d& high, double growth) {
  return {(low.array() - growth).floor().cast<int>(), (high.array() + growth).floor().cast<int>()};
}

/// Cells of the brick at `corner` that are in the range.
BrickMask part_in_brick(const CellRange& range, const Eigen::Vector3i& corner) {
  const Eigen::Vector3i low = (range.low - corner).cwiseMax(0), high = (range.high - corner).cwiseMin(kBrickSide - 1);
  BrickMask mask{};
  if ((low.array() > high.array()).any()) return mask;
  const std::uint64_t row = (std::uint64_t{2} << high.x()) - (std::uint64_t{1} << low.x());
  std::uint64_t slice = 0;
  for (int y = low.y(); y <= high.y(); ++y) slice |= row << (8 * y);
  for (int z = low.z(); z <= high.z(); ++z) mask[static_cast<std::size_t>(z)] = slice;
  return mask;
}

auto key(const EdgeCells& cells) {
  return std::tuple(cells.brick, cells.edge);
}

class Walk {
 public:
  Walk(const Eigen::Vector3i& bricks, const std::vector<std::uint32_t>& entry_of_brick)
      : bricks_(bricks), entry_of_brick_(entry_of_brick) {}

  void follow(const GridCurve& curve, std::uint32_t edge, double distance) {
    first_of_edge_ = cells.size();
    curve.for_each_piece([&](const Vector3d& low, const Vector3d& high) {
      const CellRange near = cells_around(low, high, distance + 0.5);  // a cell's centre is half a voxel inside it
      const CellRange candidates = cells_around(low, high, kCandidateMargin);
      const Eigen::Vector3i first = (near.low.cwiseMax(0)) / kBrickSide;
      const Eigen::Vector3i last = (near.high / kBrickSide).cwiseMin(bricks_ - Eigen::Vector3i::Ones());
      for (int z = first.z(); z <= last.z(); ++z) {
        for (int y = first.y(); y <= last.y(); ++y) {
          for (int x = first.x(); x <= last.x(); ++x) {
            const std::uint32_t entry = entry_of_brick_[brick_index(x, y, z, bricks_)];
            if (entry == kNoSurface) continue;
            const Eigen::Vector3i corner = kBrickSide * Eigen::Vector3i(x, y, z);
            EdgeCells& here = cells_of(entry, edge);
            add(here.near, part_in_brick(near, corner));
            add(here.candidates, part_in_brick(candidates, corner));
          }
        }
      }
    });
  }

  std::vector<EdgeCells> cells;

 private:
  /// The record of a brick, one of the last few or a new one. A curve that returns to a brick later has two records for
  /// it.
  EdgeCells& cells_of(std::uint32_t entry, std::uint32_t edge) {
    constexpr std::size_t kRemembered = 24;
    const std::size_t oldest = std::max(first_of_edge_, cells.size() - std::min(cells.size(), kRemembered));
    for (std::size_t i = cells.size(); i-- > oldest;) {
      if (cells[i].brick == entry) return cells[i];
    }
    return cells.emplace_back(EdgeCells{.brick = entry, .edge = edge});
  }

  const Eigen::Vector3i& bricks_;
  const std::vector<std::uint32_t>& entry_of_brick_;
  std::size_t first_of_edge_ = 0;
};

}  // namespace

EdgeLists::EdgeLists(const std::vector<GridCurve>& curves, const std::vector<double>& distances,
                     const Eigen::Vector3i& bricks, const std::vector<std::uint32_t>& entry_of_brick,
                     std::size_t entries) {
  VERISIM_ASSERT(distances.size() == curves.size());
  VERISIM_ASSERT(std::ranges::all_of(distances, is_not_negative));
  VERISIM_ASSERT(entry_of_brick.size() == static_cast<std::size_t>(bricks.cast<std::int64_t>().prod()));
  Walk walk(bricks, entry_of_brick);
  for (std::uint32_t edge = 0; edge < curves.size(); ++edge) walk.follow(curves[edge], edge, distances[edge]);
  std::ranges::sort(walk.cells, {}, key);
  for (const EdgeCells& cells : walk.cells) {
    if (!cells_.empty() && key(cells_.back()) == key(cells)) {
      add(cells_.back().candidates, cells.candidates);
      add(cells_.back().near, cells.near);
    } else {
      cells_.push_back(cells);
    }
  }
  begin_.reserve(entries + 1);
  std::size_t at = 0;
  for (std::size_t entry = 0; entry <= entries; ++entry) {
    while (at < cells_.size() && cells_[at].brick < entry) ++at;
    begin_.push_back(at);
  }
}

}  // namespace verisim

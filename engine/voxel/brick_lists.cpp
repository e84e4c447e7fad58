#include "engine/voxel/brick_lists.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {

namespace {

/// The bricks that one triangle touches, in no particular order, each once.
template <class Visit>
class Descent {
 public:
  Descent(const TriangleOverlap& triangle, const Eigen::Vector3i& bricks, double margin, Visit visit)
      : triangle_(triangle), bricks_(bricks), margin_(margin), visit_(visit) {}

  void run() {
    Eigen::Vector3i first, last;  // bricks of the bounding box
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = static_cast<int>(std::floor((triangle_.lower()[axis] - margin_) / kBrickSide));
      last[axis] = static_cast<int>(std::floor((triangle_.upper()[axis] + margin_) / kBrickSide));
    }
    if (first == last) return visit_(brick_index(first.x(), first.y(), first.z(), bricks_));
    int shift = 0;  // cubes of 2^shift bricks, so large that eight along each axis hold the bounding box
    while (((last.array() / (1 << shift)) - (first.array() / (1 << shift))).maxCoeff() >= kBrickSide) {
      shift += kBrickShift;
    }
    descend((first.array() / (1 << shift)) * (1 << shift), shift);
  }

 private:
  void descend(const Eigen::Vector3i& first_brick, int shift) {
    const double side = static_cast<double>(kBrickSide) * (1 << shift);
    const BrickMask mask = triangle_.touched(
        {.corner = kBrickSide * first_brick.cast<double>(), .side = side, .half_side = 0.5 * side + margin_});
    for_each_cell(mask, [&](int x, int y, int z) {
      const Eigen::Vector3i brick = first_brick + (1 << shift) * Eigen::Vector3i(x, y, z);
      if (shift > 0) return descend(brick, shift - kBrickShift);
      if ((brick.array() < bricks_.array()).all()) visit_(brick_index(brick.x(), brick.y(), brick.z(), bricks_));
    });
  }

  const TriangleOverlap& triangle_;
  const Eigen::Vector3i& bricks_;
  double margin_;
  Visit visit_;
};

/// Visits every (brick, triangle), the last triangle first.
template <class Visit>
void for_each_entry(const GridMesh& mesh, const Eigen::Vector3i& bricks, double margin, Visit visit) {
  for (auto t = static_cast<std::uint32_t>(mesh.triangles->size()); t-- > 0;) {
    const auto [a, b, c] = mesh.corners(t);
    const TriangleOverlap overlap(a, b, c);
    Descent(overlap, bricks, margin, [&](std::size_t brick) { visit(brick, t); }).run();
  }
}

/// Does the corner lie inside the grid, farther than the margin from its walls? False for one that is not finite.
bool lies_within(const Vector3d& corner, const Eigen::Vector3i& bricks, double margin) {
  const Vector3d size = (kBrickSide * bricks).cast<double>();
  return (corner.array() > margin).all() && (corner.array() < size.array() - margin).all();
}

}  // namespace

GridMesh in_grid_coordinates(const TriangleMesh& mesh, const Voxmap& map) {
  VERISIM_ASSERT(is_positive(map.voxel_size));
  GridMesh result{.vertices = {}, .triangles = &mesh.triangles};
  result.vertices.reserve(mesh.vertices.size());
  for (const Vector3d& p_B : mesh.vertices) result.vertices.push_back((p_B - map.origin) / map.voxel_size);
  return result;
}

// Two passes, the first to count: the lists get their exact size and need no sorting.
BrickLists list_triangles_by_brick(const GridMesh& mesh, const Eigen::Vector3i& bricks, double margin) {
  VERISIM_ASSERT(is_not_negative(margin));
  for (const auto& triangle : *mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      VERISIM_ASSERT(corner < mesh.vertices.size());
      VERISIM_ASSERT(lies_within(mesh.vertices[corner], bricks, margin));
    }
  }
  BrickLists lists;
  const auto count = static_cast<std::size_t>(bricks.cast<std::int64_t>().prod());
  lists.begin.assign(count + 1, 0);
  for_each_entry(mesh, bricks, margin, [&](std::size_t brick, std::uint32_t) { ++lists.begin[brick]; });
  std::uint64_t entries = 0;
  for (std::uint32_t& begin : lists.begin) {
    entries += begin;
    begin =
        static_cast<std::uint32_t>(entries);  // the brick's end; the second walk fills downwards and leaves the begin
  }
  VERISIM_ASSERT(entries <= std::numeric_limits<std::uint32_t>::max());
  lists.triangle.resize(entries);
  for_each_entry(mesh, bricks, margin,
                 [&](std::size_t brick, std::uint32_t t) { lists.triangle[--lists.begin[brick]] = t; });
  return lists;
}

}  // namespace verisim

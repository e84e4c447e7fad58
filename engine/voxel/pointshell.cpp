#include "engine/voxel/pointshell.hpp"

#include <cmath>
#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/voxel/normals.hpp"
#include "engine/voxel/parallel.hpp"

namespace verisim {

namespace {

void resize(Pointshell& shell, std::size_t n) {
  for (auto* column : {&shell.x, &shell.y, &shell.z, &shell.nx, &shell.ny, &shell.nz}) column->resize(n);
}

Vector3f point(const Pointshell& shell, std::size_t i) {
  return {shell.x[i], shell.y[i], shell.z[i]};
}

/// The ball about the centre of the points' bounding box, rounded up so that in real numbers it covers every point.
Pointshell::Cluster cluster_of(const Pointshell& shell, std::uint32_t begin, std::uint32_t end) {
  Vector3f low = point(shell, begin), high = low;
  for (std::uint32_t i = begin; i < end; ++i) {
    low = low.cwiseMin(point(shell, i));
    high = high.cwiseMax(point(shell, i));
  }
  const Vector3f center = 0.5F * (low + high);
  double radius_squared = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vector3d arm = point(shell, i).cast<double>() - center.cast<double>();
    radius_squared = std::max(radius_squared, arm.squaredNorm());
  }
  const auto radius = static_cast<float>(std::sqrt(radius_squared));
  return {begin, end, center, std::nextafter(radius, std::numeric_limits<float>::infinity())};
}

}  // namespace

Pointshell make_pointshell(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface,
                           const Voxmap& map, const Vector3d& reference, unsigned threads) {
  VERISIM_ASSERT(map.surface_count == surface.voxels);
  VERISIM_ASSERT(map.brick_block.size() == surface.entry.size());
  VERISIM_ASSERT(lists.begin.size() == surface.entry.size() + 1);
  VERISIM_ASSERT(is_finite(reference));
  Pointshell shell;
  shell.reference = reference;
  resize(shell, map.surface_count);
  shell.clusters.resize(surface.brick.size());
  for_each_chunk(surface.brick.size(), threads, [&](std::size_t begin, std::size_t end) {
    BrickNormals normals(mesh);
    for (std::size_t entry = begin; entry < end; ++entry) {
      const std::size_t brick = surface.brick[entry];
      const Eigen::Vector3i corner = brick_corner(brick, surface.bricks);
      const std::span<const Vector3d> inward = normals.compute(lists.of(brick), corner, surface.cells[entry]);
      const std::uint32_t first = map.first_surface[map.brick_block[brick]][0];
      std::uint32_t i = first;
      for_each_cell(surface.cells[entry], [&](int x, int y, int z) {
        const Vector3f p = (map.center_of(corner + Eigen::Vector3i(x, y, z)) - reference).cast<float>();
        const Vector3f n = inward[i - first].cast<float>();
        shell.x[i] = p.x(), shell.y[i] = p.y(), shell.z[i] = p.z();
        shell.nx[i] = n.x(), shell.ny[i] = n.y(), shell.nz[i] = n.z();
        ++i;
      });
      shell.clusters[entry] = cluster_of(shell, first, i);
    }
  });
  return shell;
}

namespace {

/// A point's data for thinning.
struct Candidate {
  Eigen::Vector3i cube;
  int direction;    ///< 0..5: axis of the largest component of the normal, and its sign
  double distance;  ///< squared, from the cube's centre [cube]
  std::uint32_t index;
};

/// Of nearly equal components the first counts, so that a chamfer does not flicker between two directions.
int main_direction(const Vector3f& n) {
  constexpr float kNearlyEqual = 1e-3F;
  const Vector3f size = n.cwiseAbs();
  const float largest = size.maxCoeff() - kNearlyEqual;
  const int axis = size.x() >= largest ? 0 : size.y() >= largest ? 1 : 2;
  return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

Candidate candidate_of(const Pointshell& shell, const Voxmap& map, double spacing, std::uint32_t i) {
  const Vector3d p = (point(shell, i).cast<double>() + shell.reference - map.origin) / spacing;
  const Vector3d corner = p.array().floor();
  // In a lattice of voxel centres many points are equally far, up to rounding. They count as equal.
  const double distance = std::round((p - corner - Vector3d::Constant(0.5)).squaredNorm() * 0x1p20);
  return {corner.cast<int>(), main_direction({shell.nx[i], shell.ny[i], shell.nz[i]}), distance, i};
}

std::array<int, 3> group_of(const Candidate& c) {
  return {c.cube.z() >> 3, c.cube.y() >> 3, c.cube.x() >> 3};
}

std::array<int, 4> cell_of(const Candidate& c) {
  return {c.cube.z(), c.cube.y(), c.cube.x(), c.direction};
}

}  // namespace

Pointshell thinned(const Pointshell& shell, const Voxmap& map, double spacing) {
  VERISIM_ASSERT(is_positive(spacing));
  VERISIM_ASSERT(shell.voxel.empty());
  VERISIM_ASSERT(shell.size() == map.surface_count);
  std::vector<Candidate> candidates;
  candidates.reserve(shell.size());
  for (std::uint32_t i = 0; i < shell.size(); ++i) candidates.push_back(candidate_of(shell, map, spacing, i));
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(cell_of(a), a.distance, a.index) < std::tuple(cell_of(b), b.distance, b.index);
  });
  const auto same_cell = [](const Candidate& a, const Candidate& b) { return cell_of(a) == cell_of(b); };
  candidates.erase(std::unique(candidates.begin(), candidates.end(), same_cell), candidates.end());
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(group_of(a), a.index) < std::tuple(group_of(b), b.index);
  });

  Pointshell result;
  result.reference = shell.reference;
  resize(result, candidates.size());
  result.voxel.resize(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::uint32_t from = candidates[i].index;
    result.x[i] = shell.x[from], result.y[i] = shell.y[from], result.z[i] = shell.z[from];
    result.nx[i] = shell.nx[from], result.ny[i] = shell.ny[from], result.nz[i] = shell.nz[from];
    result.voxel[i] = from;
  }
  std::uint32_t begin = 0;
  for (std::uint32_t end = 1; end <= candidates.size(); ++end) {
    const bool full = end - begin == kBrickCells;
    if (full || end == candidates.size() || group_of(candidates[end]) != group_of(candidates[begin])) {
      result.clusters.push_back(cluster_of(result, begin, end));
      begin = end;
    }
  }
  return result;
}

}  // namespace verisim

#include "engine/voxel/limits.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/voxel/brick_mask.hpp"

namespace verisim {

namespace {

constexpr double kBytesPerPoint = 6 * sizeof(float);
constexpr double kBytesPerBlock = kBrickCells * sizeof(Layer) + sizeof(BrickMask) + sizeof(std::uint32_t);
constexpr double kBytesPerBrick = sizeof(std::uint32_t) + sizeof(Layer);

/// The largest number that may index a brick, a surface voxel or a cell along an axis.
constexpr double kIndexLimit = 4e9;
constexpr double kAxisLimit = 1 << 24;

/// `size` rounded up to the given number of significant decimal digits.
double rounded_up(double size, int digits) {
  const double unit = std::pow(10.0, std::floor(std::log10(size)) - (digits - 1));
  return std::ceil(size / unit * (1 - 0x1p-40)) * unit;
}

/// A usual voxel size: a fiftieth of the part, to one digit, as a script would write it.
std::string usual_size(double longest) {
  return fmt::format("mm({:.4g})", 1000 * rounded_up(longest / 50, 1));
}

[[noreturn]] void refuse_for_memory(const std::string& name, const MemoryEstimate& estimate, double bytes,
                                    const VoxelizeOptions& options) {
  constexpr double kMegabyte = 1e6;
  fail(ErrorKind::input, "{}: voxelsize {:.6g} m would take {:.0f} MB but {:.0f} MB are allowed; {:.3g} m or more fits",
       name, options.voxel_size, bytes / kMegabyte, static_cast<double>(options.memory_limit) / kMegabyte,
       estimate.smallest_size(static_cast<double>(options.memory_limit)));
}

}  // namespace

Bounds checked_bounds(const std::string& name, const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) fail(ErrorKind::input, "{}: has no triangles; check the model or its export", name);
  Bounds bounds;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size()) {
        fail(ErrorKind::input, "{}: triangle {} names vertex {} of {}; repair the mesh", name, t, v,
             mesh.vertices.size());
      }
      if (!mesh.vertices[v].allFinite()) {
        fail(ErrorKind::input, "{}: vertex {} is not finite; repair the mesh", name, v);
      }
      bounds.include(mesh.vertices[v]);
    }
  }
  return bounds;
}

MemoryEstimate::MemoryEstimate(const TriangleMesh& mesh, const Bounds& bounds) : size_(bounds.size()) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d& p = mesh.vertices[a];
    projected_area_ += 0.5 * (mesh.vertices[b] - p).cross(mesh.vertices[c] - p).cwiseAbs().sum();
  }
}

double MemoryEstimate::bytes(double voxel_size) const {
  VERISIM_ASSERT(voxel_size > 0);
  const double voxels = projected_area_ / (voxel_size * voxel_size);
  // Blocks are the bricks within the band: a layer one brick and twice the band thick.
  const double blocks = voxels * (kBrickSide + 2 * kBand) / kBrickCells + 2;
  const double bricks = ((size_ / (kBrickSide * voxel_size)).array() + 3).prod();
  return voxels * kBytesPerPoint + blocks * kBytesPerBlock + bricks * kBytesPerBrick;
}

double MemoryEstimate::smallest_size(double limit) const {
  VERISIM_ASSERT(is_positive(size_.maxCoeff()));
  double low = 0, high = size_.maxCoeff();
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (bytes(middle) <= limit ? high : low) = middle;
  }
  return rounded_up(high, 2);
}

void check_voxel_size(const std::string& name, const TriangleMesh& mesh, const Bounds& bounds,
                      const VoxelizeOptions& options) {
  const double longest = bounds.size().maxCoeff();
  const double size = options.voxel_size;
  if (!(longest > 0)) fail(ErrorKind::input, "{}: is a single point; check the model and its scale", name);
  if (!std::isfinite(size)) {
    fail(ErrorKind::input, "{}: voxelsize is {} m but must be finite; '{}' measures {:.4g} m, {} is usual", name, size,
         name, longest, usual_size(longest));
  }
  if (size <= 0) {
    fail(ErrorKind::input, "{}: voxelsize is {} m but must be above 0; '{}' measures {:.4g} m, {} is usual", name, size,
         name, longest, usual_size(longest));
  }
  if (size > longest) {
    fail(ErrorKind::input, "{}: voxelsize is {} m but '{}' measures only {:.4g} m; {} is usual", name, size, name,
         longest, usual_size(longest));
  }
  const MemoryEstimate estimate(mesh, bounds);
  const double bytes = estimate.bytes(size);
  const double bricks = ((bounds.size() / (kBrickSide * size)).array() + 3).prod();
  const bool countable = longest / size < kAxisLimit && bricks < kIndexLimit && bytes / kBytesPerPoint < kIndexLimit;
  if (!countable || bytes > static_cast<double>(options.memory_limit)) {
    refuse_for_memory(name, estimate, bytes, options);
  }
  if (!std::isfinite(options.point_spacing) || options.point_spacing < 0) {
    fail(ErrorKind::input, "{}: point spacing is {} m but must be 0 (every surface voxel) or above", name,
         options.point_spacing);
  }
}

void check_result_size(const std::string& name, const TriangleMesh& mesh, const Bounds& bounds,
                       const VoxelizeOptions& options, double bytes) {
  if (bytes <= static_cast<double>(options.memory_limit)) return;
  refuse_for_memory(name, MemoryEstimate(mesh, bounds), bytes, options);
}

}  // namespace verisim

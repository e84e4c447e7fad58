// Voxelization from triangles to the finished voxmap and pointshell: the dissertation's block (0.375 x 0.375 x 0.2 m,
// hole of radius 0.075 m) at several voxel sizes, and shapes that are hard in other ways. Time per surface voxel, bytes
// that stay. A run fails if it finds another number of surface voxels than the plain count.
#include <benchmark/benchmark.h>

#include <map>

#include "bench/promise.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/plain.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim {
namespace {

/// The same in a test run, but with few voxels.
double size_or_coarse(double voxel_size) {
  return bench::smoke() ? std::max(voxel_size, 0.004) : voxel_size;
}

/// Counted once per name and size: the library calls a benchmark several times to find its number of iterations.
std::size_t plain_count(const std::string& name, const TriangleMesh& mesh, const Voxmap& map) {
  static std::map<std::pair<std::string, double>, std::size_t> known;
  const auto [at, is_new] = known.try_emplace({name, map.voxel_size}, 0);
  if (is_new) at->second = plain::surface_count(mesh, map);
  return at->second;
}

void run(benchmark::State& state, const std::string& name, const TriangleMesh& mesh, const VoxelizeOptions& options) {
  VoxelBody body;
  for (auto _ : state) body = voxelize(name, mesh, options);
  if (body.voxmap.surface_count != plain_count(name, mesh, body.voxmap)) {
    bench::wrong(state, "fast and plain voxelization disagree");
  }
  const auto voxels = static_cast<double>(body.voxmap.surface_count);
  const auto bytes = static_cast<double>(body.voxmap.memory_bytes() + body.shell.memory_bytes());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(body.voxmap.surface_count));
  state.counters["surface_voxels"] = voxels;
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
  state.counters["bytes"] = bytes;
  state.counters["bytes_per_voxel"] = bytes / voxels;
}

/// The trial's block. Argument: voxel size [um].
void BM_VoxelizeBlock(benchmark::State& state) {
  const double size = size_or_coarse(1e-6 * static_cast<double>(state.range(0)));
  run(state, "block", shapes::trial_block(), {.voxel_size = size});
}
BENCHMARK(BM_VoxelizeBlock)->Arg(4500)->Arg(2000)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);

/// The block askew: no face lies along the grid, so every brick holds slanted triangles.
void BM_VoxelizeTiltedBlock(benchmark::State& state) {
  const Eigen::AngleAxisd tilt(0.5, Vector3d(1, 2, 3).normalized());
  const auto turned = [&](const Vector3d& p) { return Vector3d(tilt * p); };
  run(state, "tilted", shapes::mapped(shapes::trial_block(), turned), {.voxel_size = size_or_coarse(0.001)});
}
BENCHMARK(BM_VoxelizeTiltedBlock)->Unit(benchmark::kMillisecond);

/// A scan: far more triangles than voxels. Argument: refinements of an octahedron (8 * 4^n triangles).
void BM_VoxelizeFineSphere(benchmark::State& state) {
  const int refinements = bench::smoke() ? 4 : static_cast<int>(state.range(0));
  run(state, "sphere " + std::to_string(refinements), shapes::sphere(0.1, refinements), {.voxel_size = 0.002});
}
BENCHMARK(BM_VoxelizeFineSphere)->Arg(5)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim

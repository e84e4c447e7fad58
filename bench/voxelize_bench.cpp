// Voxelization of the dissertation's block (0.375 x 0.375 x 0.2 m, hole of radius 0.075 m) and of shapes that are hard in
// other ways: voxmap and pointshell, from triangles to the finished body. Time per surface voxel, bytes that stay.
#include <benchmark/benchmark.h>

#include <cstdlib>

#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim {
namespace {

bool smoke() { return std::getenv("VERISIM_BENCH_SMOKE") != nullptr; }

/// The same in a test run, but with fewer voxels.
double size_or_coarser(double voxel_size) { return smoke() ? std::max(voxel_size, 0.004) : voxel_size; }

void run(benchmark::State& state, const TriangleMesh& mesh, const VoxelizeOptions& options,
         std::uint32_t expected_voxels) {
  VoxelBody body;
  for (auto _ : state) body = voxelize("bench", mesh, options);
  if (expected_voxels != 0 && body.voxmap.surface_count != expected_voxels) {
    state.SkipWithError(("counted " + std::to_string(body.voxmap.surface_count) + " surface voxels").c_str());
  }
  const auto voxels = static_cast<double>(body.voxmap.surface_count);
  const auto bytes = static_cast<double>(body.voxmap.memory_bytes() + body.shell.memory_bytes());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(body.voxmap.surface_count));
  state.counters["surface_voxels"] = voxels;
  state.counters["bytes"] = bytes;
  state.counters["bytes_per_voxel"] = bytes / voxels;
}


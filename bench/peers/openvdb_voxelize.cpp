// Voxelizing the dissertation's block: verisim (voxmap with signed layers, pointshell with normals) beside OpenVDB's
// meshToLevelSet (narrow-band signed distances, its default band of 3 voxels either way), same mesh, voxel size and
// run. Real time, since OpenVDB uses as many threads as there are cores; "one_thread" holds it to one, as verisim is.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim {
namespace {

double voxel_size(const benchmark::State& state) {
  return 1e-6 * static_cast<double>(state.range(0));
}

void BM_Verisim(benchmark::State& state) {
  const TriangleMesh mesh = shapes::trial_block();
  VoxelBody body;
  for (auto _ : state) body = voxelize("block", mesh, {.voxel_size = voxel_size(state)});
  if (body.voxmap.layer_at({0.1, 0.1, 0}) >= 0) state.SkipWithError("the block's material is not inside");
  state.counters["surface_voxels"] = static_cast<double>(body.voxmap.surface_count);
  state.counters["bytes"] = static_cast<double>(body.voxmap.memory_bytes() + body.shell.memory_bytes());
}

void openvdb_level_set(benchmark::State& state) {
  const TriangleMesh mesh = shapes::trial_block();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vector3d& p : mesh.vertices) points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size(state));
  openvdb::FloatGrid::Ptr grid;
  for (auto _ : state) grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles);
  const openvdb::Coord inside = openvdb::Coord::round(transform->worldToIndex({0.1, 0.1, 0}));
  if (grid->tree().getValue(inside) >= 0) state.SkipWithError("the block's material is not inside");
  state.counters["active_voxels"] = static_cast<double>(grid->activeVoxelCount());
  state.counters["bytes"] = static_cast<double>(grid->memUsage());
}

void BM_OpenVdb(benchmark::State& state) {
  openvdb_level_set(state);
}

void BM_OpenVdb_one_thread(benchmark::State& state) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  openvdb_level_set(state);
}

#define VERISIM_SIZES Arg(4500)->Arg(500)->Unit(benchmark::kMillisecond)->UseRealTime()
BENCHMARK(BM_Verisim)->VERISIM_SIZES;
BENCHMARK(BM_OpenVdb)->VERISIM_SIZES;
BENCHMARK(BM_OpenVdb_one_thread)->VERISIM_SIZES;

}  // namespace
}  // namespace verisim

int main(int argc, char** argv) {
  openvdb::initialize();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

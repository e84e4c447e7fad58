// Association of surface voxels with faces and edges, beside the voxelization of the same part: the dissertation's
// block and pin, and a plate with many holes. Time per surface voxel. A run fails if a sample of voxels holds anything
// else than what plain arithmetic finds of the parts' planes and cylinders.
#include <benchmark/benchmark.h>

#include <chrono>

#include "bench/promise.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {
namespace {

Solid solid(Solid::Kind kind, std::vector<double> sizes) {
  return {kind, std::move(sizes), {}, {}};
}
Solid placed(const Solid& child, const Pose& pose) {
  return {Solid::Kind::placed, {}, {std::make_shared<const Solid>(child)}, pose};
}
Solid without(const Solid& a, const Solid& b) {
  return {Solid::Kind::difference, {}, {std::make_shared<const Solid>(a), std::make_shared<const Solid>(b)}, {}};
}

Solid block() {
  return without(solid(Solid::Kind::box, {0.375, 0.375, 0.2}), solid(Solid::Kind::cylinder, {0.075, 0.3}));
}
Solid tilted_block() {
  return placed(block(), {Vector3d::Zero(), Quaterniond(Eigen::AngleAxisd(0.5, Vector3d(1, 2, 3).normalized()))});
}
Solid ball() {
  return solid(Solid::Kind::sphere, {0.15});
}
Solid plate() {
  Solid result = solid(Solid::Kind::box, {0.4, 0.4, 0.02});
  for (int i = 0; i < 36; ++i) {
    const Vector3d at(-0.15 + 0.06 * (i % 6), -0.15 + 0.06 * (i / 6), 0);
    result =
        without(result, placed(solid(Solid::Kind::cylinder, {0.01 + 0.0003 * i, 0.1}), {at, Quaterniond::Identity()}));
  }
  return result;
}

/// Faces on planes and cylinders that do not come near a voxel's box may not be in its set; in a voxel with one face,
/// its surface comes near the box.
bool is_plausible(const VoxelBody& body, std::uint32_t voxel, double slack) {
  const Pointshell& shell = body.shell;
  const Vector3d p = Vector3f(shell.x[voxel], shell.y[voxel], shell.z[voxel]).cast<double>() + shell.reference;
  const double reach = std::sqrt(3.0) / 2 * body.voxmap.voxel_size + slack;
  const std::span<const EntityNumber> set = body.features.sets[shell.features[voxel]];
  if (set.empty()) return false;
  for (const EntityNumber e : set) {
    if (!body.features.is_face(e)) continue;
    const Surface& surface = body.features.face(e).surface;
    double distance = 0;
    if (const auto* plane = std::get_if<Plane>(&surface)) distance = (p - plane->point).dot(plane->normal);
    if (const auto* c = std::get_if<Cylinder>(&surface)) {
      const Vector3d arm = p - c->point;
      distance = (arm - arm.dot(c->direction) * c->direction).norm() - c->radius;
    }
    if (const auto* s = std::get_if<Sphere>(&surface)) distance = (p - s->center).norm() - s->radius;
    if (std::abs(distance) > reach) return false;
  }
  return true;
}

void run(benchmark::State& state, const Solid& shape, double voxel_size, unsigned threads) {
  const Part part = load_solid(shape, {});
  VoxelBody body = voxelize("part", part.mesh, {.voxel_size = bench::smoke() ? 0.004 : voxel_size, .threads = 1});
  AssociationReport report;
  double best_s = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    report = associate("part", part, {.threads = threads}, body);
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  const double deflection = bounds_of(part.mesh).size().norm() / 2000;
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    if (!is_plausible(body, i, deflection)) bench::wrong(state, "a voxel holds an entity that is far from it");
  }
  if (report.loose_faces + report.without > 0) bench::wrong(state, "a face was not understood");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(body.voxmap.surface_count));
  state.counters["surface_voxels"] = body.voxmap.surface_count;
  bench::at_least(state, "voxels_per_s", body.voxmap.surface_count / best_s, 1e6);
  state.counters["sets"] = static_cast<double>(body.features.sets.size() - 1);
  state.counters["stand_ins"] = report.stand_ins;
}

// Arguments: voxel size [um], threads.
void BM_AssociateBlock(benchmark::State& state) {
  run(state, block(), 1e-6 * static_cast<double>(state.range(0)), static_cast<unsigned>(state.range(1)));
}
BENCHMARK(BM_AssociateBlock)
    ->Args({4500, 1})
    ->Args({1000, 1})
    ->Args({1000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_AssociateTiltedBlock(benchmark::State& state) {
  run(state, tilted_block(), 1e-6 * static_cast<double>(state.range(0)), static_cast<unsigned>(state.range(1)));
}
BENCHMARK(BM_AssociateTiltedBlock)->Args({1000, 1})->Args({1000, 2})->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_AssociateBall(benchmark::State& state) {
  run(state, ball(), 1e-6 * static_cast<double>(state.range(0)), static_cast<unsigned>(state.range(1)));
}
BENCHMARK(BM_AssociateBall)->Args({1000, 1})->Args({1000, 2})->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_AssociatePlate(benchmark::State& state) {
  run(state, plate(), 1e-6 * static_cast<double>(state.range(0)), static_cast<unsigned>(state.range(1)));
}
BENCHMARK(BM_AssociatePlate)->Args({1000, 1})->Args({1000, 2})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace verisim

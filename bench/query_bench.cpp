// The contact query and what follows it: time per pointshell point against the bound of the same run, and time per pose
// over the recorded poses of the pin in the block against the plain scalar loop of the same run.
#include <benchmark/benchmark.h>

#include <map>

#include "bench/gather_bound.hpp"
#include "bench/peg_scene.hpp"
#include "bench/plain_loop.hpp"
#include "bench/pose_times.hpp"
#include "bench/promise.hpp"
#include "engine/contact/penalty.hpp"
#include "engine/contact/query.hpp"
#include "tests/contact/query_plainly.hpp"

namespace verisim::bench {
namespace {

constexpr double kTrialVoxelSize = 0.0045;
constexpr double kStiffness = 1000;  // N/m per contact: any number will do

/// Every n-th of the recorded poses; without the recording, a few made ones so that the suite still runs.
std::vector<Pose> poses(std::size_t stride) {
  const std::vector<Pose> all = load_peg_poses().X_AB;
  std::vector<Pose> some;
  for (std::size_t i = 0; i < all.size(); i += stride) some.push_back(all[i]);
  for (int i = 0; all.empty() && i < 20; ++i) {
    some.push_back({{0.004, 0, 0.3 - 0.02 * i}, rotation_from_vector({0.01, 0.005, 0.3 * i})});
  }
  return some;
}

const PegScene& scene(double voxel_size) {
  static std::map<double, PegScene> scenes;
  const auto [at, is_new] = scenes.try_emplace(voxel_size);
  if (is_new) at->second = make_peg_scene(voxel_size);
  return at->second;
}

bool same(const ContactList& a, const ContactList& b) {
  if (a.size != b.size) return false;
  for (std::uint32_t i = 0; i < a.size; ++i) {
    if (a.point[i] != b.point[i] || a.slot[i] != b.slot[i] || a.depth[i] != b.depth[i]) return false;
  }
  return true;
}

/// Argument: voxel size [um]. Items are pointshell points, culled ones included; `bound_ns` and `ratio` are of this
/// run.
void BM_Query(benchmark::State& state) {
  const double voxel_size = 1e-6 * static_cast<double>(state.range(0));
  const PegScene& s = scene(smoke() ? std::max(voxel_size, kTrialVoxelSize) : voxel_size);
  const std::size_t points = s.pin.shell.size();
  const std::vector<Pose> some = poses(smoke() ? 100 : 1 + points / 20000);
  ContactList list(points);
  ContactList plain(points);
  QueryCost cost;
  QueryCost plain_cost;
  const GatherBound bound(s.block.voxmap);
  for (std::size_t i = 0; i < some.size(); i += 10) {
    query(s.block.voxmap, s.pin.shell, some[i], list, cost);
    test::query_plainly(s.block.voxmap, s.pin.shell, some[i], plain, plain_cost);
    if (!same(list, plain)) wrong(state, "fast and plain query disagree");
    if (bound.sum(s.pin.shell, some[i]) != bound.sum_plainly(s.pin.shell, some[i])) wrong(state, "wrong bound");
  }

  cost = {};
  std::uint64_t contacts = 0;
  PoseTimes query_times(some);
  PoseTimes bound_times(some);
  std::uint64_t sums = 0;
  for (auto _ : state) {
    query_times.round([&](const Pose& X) {
      query(s.block.voxmap, s.pin.shell, X, list, cost);
      contacts += list.size;
    });
    state.PauseTiming();
    bound_times.round([&](const Pose& X) { sums += bound.sum(s.pin.shell, X); });
    state.ResumeTiming();
  }
  benchmark::DoNotOptimize(sums);
  const auto queries = static_cast<double>(state.iterations()) * static_cast<double>(some.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(queries) * static_cast<std::int64_t>(points));
  state.counters["points"] = static_cast<double>(points);
  state.counters["points_looked_up"] = static_cast<double>(cost.points) / queries;
  state.counters["candidates"] = static_cast<double>(cost.candidates) / queries;
  state.counters["contacts"] = static_cast<double>(contacts) / queries;
  state.counters["query_ns_point"] = 1000 * query_times.mean() / static_cast<double>(points);
  state.counters["bound_ns_point"] = 1000 * bound_times.mean() / static_cast<double>(points);
  at_most(state, "ratio", query_times.mean() / bound_times.mean(), 2);
}
BENCHMARK(BM_Query)->Arg(16000)->Arg(4500)->Arg(1600)->Arg(500)->Unit(benchmark::kMillisecond);

/// The frame of the dissertation's trial: query, penalty and sum, against the plain loop over the same points. Counters
/// are us per pose; the ratios are those of the medians and of the 99th percentile to the loop's median.
void BM_PegPoses(benchmark::State& state) {
  const PegScene& s = scene(kTrialVoxelSize);
  const std::vector<Pose> some = poses(smoke() ? 100 : 1);
  const PlainLoop plain(s.block.voxmap, s.pin.shell);
  ContactList list(s.pin.shell.size());
  QueryCost cost;
  const Twist at_rest;
  const auto respond = [&](const Pose& X) {
    query(s.block.voxmap, s.pin.shell, X, list, cost);
    apply_penalty(list, Vector3d::Zero(), at_rest, kStiffness, 0);
    return sum(list, Vector3d::Zero()).wrench;
  };
  for (const Pose& X : some) {  // the loop rounds in double: points at a voxel wall or a depth of zero may differ
    const Wrench w = plain.force(X, kStiffness);
    if ((w.force - respond(X).force).norm() > 1e-3 * (1 + w.force.norm())) wrong(state, "the plain loop disagrees");
  }
  PoseTimes query_times(some);
  PoseTimes frame_times(some);
  PoseTimes plain_times(some);
  Wrench total;
  for (auto _ : state) {
    query_times.round([&](const Pose& X) { query(s.block.voxmap, s.pin.shell, X, list, cost); });
    frame_times.round([&](const Pose& X) { total += respond(X); });
    plain_times.round([&](const Pose& X) { total += plain.force(X, kStiffness); });
  }
  benchmark::DoNotOptimize(total);
  const double unit = plain_times.percentile(0.5);
  state.counters["query_us"] = query_times.percentile(0.5);
  state.counters["query_us_p99"] = query_times.percentile(0.99);
  state.counters["frame_us"] = frame_times.percentile(0.5);
  state.counters["frame_us_p99"] = frame_times.percentile(0.99);
  state.counters["plain_us"] = unit;
  at_most(state, "frame_ratio", frame_times.percentile(0.5) / unit, 0.6);
  at_most(state, "frame_ratio_p99", frame_times.percentile(0.99) / unit, 2);
}
BENCHMARK(BM_PegPoses)->Unit(benchmark::kMillisecond);

/// Every SIMD target on the same poses; the argument is its place in simd_targets().
void BM_Target(benchmark::State& state) {
  const std::vector<std::string> targets = simd_targets();
  const std::string& target = targets[static_cast<std::size_t>(state.range(0)) % targets.size()];
  const PegScene& s = scene(kTrialVoxelSize);
  const std::vector<Pose> some = poses(smoke() ? 100 : 10);
  ContactList list(s.pin.shell.size());
  QueryCost cost;
  use_simd_target(target);
  for (auto _ : state) {
    for (const Pose& X : some) query(s.block.voxmap, s.pin.shell, X, list, cost);
  }
  use_simd_target("");
  state.SetLabel(target);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(some.size() * s.pin.shell.size()));
}
BENCHMARK(BM_Target)->DenseRange(0, 4);

/// Response alone, per contact: argument 0 penalty and sum, 1 the contact matrix.
void BM_Response(benchmark::State& state) {
  const PegScene& s = scene(kTrialVoxelSize);
  ContactList list(s.pin.shell.size());
  QueryCost cost;
  query(s.block.voxmap, s.pin.shell, {{0.006, 0, 0}, Quaterniond::Identity()}, list, cost);
  if (list.size == 0) wrong(state, "no contacts");
  Wrench total;
  Matrix6d W = Matrix6d::Zero();
  for (auto _ : state) {
    if (state.range(0) == 0) {
      apply_penalty(list, Vector3d::Zero(), {}, kStiffness, 1);
      total += sum(list, Vector3d::Zero()).wrench;
    } else {
      W += contact_matrix(list, Vector3d::Zero());
    }
  }
  benchmark::DoNotOptimize(total);
  benchmark::DoNotOptimize(W);
  state.SetItemsProcessed(state.iterations() * list.size);
  state.counters["contacts"] = list.size;
}
BENCHMARK(BM_Response)->DenseRange(0, 1);

}  // namespace
}  // namespace verisim::bench

#include "bench/peers/measures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "bench/peg_scene.hpp"
#include "bench/pose_times.hpp"
#include "engine/base/quantile.hpp"

namespace verisim::peers {
namespace {

double bottom_of(const Pose& X) {
  return (X.position - 0.5 * kPinLength * (X.rotation * Vector3d::UnitZ())).z();
}

}  // namespace

int SettingResult::passes() const {
  return static_cast<int>(std::count_if(trials.begin(), trials.end(), [](const Trial& t) { return t.passed; }));
}

double SettingResult::worst() const {
  if (passes() == 0) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (const Trial& t : trials)
    if (t.passed) worst = std::max(worst, t.overlap / t.task.clearance);
  return worst;
}

double SettingResult::median_us() const {
  std::vector<double> times;
  for (const Trial& t : trials) times.push_back(t.us);
  return quantile(times, 0.5);
}

Trial run_trial(const Setting& setting, const Insertion& task) {
  using Clock = std::chrono::steady_clock;
  const double radius = kHoleRadius - task.clearance;
  const Hand first = hand_at(task, 0);
  const std::unique_ptr<Peer> peer = setting.make(task, {first.position, first.rotation});
  Trial trial{.task = task};
  std::vector<double> times;
  for (int i = 0; i < exact::test::steps_of(task); ++i) {
    const Hand hand = hand_at(task, i * kStep);
    const Vector3d before = peer->motion().v;
    const auto start = Clock::now();
    const Vector3d pull = peer->step(hand);
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    const Motion now = peer->motion();
    if (!now.X_WB.position.allFinite() || !now.X_WB.rotation.coeffs().allFinite()) break;  // it did not pass
    const auto& overlap = setting.round ? overlap_with_circle : overlap_with_polygon;
    trial.overlap = std::max(trial.overlap, overlap(now.X_WB, radius, task.chamfer));
    trial.force = std::max(trial.force, ((now.v - before) / kStep - pull).norm());
  }
  trial.passed = bottom_of(peer->motion().X_WB) < -kBlockHeight / 2;  // false for NaN
  trial.us = quantile(times, 0.5);
  trial.us99 = quantile(times, 0.99);
  return trial;
}

std::vector<const SettingResult*> best_of_each(const std::vector<SettingResult>& results) {
  const auto rank = [](const SettingResult& r) { return std::tuple(-r.passes(), r.worst(), r.median_us()); };
  std::vector<const SettingResult*> best;
  for (const SettingResult& r : results) {
    const auto same = std::find_if(best.begin(), best.end(), [&](const auto* b) { return b->engine == r.engine; });
    if (same == best.end())
      best.push_back(&r);
    else if (rank(r) < rank(**same))
      *same = &r;
  }
  return best;
}

std::vector<QueryResult> query_all(const std::vector<Setting>& settings) {
  constexpr double kSeen = 1e-5;  // m
  constexpr int kRounds = 3;
  const bench::PegPoses recorded = bench::load_peg_poses();
  if (recorded.X_AB.empty()) return {};
  const Insertion task{.clearance = kHoleRadius - bench::kPinRadius};
  std::vector<std::unique_ptr<Peer>> peers;
  std::vector<bench::PoseTimes> times(settings.size(), bench::PoseTimes(recorded.X_AB));
  for (const Setting& setting : settings) peers.push_back(setting.make(task, recorded.X_AB.front()));
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < peers.size(); ++i)
      times[i].round([&](const Pose& X) { peers[i]->place(X); }, [&](const Pose&) { peers[i]->query(); });
  std::vector<QueryResult> results;
  for (std::size_t i = 0; i < peers.size(); ++i) {
    QueryResult result{.engine = settings[i].engine, .text = settings[i].text};
    std::vector<double> errors;
    for (std::size_t k = 0; k < recorded.X_AB.size(); ++k) {
      peers[i]->place(recorded.X_AB[k]);
      const double found = peers[i]->query(), true_depth = recorded.depth[k];
      if (true_depth > kSeen && found > 0) errors.push_back(std::abs(found - true_depth));
      if (true_depth > kSeen && found <= 0) result.missed += 1.0 / static_cast<double>(recorded.X_AB.size());
      if (true_depth <= 0 && found > kSeen) result.imagined += 1.0 / static_cast<double>(recorded.X_AB.size());
    }
    if (!errors.empty()) {
      result.error = quantile(errors, 0.5);
      result.error95 = quantile(errors, 0.95);
    }
    result.us = times[i].percentile(0.5);
    result.us99 = times[i].percentile(0.99);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace verisim::peers

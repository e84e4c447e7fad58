#include "bench/peers/measures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <tuple>

#include "bench/peg_scene.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/quantile.hpp"
#include "engine/base/random.hpp"

namespace verisim::peers {
namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double bottom_of(const Pose& X) {
  return (X.position - 0.5 * kPinLength * (X.rotation * Vector3d::UnitZ())).z();
}

std::size_t settings_of(const std::vector<Engine>& engines, bool pushes) {
  std::size_t all = 0;
  for (const Engine& engine : engines) all += pushes ? engine.pushes.size() : engine.finds.size();
  return all;
}

}  // namespace

Trial run_trial(const PushSetting& setting, const Insertion& task) {
  constexpr int kRest = 100;  // steps
  const double radius = kHoleRadius - task.clearance;
  const Hand first = hand_at(task, 0);
  const std::unique_ptr<Pusher> pusher = setting.make(task, {first.position, first.rotation});
  const int steps = exact::test::steps_of(task);
  Trial trial{.task = task};
  std::vector<double> times;
  Vector3d at_rest = Vector3d::Zero();
  for (int i = 0; i < steps; ++i) {
    const Hand hand = hand_at(task, i * kStep);
    const Vector3d before = pusher->motion().v;
    const auto start = Clock::now();
    const Vector3d pull = pusher->step(hand);
    times.push_back(us_since(start));
    const Motion now = pusher->motion();
    if (!now.X_WB.position.allFinite() || !now.X_WB.rotation.coeffs().allFinite()) break;  // it did not pass
    const auto& overlap = setting.round ? overlap_with_circle : overlap_with_polygon;
    trial.overlap = std::max(trial.overlap, overlap(now.X_WB, radius, task.chamfer));
    const Vector3d force = (now.v - before) / kStep - pull;  // on 1 kg
    trial.force = std::max(trial.force, force.norm());
    if (i >= steps - kRest) at_rest += force / kRest;
  }
  trial.passed = bottom_of(pusher->motion().X_WB) < -kBlockHeight / 2;  // false for NaN
  trial.force_error = (at_rest - force_at_rest(task)).norm();
  trial.us = quantile(times, 0.5);
  trial.us99 = quantile(times, 0.99);
  return trial;
}

int Pushed::passes() const {
  return static_cast<int>(std::count_if(trials.begin(), trials.end(), [](const Trial& t) { return t.passed; }));
}

double Pushed::worst() const {
  if (passes() == 0) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (const Trial& t : trials)
    if (t.passed) worst = std::max(worst, t.overlap / t.task.clearance);
  return worst;
}

double Pushed::median_us() const {
  std::vector<double> times;
  for (const Trial& t : trials) times.push_back(t.us);
  return quantile(times, 0.5);
}

std::optional<double> Pushed::force_error() const {
  std::optional<double> worst;
  for (const Trial& t : trials)
    if (t.passed) worst = std::max(worst.value_or(0), t.force_error);
  return worst;
}

std::vector<std::vector<Pushed>> push_all(const std::vector<Engine>& engines, const std::vector<Insertion>& tasks,
                                          const Progress& say) {
  std::vector<std::vector<Pushed>> pushed;
  for (const Engine& engine : engines) {
    pushed.emplace_back();
    for (const PushSetting& setting : engine.pushes) pushed.back().push_back({setting.text, {}, {}});
  }
  const std::size_t all = settings_of(engines, true) * tasks.size();
  std::size_t done = 0;
  for (const Insertion& task : tasks)
    for (std::size_t e = 0; e < engines.size(); ++e)
      for (std::size_t i = 0; i < engines[e].pushes.size(); ++i) {
        say(fmt::format("insertion {} of {}: {}", ++done, all, engines[e].name));
        pushed[e][i].trials.push_back(run_trial(engines[e].pushes[i], task));
      }
  return pushed;
}

std::size_t best_of(const std::vector<Pushed>& settings) {
  const auto rank = [](const Pushed& p) { return std::tuple(-p.passes(), std::floor(10 * p.worst()), p.median_us()); };
  const auto best = std::min_element(settings.begin(), settings.end(),
                                     [&](const Pushed& a, const Pushed& b) { return rank(a) < rank(b); });
  return static_cast<std::size_t>(best - settings.begin());
}

void push_again(const std::vector<Engine>& engines, std::vector<std::vector<Pushed>>& pushed, int repeats,
                const Progress& say) {
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t e = 0; e < engines.size(); ++e) {
      if (pushed[e].empty()) continue;
      const std::size_t best = best_of(pushed[e]);
      say(fmt::format("best of each, {} of {}: {}", repeat + 1, repeats, engines[e].name));
      Pushed again;
      for (const Trial& t : pushed[e][best].trials) again.trials.push_back(run_trial(engines[e].pushes[best], t.task));
      pushed[e][best].more_us.push_back(again.median_us());
    }
}

namespace {

Poses drawn_poses() {
  constexpr std::uint64_t kCount = 1000;
  constexpr double kBeside = 0.0075, kTilt = 0.5 * pinned::kPi / 180;
  Poses poses;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const RandomStream draw(i, "pose of a pin in a hole");
    const double towards = 2 * pinned::kPi * draw.uniform(0), about = 2 * pinned::kPi * draw.uniform(1);
    const Quaterniond turned(Eigen::AngleAxisd(kTilt * draw.uniform(2), Vector3d(std::cos(about), std::sin(about), 0)));
    const double end = (draw.uniform(3) - 0.5) * 0.9 * kBlockHeight;  // z of the pin's lower end
    const double beside = kBeside * draw.uniform(4);
    const Vector3d lower(beside * std::cos(towards), beside * std::sin(towards), end);
    poses.X_AB.push_back({lower + turned * Vector3d(0, 0, kPinLength / 2), turned});
    poses.depth.push_back(depth_in_circle(poses.X_AB.back(), bench::kPinRadius, 0));
  }
  return poses;
}

}  // namespace

Poses poses_in_hole() {
  bench::PegPoses recorded = bench::load_peg_poses();
  const bool are_drawn = recorded.X_AB.empty();
  Poses poses = are_drawn ? drawn_poses() : Poses{std::move(recorded.X_AB), std::move(recorded.depth)};
  poses.are_drawn = are_drawn;
  poses.clearance = bench::kHoleRadius - bench::kPinRadius;
  return poses;
}

namespace {

constexpr double kSeen = 1e-5;  // m

void judge(Finder& finder, const Poses& poses, Found& found) {
  std::vector<double> depths, gaps;
  double clear = 0;
  const double share = 1.0 / static_cast<double>(poses.X_AB.size());
  for (std::size_t k = 0; k < poses.X_AB.size(); ++k) {
    finder.place(poses.X_AB[k]);
    const double told = finder.query(), truth = poses.depth[k];
    if (truth > kSeen && told > 0) depths.push_back(std::abs(told - truth));
    if (truth > kSeen && told <= 0) found.missed += share;
    if (truth <= 0 && told > kSeen) found.imagined += share;
    clear += truth <= 0 ? 1 : 0;
    if (truth <= 0 && told > kNothing) gaps.push_back(std::abs(told - truth));
  }
  if (!depths.empty()) {
    found.error = quantile(depths, 0.5);
    found.error95 = quantile(depths, 0.95);
  }
  if (!gaps.empty()) {
    found.gap_seen = static_cast<double>(gaps.size()) / clear;
    found.gap_error95 = quantile(gaps, 0.95);
  }
}

}  // namespace

std::vector<std::vector<Found>> find_all(const std::vector<Engine>& engines, const Poses& poses, int rounds,
                                         const Progress& say) {
  std::vector<std::vector<Found>> found;
  std::vector<std::vector<std::unique_ptr<Finder>>> finders;
  std::vector<std::vector<std::vector<double>>> times;  // engine, setting: of all poses and rounds
  for (const Engine& engine : engines) {
    found.emplace_back();
    finders.emplace_back();
    for (const FindSetting& setting : engine.finds) {
      found.back().push_back({.text = setting.text, .us = {}});
      finders.back().push_back(setting.make(poses.clearance));
    }
    times.emplace_back(engine.finds.size());
  }
  for (int round = 0; round < rounds; ++round)
    for (std::size_t e = 0; e < engines.size(); ++e) {
      say(fmt::format("queries, round {} of {}: {}", round + 1, rounds, engines[e].name));
      for (std::size_t i = 0; i < finders[e].size(); ++i) {
        std::vector<double> of_round;
        for (const Pose& X : poses.X_AB) {
          finders[e][i]->place(X);
          const auto start = Clock::now();
          (void)finders[e][i]->query();
          of_round.push_back(us_since(start));
        }
        found[e][i].us.push_back(quantile(of_round, 0.5));
        times[e][i].insert(times[e][i].end(), of_round.begin(), of_round.end());
      }
    }
  for (std::size_t e = 0; e < engines.size(); ++e)
    for (std::size_t i = 0; i < finders[e].size(); ++i) {
      found[e][i].us99 = quantile(times[e][i], 0.99);
      judge(*finders[e][i], poses, found[e][i]);
    }
  return found;
}

std::size_t best_of(const std::vector<Found>& settings) {
  const auto rank = [](const Found& f) {
    return std::tuple(std::round(1000 * (f.missed + f.imagined)), std::floor(f.error95 / kSeen), f.time().median);
  };
  const auto best = std::min_element(settings.begin(), settings.end(),
                                     [&](const Found& a, const Found& b) { return rank(a) < rank(b); });
  return static_cast<std::size_t>(best - settings.begin());
}

}  // namespace verisim::peers

#include "engine/cli/tradeoff_runs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "engine/base/archive.hpp"
#include "engine/base/error.hpp"
#include "engine/base/quantile.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/measure.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/run_loop.hpp"
#include "engine/session/session.hpp"
#include "engine/simulation/frame_cost.hpp"

namespace verisim {

// How what a worker found becomes bytes (base/archive.hpp).
static void fields(auto& archive, Pose& X) {
  archive(X.position, X.rotation.coeffs());
}
static void fields(auto& archive, HapticSamples& track) {
  archive(track.t, track.pose, track.button);
}

}  // namespace verisim

namespace verisim::tradeoff {

static void fields(auto& archive, BodyMotion& body) {
  archive(body.name, body.wrench, body.end);
}
static void fields(auto& archive, Motion& motion) {
  archive(motion.bodies, motion.overlap, motion.overlap_bound, motion.work);
}

}  // namespace verisim::tradeoff

namespace verisim::cli {

static void fields(auto& archive, Trial& trial) {
  archive(trial.outcome, trial.simulated_s, trial.frames, trial.frame_us, trial.contact_us, trial.mean_us, trial.cost,
          trial.tracks);
}

namespace {

using tradeoff::Motion;
using tradeoff::WindowMeans;

constexpr double kTrackPeriod = 0.001;  // s; between its samples a track is interpolated, as every trace is

Session open_setting(const TrialSetting& setting, const std::function<void(Scene&)>& look) {
  const ScenarioOptions& scenario = setting.scenario;
  auto inputs = std::make_unique<Inputs>(
      Inputs::live(std::filesystem::path(scenario.path).parent_path().string(), named_paths(scenario), setting.store));
  return open_session(scenario, std::move(inputs), setting.threads, true, look);
}

/// Error unless it came to its end.
void check_end(const LoopResult& loop) {
  if (loop.end == LoopEnd::done) return;
  if (loop.end == LoopEnd::interrupted) fail(ErrorKind::interrupted, "interrupted");
  fail(loop.end == LoopEnd::diverged ? ErrorKind::diverged : ErrorKind::input, "{}", loop.error);
}

double median_us(std::vector<std::uint32_t>& ns) {
  return ns.empty() ? 0 : static_cast<double>(quantile(ns, 0.5)) / 1000;
}

/// Samples at kTrackPeriod, or at every frame where these are further apart.
class Tracker {
 public:
  explicit Tracker(std::vector<std::shared_ptr<Device>> devices)
      : devices_(std::move(devices)), tracks_(devices_.size()) {}
  void look(double t) {
    if (t < next_ - 1e-9) return;
    next_ = std::max(next_ + kTrackPeriod, t);
    for (std::size_t d = 0; d < devices_.size(); ++d) {
      const DeviceReading& reading = devices_[d]->reading();
      tracks_[d].t.push_back(t);
      tracks_[d].pose.push_back(reading.handle);
      tracks_[d].button.push_back(reading.button ? 1 : 0);
    }
  }
  [[nodiscard]] HandleTracks tracks() && { return std::move(tracks_); }

 private:
  std::vector<std::shared_ptr<Device>> devices_;
  HandleTracks tracks_;
  double next_ = 0;
};

/// The deepest true overlap of the pairs that have met, over the poses that it is shown.
class DeepestOverlap {
 public:
  explicit DeepestOverlap(std::vector<MeasuredBody> bodies) : bodies_(std::move(bodies)) {}
  void look(const Simulation& simulation) {
    for (const BodyPair& pair : simulation.pairs()) look(simulation, pair.first, pair.second);
  }
  [[nodiscard]] double depth() const { return depth_; }
  [[nodiscard]] double bound() const { return bound_; }

 private:
  struct Last {
    bool can_be_measured = true;
    bool is_known = false;
    Pose X_AB;
    ruler::Overlap overlap;
  };
  void look(const Simulation& simulation, std::size_t a, std::size_t b) {
    const ruler::Shape& first = bodies_[a].shape;
    const ruler::Shape& second = bodies_[b].shape;
    const auto [found, is_new] = last_.try_emplace({a, b});
    Last& last = found->second;
    if (is_new) last.can_be_measured = ruler::why_not(first, second).empty();
    if (!last.can_be_measured) return;
    const Pose X_WA = simulation.body_pose(a), X_WB = simulation.body_pose(b), X_AB = X_WA.inverse() * X_WB;
    // What was found last says that it cannot be deeper now than it has been: the usual case once it has been deep.
    if (last.is_known &&
        last.overlap.depth + last.overlap.bound + ruler::largest_move(second, last.X_AB, X_AB) <= depth_)
      return;
    last.is_known = true;
    last.X_AB = X_AB;
    last.overlap = ruler::overlap(second, X_WB, first, X_WA, {.absolute = 1e-6, .relative = 0.02, .pieces_max = 1500});
    depth_ = std::max(depth_, last.overlap.depth);
    bound_ = std::max(bound_, last.overlap.depth + last.overlap.bound - depth_);
  }

  std::vector<MeasuredBody> bodies_;
  std::map<std::pair<std::size_t, std::size_t>, Last> last_;
  double depth_ = 0, bound_ = 0;
};

/// What is looked at after each frame of a driven motion.
class MotionWatch {
 public:
  MotionWatch(const Scene& scene) : overlap_(measured_bodies(scene)) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      if (!scene.bodies[b].fixed) moving_.push_back(b);
    for (const std::size_t b : moving_) names_.push_back(scene.bodies[b].name);
    means_.resize(moving_.size());
  }
  void look(const Simulation& simulation) {
    const double end = simulation.time(), begin = end - simulation.dt();
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      const Wrench wrench = simulation.body_force(moving_[i]);
      Vector6d both;
      both << wrench.force, wrench.torque;
      means_[i].add(std::max(0.0, begin), end, both);
    }
    given_most_ = std::max(given_most_, simulation.energy().contact);
    work_ = std::max(work_, given_most_ - simulation.energy().contact);
    if (end < next_overlap_ - 1e-9) return;
    constexpr double kOverlapPeriod = 0.005;  // s
    next_overlap_ += kOverlapPeriod;
    overlap_.look(simulation);
  }
  [[nodiscard]] Motion motion(const Simulation& simulation) const {
    Motion motion;
    for (std::size_t i = 0; i < moving_.size(); ++i)
      motion.bodies.push_back({names_[i], means_[i].means(), simulation.body_pose(moving_[i])});
    motion.overlap = overlap_.depth();
    motion.overlap_bound = overlap_.bound();
    motion.work = work_;
    return motion;
  }

 private:
  DeepestOverlap overlap_;
  std::vector<std::size_t> moving_;
  std::vector<std::string> names_;
  std::vector<WindowMeans> means_;
  double given_most_ = 0, work_ = 0, next_overlap_ = 0;
};

}  // namespace

Trial run_trial(const TrialSetting& setting, bool with_tracks) {
  std::vector<std::shared_ptr<Device>> devices;
  const Session session = open_setting(setting, [&](const Scene& scene) { devices = scene.devices; });
  Simulation& simulation = *session.simulation;
  FrameCost cost;
  Tracker tracker(devices);
  const InterruptScope until_the_loop_ends;
  LoopOptions options;
  options.frames = simulation.frames_planned();
  options.finished = [&] {
    for (const CostCounter& counter : kCostCounters) cost.*counter.count += simulation.cost().*counter.count;
    if (with_tracks) tracker.look(std::max(0.0, simulation.time() - simulation.dt()));
    return session.scenario->finished();
  };
  LoopResult loop = run_loop(simulation, nullptr, options);
  check_end(loop);
  Trial trial;
  trial.outcome = session.scenario->outcome();
  trial.simulated_s = simulation.time();
  trial.frames = simulation.frame();
  for (const std::uint32_t ns : loop.frame_ns) trial.mean_us += static_cast<double>(ns) / 1000;
  trial.mean_us /= static_cast<double>(std::max<std::size_t>(1, loop.frame_ns.size()));
  trial.frame_us = median_us(loop.frame_ns);
  trial.contact_us = median_us(loop.collision_frame_ns);
  for (const CostCounter& counter : kCostCounters) trial.cost.push_back(cost.*counter.count);
  trial.tracks = std::move(tracker).tracks();
  return trial;
}

Motion run_driven(const TrialSetting& setting, const HandleTracks& tracks, double simulated_s) {
  std::unique_ptr<MotionWatch> watch;
  const Session session = open_setting(setting, [&](Scene& scene) {
    if (scene.devices.size() != tracks.size())
      fail(ErrorKind::input, "the setting has {} devices and the truth {}: they are not the same trial",
           scene.devices.size(), tracks.size());
    for (std::size_t d = 0; d < tracks.size(); ++d) scene.devices[d] = make_replay(scene.devices[d]->name(), tracks[d]);
    watch = std::make_unique<MotionWatch>(scene);
  });
  Simulation& simulation = *session.simulation;
  const auto frames = static_cast<std::uint64_t>(std::max(1.0, std::round(simulated_s / simulation.dt())));
  const InterruptScope until_the_loop_ends;
  LoopOptions options;
  options.frames = frames;
  options.finished = [&] {
    watch->look(simulation);
    return false;
  };
  const LoopResult loop = run_loop(simulation, nullptr, options);
  check_end(loop);
  return watch->motion(simulation);
}

std::string bytes_of(const Trial& trial) {
  ArchiveWriter archive;
  archive(trial);
  return std::move(archive.bytes);
}

Trial trial_from(const std::string& bytes) {
  ArchiveReader archive(bytes);
  Trial trial;
  archive(trial);
  return trial;
}

std::string bytes_of(const Motion& motion) {
  ArchiveWriter archive;
  archive(motion);
  return std::move(archive.bytes);
}

Motion motion_from(const std::string& bytes) {
  ArchiveReader archive(bytes);
  Motion motion;
  archive(motion);
  return motion;
}

}  // namespace verisim::cli

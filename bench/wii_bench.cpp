// ns per update of every tracker, over natural head motion as a noisy virtual remote sees it. Beside the time: the rms
// error against the truth, so that a faster tracker that is worse is seen; the answer is checked to be the
// validation's.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/promise.hpp"
#include "engine/wii/trajectories.hpp"

namespace verisim::wii {
namespace {

std::size_t report_count() {
  return bench::smoke() ? 100 : 2000;
}

TrackerSettings settings_of(const std::string& name) {
  TrackerSettings settings;
  settings.leds = find_tracker(name).leds;
  settings.X_R1R2 = Pose{{0.5, 0, 0}, rotation_from_vector({0, -0.4, 0})};
  return settings;
}

struct Run {
  std::vector<SensedReport> first;
  std::vector<SensedReport> second;
};
Run sense(const TrackerSettings& settings) {
  RemoteSettings remote_settings;
  remote_settings.pixel_noise = 0.3;
  remote_settings.leds.clear();
  for (int i = 0; i < settings.leds.count; ++i)
    remote_settings.leds.push_back(Led{settings.leds.p_H[static_cast<std::size_t>(i)]});
  VirtualRemote first(remote_settings, 1, "first");
  VirtualRemote second(remote_settings, 1, "second");
  Run run;
  for (std::uint64_t k = 0; k < report_count(); ++k) {
    Situation s = trajectory("natural").at(first.report_time(k));
    run.first.push_back(first.sense(k, s));
    s.X_WR = s.X_WR * settings.X_R1R2.value();
    run.second.push_back(second.sense(k, s));
  }
  return run;
}

void BM_Update(benchmark::State& state, const std::string& name) {
  const TrackerSettings settings = settings_of(name);
  const Run run = sense(settings);
  const bool two_remotes = find_tracker(name).remotes == 2;
  double square = 0;
  int valid = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::unique_ptr<Tracker> tracker = make_tracker(name, settings);
    square = 0;
    valid = 0;
    state.ResumeTiming();
    for (std::size_t k = 0; k < run.first.size(); ++k) {
      if (two_remotes) (void)tracker->update(run.second[k].t, run.second[k].channels, 1);
      const Report& report = tracker->update(run.first[k].t, run.first[k].channels);
      if (!report.valid) continue;
      ++valid;
      square += (report.pose.position - run.first[k].X_LH.position).squaredNorm();
    }
  }
  const double rms = std::sqrt(square / std::max(valid, 1));
  if (valid < 0.99 * static_cast<double>(run.first.size())) bench::wrong(state, "the head was lost");
  if (name != "vrpn-compatible" && rms > 0.01) bench::wrong(state, "the tracker is off by more than a centimetre");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(run.first.size()));
  state.counters["per_update"] =
      benchmark::Counter(static_cast<double>(run.first.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["rms_cm"] = 100 * rms;
}
BENCHMARK_CAPTURE(BM_Update, geometric, std::string("geometric"));
BENCHMARK_CAPTURE(BM_Update, vrpn_compatible, std::string("vrpn-compatible"));
BENCHMARK_CAPTURE(BM_Update, three_led, std::string("three-led"));
BENCHMARK_CAPTURE(BM_Update, scaat, std::string("scaat"));
BENCHMARK_CAPTURE(BM_Update, stereo, std::string("stereo"));

/// The virtual remote itself, every imperfection on.
void BM_Sense(benchmark::State& state) {
  RemoteSettings settings;
  settings.pixel_noise = 0.3;
  settings.subpixel_error = 0.1;
  settings.half_power_angle = 30 * kDegree;
  settings.accelerometer_bits = 10;
  settings.accelerometer_noise = 0.01;
  VirtualRemote remote(settings, 1, "remote");
  const Situation situation = trajectory("natural").at(0);
  std::uint64_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(remote.sense(k++, situation));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_Sense);

}  // namespace
}  // namespace verisim::wii

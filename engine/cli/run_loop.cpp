#include "engine/cli/run_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <thread>

#include "engine/base/error.hpp"

namespace verisim::cli {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupted = 0;

void on_interrupt(int signal) {
  if (interrupted != 0) {  // asked twice: do not wait for the frame
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  interrupted = 1;
}

std::uint32_t clamped_ns(Clock::duration d) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(d).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(ns, 0, 0xffffffffLL));
}

/// What /timing holds of one frame, in the order of its columns.
struct Timing {
  std::uint32_t frame_ns;
  std::array<std::uint32_t, kStageNames.size()> stage_ns;
  std::uint32_t period_ns;
  std::uint8_t overrun;

  void write(std::byte* at) const {
    const auto put = [&](const auto& value) {
      std::memcpy(at, &value, sizeof value);
      at += sizeof value;
    };
    put(frame_ns);
    put(stage_ns);
    put(period_ns);
    put(overrun);
  }
};

std::size_t timing_offset(const Schema& schema) {
  for (const Column& column : schema.columns())
    if (column.path == "/timing/frame_ns") return column.offset;
  VERISIM_ASSERT(!"the schema has timing columns");
  return 0;
}

void record(Simulation& simulation, Recorder& recorder, std::size_t offset, const Timing& timing) {
  const std::span<std::byte> row = recorder.begin_row();
  simulation.write_row(row.data());
  timing.write(row.data() + offset);
  recorder.end_row();
  for (const Event& event : simulation.events()) recorder.event(event.time, event.kind, event.text);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool was_interrupted() {
  return interrupted != 0;
}

void add_timing_columns(Schema& schema) {
  std::string stages;
  for (const char* name : kStageNames) stages += (stages.empty() ? "" : ", ") + std::string(name);
  schema.add({"/timing/frame_ns", Dtype::u32, 1, "ns", "wall clock of computing the frame", 0, {}});
  schema.add({"/timing/stage_ns", Dtype::u32, kStageNames.size(), "ns", "wall clock of its stages: " + stages, 0, {}});
  schema.add({"/timing/period_ns", Dtype::u32, 1, "ns", "start of the frame before to the start of this one", 0, {}});
  schema.add(
      {"/timing/overrun", Dtype::u8, 1, "1", "1: period over 1.5 dt (free-running: compute time over 1.5 dt)", 0, {}});
}

LoopResult run_loop(Simulation& simulation, Recorder* recorder, const Schema& schema, const LoopOptions& options) {
  LoopResult result;
  result.frame_ns.reserve(options.frames);
  result.collision_frame_ns.reserve(options.frames);
  const std::size_t offset = recorder != nullptr ? timing_offset(schema) : 0;
  const auto dt = std::chrono::nanoseconds(std::llround(simulation.dt() * 1e9));
  const auto limit = dt + dt / 2;
  const Clock::time_point start = Clock::now();
  Clock::time_point last_start = start - dt;
  Clock::time_point last_progress = start;
  try {
    for (std::uint64_t i = 0; i < options.frames && interrupted == 0; ++i) {
      if (options.paced) std::this_thread::sleep_until(start + dt * static_cast<std::int64_t>(i));
      const Clock::time_point begin = Clock::now();
      simulation.step();
      const Clock::time_point end = Clock::now();
      const Timing timing{clamped_ns(end - begin), simulation.stage_ns(), clamped_ns(begin - last_start),
                          static_cast<std::uint8_t>((options.paced ? begin - last_start : end - begin) > limit)};
      last_start = begin;
      result.overruns += timing.overrun;
      result.frame_ns.push_back(timing.frame_ns);
      if (simulation.cost().contacts > 0) result.collision_frame_ns.push_back(timing.frame_ns);
      if (recorder != nullptr) record(simulation, *recorder, offset, timing);
      simulation.clear_events();
      if (options.progress && end - last_progress > std::chrono::milliseconds(200)) {
        options.progress(i + 1);
        last_progress = end;
      }
      if (options.finished && options.finished()) break;
    }
    if (interrupted != 0) result.end = LoopEnd::interrupted;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::diverged && error.kind() != ErrorKind::io) throw;
    result.end = error.kind() == ErrorKind::diverged ? LoopEnd::diverged : LoopEnd::io_failed;
    result.error = error.what();
  }
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

std::uint32_t quantile(std::vector<std::uint32_t>& times, double p) {
  if (times.empty()) return 0;
  const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(times.size())));
  const std::size_t index = std::min(times.size() - 1, rank == 0 ? 0 : rank - 1);
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(index), times.end());
  return times[index];
}

}  // namespace verisim::cli

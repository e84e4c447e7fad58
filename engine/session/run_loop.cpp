#include "engine/session/run_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "engine/base/error.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/warnings.hpp"

namespace verisim {
namespace {

using Clock = std::chrono::steady_clock;

std::uint32_t clamped_ns(Clock::duration d) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(d).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(ns, 0, 0xffffffffLL));
}

/// The wall clock of one frame.
struct Timing {
  std::uint32_t frame_ns = 0;
  StageTimes stage_ns{};
  std::uint32_t period_ns = 0;
  bool overrun = false;
};

Columns declare(const Timing& timing) {
  Columns columns;
  std::string stages;
  for (const char* name : kStageNames) stages += (stages.empty() ? "" : ", ") + std::string(name);
  columns.add("/timing/frame_ns", "ns", "wall clock of computing the frame", [&timing] { return timing.frame_ns; });
  columns.add("/timing/stage_ns", "ns", "wall clock of its stages: " + stages, [&timing] { return timing.stage_ns; });
  columns.add("/timing/period_ns", "ns", "start of the frame before to the start of this one",
              [&timing] { return timing.period_ns; });
  columns.add("/timing/overrun", "1", "1: period over 1.5 dt (free-running: compute time over 1.5 dt)",
              [&timing] { return timing.overrun; });
  return columns;
}

/// Hands rows over to the recorder: the simulation's, then the wall clock.
class RowSink {
 public:
  RowSink(const Simulation& simulation, Recorder* recorder, const Timing& timing)
      : simulation_(simulation), recorder_(recorder), timing_(declare(timing)) {
    Schema schema;
    simulation.describe(schema);
    row_bytes_ = schema.row_bytes() + timing_.other_bytes();
  }
  /// Between frames, after Simulation::prepare().
  void prepare() {
    if (recorder_ == nullptr) return;
    const std::vector<BodyPair>& pairs = simulation_.pairs();
    if (pairs_ == pairs.size()) return;
    recorder_->make_room(pairs.size());
    for (; pairs_ < pairs.size(); ++pairs_) recorder_->pair(pairs[pairs_]);
  }
  void take() {
    if (recorder_ == nullptr) return;
    const std::span<std::byte> row = recorder_->begin_row(simulation_.awake());
    VERISIM_ASSERT(row.size() == row_bytes_);
    simulation_.write_awake(row.data());
    timing_.put_other(row.data() + row.size() - timing_.other_bytes());
    recorder_->add_table_rows(simulation_.table_rows());
    recorder_->end_row();
    for (const Event& event : simulation_.events()) recorder_->event(event.time, event.kind, event.text);
  }
  void finish() {
    if (recorder_ == nullptr) return;
    for (const Event& event : simulation_.last_events()) recorder_->event(event.time, event.kind, event.text);
  }

 private:
  const Simulation& simulation_;
  Recorder* recorder_;
  Columns timing_;
  std::size_t pairs_ = 0;  ///< handed over so far
  std::size_t row_bytes_ = 0;
};

/// The wall clock's schedule: when each frame starts if the loop is paced, and which periods were too long.
class Pace {
 public:
  Pace(double dt, bool paced)
      : dt_(std::llround(dt * 1e9)), paced_(paced), next_(Clock::now()), last_start_(next_ - dt_) {}

  /// Waits for the next frame's time if paced. Returns when it starts; `period()` is the time since the one before.
  Clock::time_point wait() {
    if (paced_) std::this_thread::sleep_until(next_);
    next_ += dt_;
    const Clock::time_point begin = Clock::now();
    period_ = begin - last_start_;
    last_start_ = begin;
    return begin;
  }
  [[nodiscard]] Clock::duration period() const { return period_; }
  [[nodiscard]] bool too_long(Clock::duration time) const { return time > dt_ + dt_ / 2; }

 private:
  std::chrono::nanoseconds dt_;
  bool paced_;
  Clock::time_point next_, last_start_;
  Clock::duration period_{};
};

/// Counts overruns block by block, and runs an empty block after each.
class Blocks {
 public:
  Blocks(const LoopOptions& options, LoopResult& result)
      : frames_(options.paced ? options.empty_block : 0), result_(result) {
    if (frames_ == 0) return;
    result.block_overruns.reserve(options.frames / frames_);
    result.empty_block_overruns.reserve(options.frames / frames_);
  }
  void after_frame(std::uint64_t frames_done, Pace& pace) {
    if (frames_ == 0 || frames_done % frames_ != 0) return;
    result_.block_overruns.push_back(static_cast<std::uint32_t>(result_.overruns - counted_));
    counted_ = result_.overruns;
    std::uint32_t empty = 0;
    for (std::uint64_t i = 0; i < frames_ && !was_interrupted(); ++i) {
      pace.wait();
      empty += pace.too_long(pace.period()) ? 1 : 0;
    }
    result_.empty_block_overruns.push_back(empty);
  }

 private:
  std::uint64_t frames_, counted_ = 0;
  LoopResult& result_;
};

}  // namespace

void add_timing_columns(Schema& schema) {
  const Timing none;
  const Columns columns = declare(none);
  for (const Column& column : columns.other()) schema.add(column);
}

LoopResult run_loop(Simulation& simulation, Recorder* recorder, const LoopOptions& options) {
  LoopResult result;
  result.frame_ns.reserve(options.frames);
  result.collision_frame_ns.reserve(options.frames);
  Timing timing;
  RowSink rows(simulation, recorder, timing);
  Blocks blocks(options, result);
  const Clock::time_point start = Clock::now();
  Clock::time_point last_progress = start;
  Pace pace(simulation.dt(), options.paced);
  const std::size_t said = simulation.events().size();  // when it was loaded
  try {
    for (std::uint64_t i = 0; i < options.frames && !was_interrupted(); ++i) {
      simulation.prepare();
      rows.prepare();
      const Clock::time_point begin = pace.wait();
      simulation.step();
      const Clock::time_point end = Clock::now();
      timing = {clamped_ns(end - begin), simulation.stage_ns(), clamped_ns(pace.period()),
                pace.too_long(options.paced ? pace.period() : end - begin)};
      result.overruns += timing.overrun ? 1 : 0;
      result.frame_ns.push_back(timing.frame_ns);
      if (simulation.cost().contacts > 0) result.collision_frame_ns.push_back(timing.frame_ns);
      rows.take();
      const std::vector<Event>& events = simulation.events();
      for (std::size_t e = i == 0 ? said : 0; e < events.size(); ++e) {
        if (is_warning(events[e])) result.warnings.push_back(events[e].text);
        if (is_any_warning(events[e]) && result.warning_count++ == 0) result.first_warning = events[e].text;
      }
      simulation.clear_events();
      if (options.progress && end - last_progress > std::chrono::milliseconds(200)) {
        options.progress(i + 1);
        last_progress = end;
      }
      if (options.finished && options.finished()) break;
      blocks.after_frame(i + 1, pace);
    }
    if (was_interrupted()) result.end = LoopEnd::interrupted;
  } catch (const Error& error) {
    switch (error.kind()) {
      case ErrorKind::diverged:
        result.end = LoopEnd::diverged;
        break;
      case ErrorKind::io:
        result.end = LoopEnd::io_failed;
        break;
      case ErrorKind::input:
        result.end = LoopEnd::refused;
        break;
      default:
        throw;
    }
    result.error = error.what();
  }
  if (result.end != LoopEnd::io_failed) rows.finish();
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace verisim

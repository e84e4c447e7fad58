// The loop around a simulation: steps, times, records, paces, stops.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/record/run_file.hpp"
#include "engine/simulation/simulation.hpp"

namespace verisim {

struct LoopOptions {
  std::uint64_t frames = 0;
  bool paced = false;                           ///< wait for the wall clock before each frame
  std::uint64_t empty_block = 0;                ///< paced, > 0: after each block of so many frames an empty loop of as
                                                ///< many periods runs, to measure the jitter of the machine alone
  std::function<bool()> finished;               ///< asked after every frame: the scenario may end early
  std::function<void(std::uint64_t)> progress;  ///< receives the frames done, about five times a second; may be empty
};

enum class LoopEnd { done, interrupted, diverged, io_failed, refused };  ///< refused: a body that came near

struct LoopResult {
  LoopEnd end = LoopEnd::done;
  std::string error;                  ///< for diverged, io_failed and refused
  std::vector<std::string> warnings;  ///< events of the run that are warnings (warnings.hpp)
  std::uint64_t warning_count = 0;    ///< of any kind (is_any_warning)
  std::string first_warning;          ///< of these
  std::uint64_t overruns = 0;
  std::vector<std::uint32_t> block_overruns;        ///< of each whole block of frames, if empty blocks are measured
  std::vector<std::uint32_t> empty_block_overruns;  ///< of the empty block after each
  std::vector<std::uint32_t> frame_ns;              ///< of every frame
  std::vector<std::uint32_t> collision_frame_ns;    ///< of the frames with contact
  bool realtime_priority = false;                   ///< whether the thread had it
  double wall_s = 0;                                ///< first frame to the last row handed over
};

/// Adds the /timing columns behind the simulation's own.
void add_timing_columns(Schema& schema);

/// What a run of the simulation ends with is recorded too: Simulation::last_events.
/// Runs until `frames` are done, the scenario has finished, a signal (interrupts.hpp), divergence, or the recorder
/// failed. `recorder` may be null. The loop itself allocates nothing.
/// @pre the recorder's schema is the simulation's, then the timing columns
[[nodiscard]] LoopResult run_loop(Simulation& simulation, Recorder* recorder, const LoopOptions& options);

}  // namespace verisim

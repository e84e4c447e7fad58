#include "engine/cli/recorded_run.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/cli/realtime_priority.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

std::function<void(std::uint64_t)> progress_bar(std::uint64_t frames, bool wanted) {
  if (!wanted || isatty(STDERR_FILENO) == 0) return {};
  return [frames](std::uint64_t done) {
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(kWidth * done / frames);
    std::fprintf(stderr, "\r  [%-*s] %3d %%", kWidth, std::string(static_cast<std::size_t>(filled), '=').c_str(),
                 static_cast<int>(100 * done / frames));
    std::fflush(stderr);
  };
}

}  // namespace

void make_folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) fail(ErrorKind::io, "{}: the folder cannot be made ({}); choose another with -o", file, error.message());
}

RecordedRun record_run(Session& session, const RecordOptions& options) {
  Simulation& simulation = *session.simulation;
  make_folder_of(options.file);
  Schema schema;
  simulation.describe(schema);
  add_timing_columns(schema);
  RecorderOptions recording;
  recording.paced = options.paced;
  recording.frames_unflushed = static_cast<std::size_t>(std::max(1.0, 0.1 / simulation.dt()));
  Recorder recorder(options.file, schema, header_of(session, options.embed), recording);

  catch_interrupts();
  LoopOptions loop;
  loop.frames = simulation.frames_planned();
  loop.paced = options.paced;
  loop.empty_block = options.empty_block;
  loop.finished = [&] { return session.scenario->finished(); };
  loop.progress = progress_bar(loop.frames, options.progress);
  RecordedRun run;
  {
    const RealtimePriority priority(options.paced);  // the recorder's thread has started without it
    if (options.paced && options.progress && !priority.granted())
      std::fputs(
          "note: the system grants no real-time priority (CAP_SYS_NICE, or `ulimit -r 1`): other work can make "
          "periods too long\n",
          stderr);
    run.loop = run_loop(simulation, &recorder, loop);
    run.loop.realtime_priority = priority.granted();
  }
  if (loop.progress) std::fprintf(stderr, "\r%60s\r", "");
  run.figures = figures_of(session, run.loop, options.file);
  if (run.loop.end != LoopEnd::io_failed)
    recorder.close(to_attributes(run.figures), {{"state_hash", run.figures.state_hash}});
  return run;
}

int exit_code_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::done:
      return 0;
    case LoopEnd::interrupted:
      return static_cast<int>(ErrorKind::interrupted);
    case LoopEnd::diverged:
      return static_cast<int>(ErrorKind::diverged);
    case LoopEnd::io_failed:
      return static_cast<int>(ErrorKind::io);
  }
  return 0;
}

}  // namespace verisim::cli

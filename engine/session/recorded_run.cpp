#include "engine/session/recorded_run.hpp"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/output_place.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/memory_use.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/session/realtime_priority.hpp"
#include "engine/session/warnings.hpp"

namespace verisim {
namespace {

namespace fs = std::filesystem;

std::function<void(std::uint64_t)> progress_bar(std::uint64_t frames, const ProgressLine& line) {
  if (!line.is_shown()) return {};
  return [frames, &line](std::uint64_t done) {
    constexpr std::uint64_t kWidth = 40;
    line.say(fmt::format("  [{:{}}] {:3} %", std::string(kWidth * done / frames, '='), kWidth, 100 * done / frames));
  };
}

/// Error(io) if the rows of all planned frames are more than the disk of `file` has room for.
void check_room(const std::string& file, const Session& session, std::size_t row_bytes) {
  const std::uint64_t frames = session.simulation->frames_planned();
  std::error_code error;
  const fs::path folder = fs::path(file).parent_path();
  const fs::space_info space = fs::space(folder.empty() ? fs::path(".") : folder, error);
  const double wanted = static_cast<double>(frames) * static_cast<double>(row_bytes);
  if (error || space.capacity == 0 || wanted <= static_cast<double>(space.available)) return;
  fail(ErrorKind::io,
       "{}: a duration of {} s is {} frames of {} bytes, {:.1f} GB, and {:.1f} GB are free; shorten it with --duration",
       file, static_cast<double>(frames) * session.simulation->dt(), frames, row_bytes, wanted / 1e9,
       static_cast<double>(space.available) / 1e9);
}

/// "runs/pin.h5", "runs/pin-2.h5", "runs/pin-3.h5" …
std::string nth_name(const std::string& file, int n) {
  const fs::path path(file);
  if (n == 1) return file;
  return (path.parent_path() / (path.stem().string() + fmt::format("-{}", n) + path.extension().string())).string();
}

struct OpenRecorder {
  std::string file;
  std::unique_ptr<Recorder> recorder;
};

/// A recorder with a file of its own: to create it is what settles which of several runs has a name.
OpenRecorder open_recorder(const Session& session, const RecordOptions& options, const Schema& schema) {
  RecorderOptions recording;
  recording.paced = options.paced;
  recording.frames_planned = session.simulation->frames_planned();
  recording.frames_unflushed = static_cast<std::size_t>(std::max(1.0, 0.1 / session.simulation->dt()));
  for (int n = 1;; ++n) {
    const std::string name = nth_name(options.file, n);
    try {
      const std::string file = check_output({name, OutputKind::run, options.force, {}}, session.inputs->opened());
      check_room(file, session, schema.row_bytes() - schema.rest_bytes());
      return {name, std::make_unique<Recorder>(file, schema, header_of(session, options.embed), recording)};
    } catch (const BeingWritten&) {
      if (!options.another_name) throw;
    }
  }
}

}  // namespace

void make_folder_of(const std::string& file, const std::string& named) {
  const fs::path folder = fs::path(file).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error)
    fail(ErrorKind::io, "{}: the folder cannot be made ({}); choose another with -o", named.empty() ? file : named,
         error.message());
}

RecordedRun record_run(Session& session, const RecordOptions& options) {
  VERISIM_ASSERT(session.simulation != nullptr);
  Simulation& simulation = *session.simulation;
  if (!options.file.empty()) make_folder_of(options.file);
  Schema schema;
  simulation.describe(schema);
  add_timing_columns(schema);
  const MemoryUse use(fmt::format("recording {} frames of {} bytes", simulation.frames_planned(), schema.row_bytes()));
  const InterruptScope until_the_file_is_closed;
  const auto [file, recorder] = options.file.empty() ? OpenRecorder{} : open_recorder(session, options, schema);

  if (options.paced) {
    const std::size_t rows = simulation.prepare_all();
    if (recorder) recorder->make_room(rows);
  }
  LoopOptions loop;
  loop.frames = simulation.frames_planned();
  loop.paced = options.paced;
  loop.empty_block = options.empty_block;
  std::exception_ptr thrown;
  loop.finished = [&] {
    try {
      const bool goes_on = !options.after_frame || options.after_frame();
      return !goes_on || session.scenario->finished();
    } catch (const Error&) {  // the loop's to judge
      throw;
    } catch (...) {  // the file is closed as one that was interrupted; then it is thrown on
      thrown = std::current_exception();
      return true;
    }
  };
  RecordedRun run;
  {
    const ProgressLine line(options.progress);
    loop.progress = progress_bar(loop.frames, line);
    const RealtimePriority priority(options.paced);  // the recorder's thread has started without it
    if (options.paced && options.progress && !priority.granted())
      std::fputs(
          "note: the system grants no real-time priority (CAP_SYS_NICE, or `ulimit -r 1`): other work can make "
          "periods too long\n",
          stderr);
    run.loop = run_loop(simulation, recorder.get(), loop);
    run.loop.realtime_priority = priority.granted();
  }
  if (thrown && run.loop.end != LoopEnd::io_failed) run.loop.end = LoopEnd::interrupted;
  run.figures = figures_of(session, run.loop, file);
  if (options.progress) {
    print_warnings(run.loop.warnings);
    const std::string fallback = fallback_warning(run.figures);
    if (!fallback.empty()) print_warnings({fallback});
  }
  if (recorder && run.loop.end != LoopEnd::io_failed)
    recorder->close(to_attributes(run.figures), {{"state_hash", run.figures.state_hash}});
  if (thrown) std::rethrow_exception(thrown);
  return run;
}

int exit_code_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::done:
      return 0;
    case LoopEnd::interrupted:
      return interrupted_exit_code();
    case LoopEnd::diverged:
      return static_cast<int>(ErrorKind::diverged);
    case LoopEnd::refused:
      return static_cast<int>(ErrorKind::input);
    case LoopEnd::io_failed:
      return static_cast<int>(ErrorKind::io);
  }
  return 0;
}

}  // namespace verisim

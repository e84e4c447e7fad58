// One simulation, run to its end into one run file.
#pragma once

#include <functional>
#include <string>

#include "engine/session/summary.hpp"

namespace verisim {

struct RecordOptions {
  std::string file;               ///< run file to write; its folder is made; empty: nothing is recorded
  bool another_name = false;      ///< while another run writes that file: FILE-2.h5, FILE-3.h5 …
  bool force = false;             ///< replace a plain file of any kind
  bool paced = false;             ///< by the wall clock
  std::uint64_t empty_block = 0;  ///< as in LoopOptions
  bool embed = true;              ///< the content of every input goes into the run file
  bool progress = false;
  std::function<bool()> after_frame = {};  ///< called after every frame; false ends the run. May be empty
};

struct RecordedRun {
  LoopResult loop;
  RunFigures figures;
};

/// Runs `session` and closes the file, also if it diverged or was interrupted. Error(io) if the file cannot be made or
/// may not be replaced (record/output_place.hpp), or if the planned frames would not fit the free disk.
[[nodiscard]] RecordedRun record_run(Session& session, const RecordOptions& options);

/// Creates the folder of a file to be written if it does not exist. Error(io) that names the file, or what is `named`.
void make_folder_of(const std::string& file, const std::string& named = {});

/// The documented exit code of a loop's end.
[[nodiscard]] int exit_code_of(LoopEnd end);

}  // namespace verisim

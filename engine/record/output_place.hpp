// Where a command writes. A file that stands there already is replaced only if it is of the kind that the command
// writes, by its content; with `force`, if it is any other plain file. An input of the same command, a device, a FIFO
// and a folder are never replaced. Examined before the work begins, so that nothing is computed for nothing.
#pragma once

#include <string>
#include <vector>

#include "engine/base/user_file.hpp"

namespace verisim {

enum class OutputKind {
  run,    ///< HDF5 whose `format` is verisim-run
  trace,  ///< CSV that begins with '# verisim-trace', or HDF5 with the attributes of a trace
  text,   ///< begins as `beginning` says: a CSV's column names
};

struct OutputPlace {
  std::string path;
  OutputKind kind = OutputKind::run;
  bool force = false;
  std::string beginning;  ///< of a text
};

/// The path to write to: `place.path`, or what it leads to if it is a symbolic link. Error(io) if it may not be
/// replaced; an empty file may. What is written beside it on the way (PATH.part …) is looked at in the same way.
[[nodiscard]] std::string check_output(const OutputPlace& place, const std::vector<FileIdentity>& inputs = {});

/// The column names of a CSV, with which it begins; of an SVG what is the same for all of them.
[[nodiscard]] std::string beginning_of(const std::string& content);

/// Writes a table or plot whole, in place of a former one that begins like it. Error(io).
void write_text(const std::string& path, const std::string& content, bool force,
                const std::vector<FileIdentity>& inputs = {});

}  // namespace verisim

// Run files (HDF5): inputs, states and costs of a run. The layout is INTERFACES section 2. The columns come from a
// Schema that the simulation fills: one table for what is stored, hashed and documented.
//
// Writing. The simulation thread fills rows of a ring; one writer thread appends them (SWMR, H5Fflush). The loop never
// allocates, locks or writes. A process killed at any moment leaves a file that h5py opens with swmr=True and that
// recover() closes; at most the last 100 ms of simulated frames are missing. The file is
// written as ".part" and renamed once its first frame is safe on disk; a former file of that name stays until then.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/columns.hpp"

namespace verisim {

/// The columns of a run, packed without padding in the order of adding; /state columns first, so that the state of a
/// row is contiguous.
class Schema {
 public:
  /// Returns the column's index. Throws Error(input) if the path exists already (two bodies of one name).
  /// @pre the path begins with '/'; width > 0; /state columns come before all others, /state/hash excepted
  std::size_t add(Column column);
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] std::size_t row_bytes() const { return row_bytes_; }
  /// Length of the leading /state part, without /state/hash.
  [[nodiscard]] std::size_t state_bytes() const { return state_bytes_; }

 private:
  std::vector<Column> columns_;
  std::size_t row_bytes_ = 0;
  std::size_t state_bytes_ = 0;
};

using Attribute = std::variant<std::string, double, std::int64_t>;

/// A file that the run read, as it was.
struct InputFile {
  std::string name;     ///< as the scenario names it, relative to its folder
  std::string sha256;   ///< of the content
  std::string content;  ///< empty with --no-embed
  bool embedded = true;
};

/// A part that the run loaded, as tables (engine/geometry/part.hpp, to_tables).
struct StoredModel {
  std::string key;  ///< file name or solid text, with the load options
  std::vector<std::pair<std::string, std::vector<NamedArray>>> parts;  ///< part name, its tables
};

/// Data that are known before the first frame.
struct RunHeader {
  std::map<std::string, Attribute> attributes;  ///< of "/": scenario, parameters (JSON), seed, dt, version …
  std::vector<InputFile> files;                 ///< /inputs/files/NAME
  std::vector<StoredModel> models;              ///< /inputs/models/K/P/…
};

struct Event {
  double time = 0;   ///< simulated, s
  std::string kind;  ///< at most 31 characters; longer is cut
  std::string text;  ///< at most 223
};

struct RecorderOptions {
  bool paced = false;  ///< never wait for the file: a full ring is Error(io)
  std::size_t frames_unflushed =
      100;                    ///< free-running: a kill loses at most so many frames; the loop waits for the file
  std::size_t ring_rows = 0;  ///< 0: chosen (256 free-running; 8 s of frames paced)
};

/// Writes one run. Not copyable. All functions are for the one simulation thread.
class Recorder {
 public:
  /// Creates the file and writes header and inputs. Throws Error(io) if it cannot be written.
  Recorder(const std::string& path, const Schema& schema, const RunHeader& header, const RecorderOptions& options);
  /// Not closed (an exception): the rows are kept in a readable file without /summary; a run without a row leaves none.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// @pre no row is open, close() has not been called
  /// The next row to fill, schema.row_bytes() long, zeroed. May wait (free-running only). No allocation.
  /// Throws Error(io) if the writer has failed (disk full …).
  [[nodiscard]] std::span<std::byte> begin_row();
  void end_row();  ///< @pre a row is open
  /// @pre the time is finite, the kind is not empty
  /// No allocation: copied into a fixed ring. If that is full, the loop waits (free-running: what a file holds must not
  /// depend on the disk); paced, events are counted and close() writes one "events lost".
  void event(double time, std::string_view kind, std::string_view text);

  /// Flushes, stops the writer, writes the /summary and root attributes (state_hash …), and leaves a plainly readable
  /// file. Atomic: until it is done the file is as a kill would leave it.
  void close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A run file opened for reading. A file that a killed run left open is recovered first; `recovered()` then says so.
class RunFile {
 public:
  /// Throws Error(input): not there, not HDF5, not a verisim run, a later format_version, damaged.
  explicit RunFile(const std::string& path);
  ~RunFile();
  RunFile(RunFile&&) noexcept;

  [[nodiscard]] const RunHeader& header() const;
  [[nodiscard]] const std::map<std::string, Attribute>& summary() const;  ///< empty if the run was killed
  [[nodiscard]] const Schema& schema() const;                             ///< as stored
  [[nodiscard]] std::size_t rows() const;                                 ///< frames: the shortest column's length
  /// rows() * column.bytes(); of a column with `due`, as many as frames have added.
  [[nodiscard]] std::vector<std::byte> column(const Column& column) const;
  [[nodiscard]] std::vector<Event> events() const;
  [[nodiscard]] bool recovered() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Closes the file of a run that was killed, in place and atomically, cutting all columns to the same length.
/// Returns the number of rows kept; nullopt if the file was closed already (nothing is touched).
/// Throws Error(input) if it is no run file, Error(io) if it cannot be written.
std::optional<std::size_t> recover(const std::string& path);

}  // namespace verisim

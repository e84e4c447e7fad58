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
#include <unordered_set>
#include <variant>
#include <vector>

#include "engine/base/columns.hpp"

namespace verisim {

struct ByteRange {
  std::size_t offset, bytes;
};

/// The columns of a run: those of the row that every frame has, and those of the table, of which a frame has as many
/// rows as pairs of bodies were near. Both are packed without padding in the order of adding; /state columns first, so
/// that the state of a row is contiguous.
class Schema {
 public:
  /// Adds a column of the row, or of the table if it says what counts its rows (Column::rows_in_frame).
  /// Throws Error(input) if the path exists already (two bodies of one name).
  /// @pre the path begins with '/'; width > 0; /state columns of the row come before all others, /state/hash excepted
  void add(Column column);
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }  ///< of the row
  [[nodiscard]] const std::vector<Column>& table() const { return table_; }
  [[nodiscard]] std::size_t row_bytes() const { return row_bytes_; }
  [[nodiscard]] std::size_t table_row_bytes() const { return table_row_bytes_; }
  /// Length of the leading /state part of a row, without /state/hash.
  [[nodiscard]] std::size_t state_bytes() const { return state_bytes_; }
  /// How many bytes of a row are of columns with a Column::rest.
  [[nodiscard]] std::size_t rest_bytes() const { return rest_bytes_; }
  /// Where in a row all other columns lie.
  [[nodiscard]] std::vector<ByteRange> without_rest() const;

  /// The names that /state/pairs pairs; none: there is no such list.
  std::vector<std::string> bodies;
  /// Path of the u32 column that counts the pairs that each frame adds to /state/pairs.
  std::string pairs_in_frame;

 private:
  std::vector<Column> columns_, table_;
  std::unordered_set<std::string> paths_;
  std::size_t row_bytes_ = 0, table_row_bytes_ = 0;
  std::size_t state_bytes_ = 0, rest_bytes_ = 0;
};

/// A row of /state/pairs: two of Schema::bodies.
struct BodyPair {
  std::uint32_t first, second;
};

/// A whole number is an int64_t wherever it fits: what was read equals what was written.
using Attribute = std::variant<std::string, double, std::int64_t, std::uint64_t>;

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

/// Kind of the last event of a paced run of which some found no room; its text begins with how many.
inline constexpr const char* kEventsLost = "events lost";
/// What a run file keeps of an event.
[[nodiscard]] Event as_stored(const Event& event);

struct RecorderOptions {
  bool paced = false;  ///< never wait for the file: a full ring is Error(io)
  std::size_t frames_unflushed =
      100;                         ///< free-running: a kill loses at most so many frames; the loop waits for the file
  std::size_t ring_rows = 0;       ///< 0: chosen (256 free-running; 8 s of frames paced, at most 64 MB)
  std::size_t table_rows = 0;      ///< of the table that fit into its ring at the start; 0: chosen. It grows if needed
  std::size_t frames_planned = 0;  ///< 0: not known. To be on with more or less costs a little once
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
  /// `awake`: the parts with a Column::rest that are not at rest in this row. What the row says of the others is not
  /// looked at, nor zeroed.
  [[nodiscard]] std::span<std::byte> begin_row(std::span<const std::size_t> awake = {});
  /// Copies the table's rows of the frame: schema.table_row_bytes() each. No allocation. May wait, free-running; paced,
  /// Error(io) if the disk is too far behind. @pre a row is open; whole rows, no more than make_room() promised
  void add_table_rows(std::span<const std::byte> rows);
  void end_row();  ///< @pre a row is open
  /// Between frames: a frame may from now on have up to so many rows of the table. May wait for the disk and allocate.
  void make_room(std::size_t table_rows_in_a_frame);
  /// Between frames: the next row of /state/pairs. May wait for the disk. @pre two of Schema::bodies
  void pair(BodyPair pair);
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
  /// rows() * column.bytes(); of a column with `due` or of the table, as many as frames have added.
  [[nodiscard]] std::vector<std::byte> column(const Column& column) const;
  /// /state/pairs: names of the first and the second body. Empty in format 1.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> pairs() const;
  [[nodiscard]] std::int64_t format_version() const;
  [[nodiscard]] std::vector<Event> events() const;
  /// What has been changed since the file was closed or recovered, by its checksums (engine/record/checksums.hpp):
  /// "/timing/frame_ns: is not what was recorded" … Reads the whole file but the rows of /state, /cost and /events.
  [[nodiscard]] std::vector<std::string> altered() const;
  [[nodiscard]] bool recovered() const;
  /// False if it stays as it was left, since its folder cannot be written: what is read is a copy.
  [[nodiscard]] bool closed_in_place() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Closes the file of a run that was killed, in place and atomically, cutting all columns to the same length.
/// Returns the number of rows kept; nullopt if the file was closed already (nothing is touched).
/// Throws Error(input) if it is no run file, Error(io) if it cannot be written.
std::optional<std::size_t> recover(const std::string& path);

}  // namespace verisim

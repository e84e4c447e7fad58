// The HDF5 side of a recording: creates the file of a run, appends rows and events, flushes them, closes the file. For
// one thread at a time; knows no ring and no clock. All functions throw Error(io).
//
// Layout beyond INTERFACES section 2. Attributes of "/": `columns`, their number. Attributes of a column: `order`, its
// index in the schema, the table's behind the row's; `names` of values or components; `rows_where` if not every frame
// adds a row, the path of the column that is not 0 in the frames that do; `rows_in_frame` if a frame adds any number of
// rows, the path of the column that says how many; `rests` if rows may be left out (resting_columns.hpp).
// /inputs/files/N and /inputs/models/I/J are numbered; the names of files, models and parts are attributes, because
// they may be equal or contain '/'.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/resting_columns.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

inline constexpr const char* kRunFormat = "verisim-run";
inline constexpr std::int64_t kRunFormatVersion = 2;

/// An event in the ring and in the file. Its strings have fixed lengths, because SWMR cannot append others.
struct StoredEvent {
  double time = 0;
  char kind[32] = {};
  char text[224] = {};
};
static_assert(sizeof(StoredEvent) == 264);
/// What is too long is cut, not within a UTF-8 character.
[[nodiscard]] StoredEvent stored_event(double time, std::string_view kind, std::string_view text);

/// The HDF5 type of a StoredEvent.
[[nodiscard]] hdf5::Handle event_type();

/// The HDF5 type of a row of /state/pairs in memory: two texts of `length` bytes, ended by NUL.
[[nodiscard]] hdf5::Handle pair_type(std::size_t length);
inline constexpr const char* kPairsPath = "/state/pairs";

class RunWriter {
 public:
  /// Creates PATH.part with header, inputs and empty columns, and starts SWMR. `rows_planned`: 0, not known.
  RunWriter(const std::string& path, const Schema& schema, const RunHeader& header, std::size_t rows_planned);
  /// Without close(): flushed data stay, as after a kill; a file without a row is removed.
  ~RunWriter();

  /// How much is to be appended.
  struct Amount {
    std::size_t rows, table_rows, events, pairs;
    std::size_t awake;  ///< parts that are so in any of the rows
  };
  /// Ensures disk space for an append and a flush. An Error from here leaves a consistent file.
  void reserve(const Amount& amount);
  /// Words for each row that say which parts are awake in it (resting_columns.hpp).
  [[nodiscard]] std::size_t awake_words() const { return resting_.words_per_row(); }
  /// Appends `count` rows (of the table; events, pairs) that lie one after the other. About 4 us a column and 10 ns a
  /// value; of parts at rest nothing. @pre they are there, if there are any
  void append(const std::byte* rows, const std::uint64_t* awake, std::size_t count);
  void append_to_table(const std::byte* rows, std::size_t count);
  void append(const StoredEvent* events, std::size_t count);
  void append(const BodyPair* pairs, std::size_t count);
  /// Flushes all appended data in an order that survives a kill. The first flush with a row gives the file its name.
  void flush();
  /// Ends SWMR, adds the attributes of /summary and "/" to a copy, and puts that in the file's place.
  void close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root);

 private:
  struct Growing {  ///< a dataset that rows are appended to
    hdf5::Handle type, dataset;
    std::size_t rows = 0;
  };
  struct Stored : Growing {
    Column column;
    std::optional<std::size_t> due;  ///< offset in the row of the count that says whether the column gets one
  };
  std::string path_;
  std::unique_ptr<MarkedFile> mark_;  ///< outlives part_: nobody else touches that name before it is gone
  Replacement part_;
  Schema schema_;
  bool has_rows_ = false;
  hdf5::Handle file_;
  std::vector<Stored> columns_, table_;
  RestingColumns resting_;
  Growing events_, pairs_;
  std::unique_ptr<Reservation> room_;
  std::vector<std::byte> packed_;  ///< the rows' values of one column, or pairs as they are stored
  bool failed_ = false;

  void create(const RunHeader& header);
  void start_swmr();
  void close_handles();
  [[nodiscard]] std::vector<Growing*> growing();
  [[nodiscard]] std::optional<std::size_t> due_offset(const Column& column) const;
  [[nodiscard]] std::size_t name_length() const;  ///< of the texts in a row of /state/pairs
  void append_packed(std::vector<Stored>& columns, const std::byte* rows, std::size_t count, std::size_t row_bytes);
  std::size_t pack(const Stored& stored, const std::byte* rows, std::size_t count, std::size_t row_bytes);
  template <typename Work>
  void guard(Work work);
};

}  // namespace verisim

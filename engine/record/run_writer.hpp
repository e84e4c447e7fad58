// The HDF5 side of a recording: creates the file of a run, appends rows and events, flushes them, closes the file. For
// one thread at a time; knows no ring and no clock. All functions throw Error(io).
//
// Layout beyond INTERFACES section 2. Attributes of "/": `columns`, their number. Attributes of a column: `order`, its
// index in the schema; `names` of values or components; `rows_where` if not every frame adds a row, the path of the
// column that is not 0 in the frames that do. /inputs/files/N and /inputs/models/I/J are numbered; the names of files,
// models and parts are attributes, because they may be equal or contain '/'.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

inline constexpr const char* kRunFormat = "verisim-run";
inline constexpr std::int64_t kRunFormatVersion = 1;

/// An event in the ring and in the file. Its strings have fixed lengths, because SWMR cannot append others.
struct StoredEvent {
  double time = 0;
  char kind[32] = {};
  char text[224] = {};
};
static_assert(sizeof(StoredEvent) == 264);

/// The HDF5 type of a StoredEvent.
[[nodiscard]] hdf5::Handle event_type();

class RunWriter {
 public:
  /// Creates PATH.part with header, inputs and empty columns, and starts SWMR.
  RunWriter(const std::string& path, const Schema& schema, const RunHeader& header);
  /// Without close(): flushed data stay, as after a kill; a file without a row is removed.
  ~RunWriter();

  /// Ensures disk space for an append and a flush. An Error from here leaves a consistent file.
  void reserve(std::size_t rows, std::size_t events);
  /// Appends `count` rows that lie one after the other. About 4 us a column and 10 ns a value.
  /// @pre rows (or events) are there, if there are any
  void append(const std::byte* rows, std::size_t count);
  void append(const StoredEvent* events, std::size_t count);
  /// Flushes all appended data in an order that survives a kill. The first flush with a row gives the file its name.
  void flush();
  /// Ends SWMR, adds the attributes of /summary and "/" to a copy, and puts that in the file's place.
  void close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root);

 private:
  struct Stored {
    Column column;
    hdf5::Handle type, dataset;
    std::size_t rows = 0;
    std::optional<std::size_t> due;  ///< offset in the row of the count that says whether the column gets one
  };
  std::string path_;
  std::unique_ptr<MarkedFile> mark_;  ///< outlives part_: nobody else touches that name before it is gone
  Replacement part_;
  Schema schema_;
  std::size_t events_ = 0;
  bool has_rows_ = false;
  hdf5::Handle file_;
  std::vector<Stored> columns_;
  hdf5::Handle event_type_, event_dataset_;
  std::unique_ptr<Reservation> room_;
  std::vector<std::byte> packed_;  ///< the rows' values of one column
  bool failed_ = false;

  void create(const RunHeader& header);
  void start_swmr();
  void close_handles();
  [[nodiscard]] std::optional<std::size_t> due_offset(const Column& column) const;
  std::size_t pack(const Stored& stored, const std::byte* rows, std::size_t count);
  template <typename Work>
  void guard(Work work);
};

}  // namespace verisim

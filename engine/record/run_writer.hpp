// The HDF5 side of a recording: creates the file of a run, appends rows and events, makes them safe, closes it.
// For one thread at a time; knows no ring and no clock. All functions throw Error(io).
//
// Layout beyond INTERFACES section 2: "/" says how many `columns` there are and each carries `order` (its
// place in the schema), where its values or components have names, `names`, and where not every frame adds a row,
// `rows_where`, the column that is not 0 in the frames that do; /inputs/files/N and
// /inputs/models/I/J number files, models and parts, whose names are attributes (names may be equal or hold '/').
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

/// An event as it lies in the ring and in the file: fixed lengths, because SWMR cannot append strings of their own
/// length.
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
  /// Not closed: what was flushed stays as a kill would leave it; a file without a row is removed.
  ~RunWriter();

  /// Makes sure that so much can be appended and flushed. Called before, its Error leaves a file that is whole.
  void reserve(std::size_t rows, std::size_t events);
  /// Appends `count` rows that lie one after the other. About 4 us a column and 10 ns a value.
  /// @pre rows (or events) are there, if there are any
  void append(const std::byte* rows, std::size_t count);
  void append(const StoredEvent* events, std::size_t count);
  /// Hands all that was appended to the system, in an order that survives a kill. From the first time with a row on,
  /// the file has its own name.
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

// The datasets of columns with a rest (Column::rest), such as those of bodies that are fixed: rows that say what the
// column says at rest cost nothing, neither time nor bytes, however many such columns a run has.
//
// Where nothing is written a dataset reads as its fill value, which is one number: a column whose rest is the same
// number throughout (0) has that, and no chunk before something else happens. Any other rest (a pose) stands in chunks
// that are all the same bytes: a row that is repeated, compressed once by this program and stored as it is.
//
// To lengthen a thousand datasets with every flush would cost more than their rows: they are as long as the run is
// planned from the start, and are cut when the file is closed or recovered. So in a file that was left open they are
// longer than others; what they say beyond the frames means nothing.
//
// A killed run must not lose what happened to a body and keep the frame: what is written here is flushed before the
// columns that say which frames there are grow. For one thread at a time, as RunWriter.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

/// The attribute of such a dataset. Its value says nothing.
inline constexpr const char* kRests = "rests";

/// Which parts are awake in a row: bit i % 64 of word i / 64 is that of part i.
inline constexpr std::size_t kPartsInWord = 64;

/// Throws hdf5::Failure unless so many rows of such a dataset can be read without harm: a stranger's chunks may inflate
/// without end.
void check_resting(hid_t dataset, const Column& column, std::size_t rows);

class RestingColumns {
 public:
  /// Of the columns of the schema that have a rest. `rows_planned`: 0, not known.
  RestingColumns(const Schema& schema, std::size_t rows_planned);

  /// Creates the dataset of one of them.
  [[nodiscard]] hdf5::Handle create(hid_t file, const Column& column, hid_t type) const;
  /// The file, open under SWMR, that rows go to. No dataset is opened before it has something to say: HDF5 looks with
  /// every flush at all that are open, and at all that it knows of them.
  void use(hid_t file) { file_ = file; }

  /// Bytes that the file may need for so many rows in which so many parts are awake.
  [[nodiscard]] std::uint64_t room(std::size_t rows, std::size_t awake) const;
  /// Appends `count` rows that lie one after the other; `awake` has words_per_row() words for each. Flushes what it
  /// writes of them. @pre use()
  void append(const std::byte* rows, const std::uint64_t* awake, std::size_t count);
  /// Cuts all of them, in a closed file, to the rows that were appended.
  void cut(hid_t file) const;

  [[nodiscard]] std::size_t words_per_row() const { return words_; }
  void close();
  void release();  ///< of a file that cannot be closed

 private:
  struct Resting {
    Column column;
    hdf5::Handle type, dataset;  ///< none: it was never awake
  };
  std::size_t row_bytes_, words_ = 0;
  std::size_t part_bytes_ = 0, part_bytes_max_ = 0;  ///< of a row
  std::vector<Resting> columns_;
  hid_t file_ = -1;  ///< not owned
  std::size_t rows_ = 0;
  std::size_t length_;            ///< of the datasets
  std::size_t stored_;            ///< rows for which chunks are stored
  std::uint64_t step_bytes_ = 0;  ///< of the chunks that are stored at a time
  std::vector<std::byte> packed_;

  static void store_chunks(hid_t dataset, const Column& column, std::size_t from, std::size_t to);
  [[nodiscard]] hdf5::Handle opened(const Column& column) const;
  [[nodiscard]] bool chunks_are_due(std::size_t rows) const;
  void store_due_chunks(std::size_t rows);
  void lengthen(std::size_t rows);
  void write_awake(Resting& resting, const std::byte* rows, const std::uint64_t* awake, std::size_t count);
};

}  // namespace verisim

// The columns of a stored run, identified by their attributes.
#pragma once

#include <hdf5.h>

#include <map>
#include <string>
#include <vector>

#include "engine/record/run_file.hpp"

namespace verisim {

/// A column as it is stored. Rows may differ between columns in the file of a run that was killed.
struct StoredColumn {
  Column column;
  std::size_t rows = 0;
  bool rests = false;  ///< it claims more than it stores (resting_columns.hpp), and may be longer than the run
};

/// All columns in the order of the schema that was written, the table's behind the row's. Throws hdf5::Failure if one
/// is missing or damaged.
[[nodiscard]] std::vector<StoredColumn> read_columns(hid_t file);

/// /state/pairs as it is stored.
struct StoredPairs {
  bool there = false;          ///< format 1 has none
  std::string pairs_in_frame;  ///< the column that counts them
  std::size_t rows = 0;
};
[[nodiscard]] StoredPairs read_pairs(hid_t file);

/// How many frames all columns hold completely, and how many rows these have added to what does not grow by one row a
/// frame.
class CompleteFrames {
 public:
  /// Throws hdf5::Failure.
  CompleteFrames(hid_t file, const std::vector<StoredColumn>& columns, const StoredPairs& pairs);
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t rows_of(const Column& column) const;
  [[nodiscard]] std::size_t pairs() const { return pairs_; }

 private:
  [[nodiscard]] const std::vector<std::uint32_t>& counts(hid_t file, const std::vector<StoredColumn>& columns,
                                                         const std::string& path);
  std::size_t count_ = 0, pairs_ = 0;
  std::map<std::string, std::vector<std::uint32_t>> counts_;  ///< by path of the counting column
};

/// Throws Error(input) unless the open file is a run of a version that this program reads.
void check_is_run(const std::string& path, hid_t file);

}  // namespace verisim

// The columns of a stored run, identified by their attributes.
#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

#include "engine/record/run_file.hpp"

namespace verisim {

/// A column as it is stored. Rows may differ between columns in the file of a run that was killed.
struct StoredColumn {
  Column column;
  std::size_t rows = 0;
};

/// All columns in the order of the schema that was written. Throws hdf5::Failure if one is missing or damaged.
[[nodiscard]] std::vector<StoredColumn> read_columns(hid_t file);

/// Number of frames that all columns hold completely; 0 if there is no column. Throws hdf5::Failure.
[[nodiscard]] std::size_t frames_of(hid_t file, const std::vector<StoredColumn>& columns);
/// The rows that these frames have added to a column. Throws hdf5::Failure.
[[nodiscard]] std::size_t rows_of(hid_t file, const std::vector<StoredColumn>& columns, const Column& column,
                                  std::size_t frames);

/// Throws Error(input) unless the open file is a run of a version that this program reads.
void check_is_run(const std::string& path, hid_t file);

}  // namespace verisim

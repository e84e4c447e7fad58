// The columns of a stored run: found again by what they say of themselves.
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

/// The smallest number of rows; 0 if there is no column.
[[nodiscard]] std::size_t shortest(const std::vector<StoredColumn>& columns);

/// Throws Error(input) unless the open file says that it is a run of a version that this program reads.
void check_is_run(const std::string& path, hid_t file);

}  // namespace verisim

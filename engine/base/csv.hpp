// Reading CSV (RFC 4180) that people or `verisim batch` wrote. (Traces have a reader of their own: numbers by the
// million.)
#pragma once

#include <string>
#include <vector>

namespace verisim {

struct CsvRow {
  std::size_t line = 0;  ///< of the file, from 1
  std::vector<std::string> fields;
};

/// All rows that are not empty. `name` begins the errors. Error(input): a quote that is not closed.
[[nodiscard]] std::vector<CsvRow> read_csv(const std::string& name, const std::string& content);

}  // namespace verisim

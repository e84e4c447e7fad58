#include "engine/compare/index_table.hpp"

#include <algorithm>
#include <charconv>

#include "engine/base/csv.hpp"
#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"

namespace verisim::compare {

IndexTable::IndexTable(const std::string& path) : path_(path) {
  std::vector<CsvRow> rows = read_csv(path, UserFile(path, path).content());
  if (!rows.empty()) columns_ = std::move(rows.front().fields);
  if (!find("run"))
    fail(ErrorKind::input, "{}: its first line has no column 'run'; it is not what `verisim batch` writes", path);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    CsvRow& row = rows[i];
    if (row.fields.size() != columns_.size())
      fail(ErrorKind::input, "{}:{}: has {} fields, the first line {}; the file is damaged", path, row.line,
           row.fields.size(), columns_.size());
    rows_.push_back({row.line, std::move(row.fields)});
  }
  if (rows_.empty()) fail(ErrorKind::input, "{}: has no runs: there is nothing to compare", path);
}

std::optional<std::size_t> IndexTable::find(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) return {};
  return static_cast<std::size_t>(found - columns_.begin());
}

std::string IndexTable::place(std::size_t row) const {
  return fmt::format("{}:{}", path_, rows_[row].line);
}

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return {};
  return value;
}

}  // namespace verisim::compare

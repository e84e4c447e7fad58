// A table of a batch folder: index.csv or timing.csv (INTERFACES section 5).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace verisim::compare {

class IndexTable {
 public:
  /// Error(input) with the row: not there, no header with a column `run`, a row of another length, an open quote, no
  /// row.
  explicit IndexTable(const std::string& path);

  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] std::optional<std::size_t> find(const std::string& column) const;
  [[nodiscard]] const std::string& cell(std::size_t row, std::size_t column) const { return rows_[row].cells[column]; }
  /// "A/index.csv:12", for errors.
  [[nodiscard]] std::string place(std::size_t row) const;

 private:
  struct Row {
    std::size_t line;
    std::vector<std::string> cells;
  };
  std::string path_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// The number that all of `text` is, "nan" and "inf" included; nothing for other texts.
[[nodiscard]] std::optional<double> number_in(const std::string& text);

}  // namespace verisim::compare

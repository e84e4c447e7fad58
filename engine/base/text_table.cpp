#include "engine/base/text_table.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim {
namespace {

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

/// One harmless line, of characters that are each as wide as another.
std::string cell_of(const std::string& text) {
  std::string cell;
  for (const char c : shown(text)) cell += c == '\t' ? std::string("\\t") : std::string(1, c);
  return cell;
}

}  // namespace

TextTable::TextTable(std::vector<std::string> head, std::string sides) : sides_(std::move(sides)) {
  rows_.push_back(std::move(head));
  for (std::string& cell : rows_.front()) cell = cell_of(cell);
  const std::size_t columns = rows_.front().size();
  VERISIM_ASSERT(columns > 0);
  if (sides_.empty()) {
    sides_.assign(columns, '>');
    sides_.front() = sides_.back() = '<';
  }
  VERISIM_ASSERT(sides_.size() == columns);
}

void TextTable::add(std::vector<std::string> cells) {
  VERISIM_ASSERT(cells.size() == rows_.front().size());
  for (std::string& cell : cells) cell = cell_of(cell);
  rows_.push_back(std::move(cells));
}

std::string TextTable::text() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 0);
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < columns; ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < columns; ++i) {
      const std::string blanks(widths[i] - width_of(row[i]), ' ');
      line += "  " + (sides_[i] == '<' ? row[i] + blanks : blanks + row[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace verisim

#include "engine/base/csv.hpp"

#include "engine/base/error.hpp"

namespace verisim {

std::vector<CsvRow> read_csv(const std::string& name, const std::string& content) {
  std::vector<CsvRow> rows;
  CsvRow row{.line = 1, .fields = {""}};
  std::size_t line = 1, quote_line = 0;
  bool quoted = false, has_quotes = false;
  const auto end_row = [&] {
    if (row.fields.size() > 1 || !row.fields.front().empty() || has_quotes) rows.push_back(row);
    has_quotes = false;
    row = {.line = line, .fields = {""}};
  };
  std::size_t i = content.starts_with("\xef\xbb\xbf") ? 3 : 0;  // what spreadsheets put before UTF-8
  for (; i < content.size(); ++i) {
    const char c = content[i];
    std::string& field = row.fields.back();
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"')
        field += c;
      else if (i + 1 < content.size() && content[i + 1] == '"')
        field += content[++i];
      else
        quoted = false;
    } else if (c == '"' && field.empty()) {
      quoted = has_quotes = true;
      quote_line = line;
    } else if (c == ',') {
      row.fields.emplace_back();
    } else if (c == '\n') {
      end_row();
    } else if (c != '\r') {
      field += c;
    }
  }
  if (quoted) fail(ErrorKind::input, "{}:{}: the quote that begins here is never closed; close it", name, quote_line);
  end_row();
  return rows;
}

}  // namespace verisim

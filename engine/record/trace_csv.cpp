#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/record/text_scan.hpp"
#include "engine/record/trace_form.hpp"

namespace verisim {
namespace {

/// The text that remains and the number of the line at which it begins.
struct Reader {
  const std::string& name;
  std::string_view rest;
  std::size_t line = 1;

  std::string_view take() {
    ++line;
    return take_line(rest);
  }
};

void read_version(Reader& reader) {
  const std::string_view line = trimmed(reader.take());
  constexpr std::string_view kBegin = "# verisim-trace ";
  if (!line.starts_with(kBegin)) {
    fail(ErrorKind::input, "{}:1: a trace begins with '# verisim-trace 1'; make one with 'verisim trace convert'",
         reader.name);
  }
  if (number_of(line.substr(kBegin.size())) != 1) {
    fail(ErrorKind::input, "{}:1: was written in format {}, this verisim reads format 1; update it", reader.name,
         line.substr(kBegin.size()));
  }
}

void read_key(Reader& reader, Trace& trace) {
  std::string_view line = trimmed(reader.take().substr(1));
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;  // a remark
  const std::string key(trimmed(line.substr(0, colon)));
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (key == "kind") {
    trace.kind = value;
  } else if (key == "source") {
    trace.source = value;
  } else if (key == "rate_hz") {
    const std::optional<double> rate = number_of(value);
    if (!rate || !(*rate > 0)) {
      fail(ErrorKind::input, "{}:{}: rate_hz is '{}' but must be a number above 0", reader.name, reader.line - 1,
           value);
    }
    trace.rate_hz = *rate;
  } else {
    trace.extra[key] = value;
  }
}

std::vector<std::string> split_names(std::string_view line) {
  std::vector<std::string> names;
  for (;;) {
    const std::size_t comma = line.find(',');
    names.emplace_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return names;
    line.remove_prefix(comma + 1);
  }
}

[[noreturn]] void refuse_field(const Reader& reader, const Trace& trace, std::string_view line) {
  const auto fields = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (fields != trace.columns.size()) {
    fail(ErrorKind::input, "{}:{}: {} fields where {} columns are named; repair or remove the row", reader.name,
         reader.line - 1, trimmed(line).empty() ? 0 : fields, trace.columns.size());
  }
  for (const std::string& column : trace.columns) {
    const std::size_t comma = line.find(',');
    const std::string_view field = trimmed(line.substr(0, comma));
    if (!number_of(field)) {
      fail(ErrorKind::input, "{}:{}: column '{}' is '{}', which is no number; repair or remove the row", reader.name,
           reader.line - 1, column, field);
    }
    line.remove_prefix(comma + 1);
  }
  fail(ErrorKind::input, "{}:{}: cannot be understood; repair or remove the row", reader.name, reader.line - 1);
}

// One line into trace.values. The usual case, numbers and commas and nothing else, is one pass.
void read_row(const Reader& reader, std::string_view line, Trace& trace) {
  std::string_view rest = line;
  const std::size_t width = trace.columns.size();
  for (std::size_t i = 0; i < width; ++i) {
    while (rest.starts_with(' ') || rest.starts_with('\t')) rest.remove_prefix(1);
    const std::optional<double> value = take_number(rest);
    while (rest.starts_with(' ') || rest.starts_with('\t')) rest.remove_prefix(1);
    const bool ended = i + 1 == width ? rest.empty() : rest.starts_with(',');
    if (!value || !ended) refuse_field(reader, trace, line);
    if (i + 1 < width) rest.remove_prefix(1);
    trace.values.push_back(*value);
  }
}

void append(std::string& text, double value) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  VERISIM_ASSERT(error == std::errc{});
  text.append(digits, end);
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

Trace read_trace_csv(const std::string& name, std::string_view content, RowPlace& place) {
  Reader reader{name, without_byte_order_mark(content)};
  Trace trace;
  read_version(reader);
  while (reader.rest.starts_with('#')) read_key(reader, trace);
  if (reader.rest.empty()) fail(ErrorKind::input, "{}:{}: the column names are missing", name, reader.line);
  trace.columns = split_names(reader.take());
  const std::size_t first_line = reader.line;
  place = [&name, first_line](std::size_t row) { return fmt::format("{}:{}", name, first_line + row); };
  const std::size_t length = std::max<std::size_t>(1, reader.rest.find('\n') + 1);  // rows are about equally long
  trace.values.reserve((reader.rest.size() / length + 1) * trace.columns.size());
  while (!reader.rest.empty()) {
    const std::string_view line = reader.take();
    if (trimmed(line).empty() && reader.rest.find_first_not_of(" \t\r\n") == std::string_view::npos) break;
    read_row(reader, line, trace);
  }
  return trace;
}

std::string trace_as_csv(const Trace& trace) {
  std::string text = "# verisim-trace 1\n# kind: " + trace.kind;
  if (trace.rate_hz > 0) append(text += "\n# rate_hz: ", trace.rate_hz);
  text += "\n# source: " + one_line(trace.source) + "\n";
  for (const auto& [key, value] : trace.extra) text += "# " + one_line(key) + ": " + one_line(value) + "\n";
  const std::size_t width = trace.columns.size();
  for (std::size_t i = 0; i < width; ++i) text += (i == 0 ? "" : ",") + trace.columns[i];
  text += '\n';
  for (std::size_t i = 0; i < trace.values.size(); ++i) {
    append(text, trace.values[i]);
    text += (i + 1) % width == 0 ? '\n' : ',';
  }
  return text;
}

}  // namespace verisim

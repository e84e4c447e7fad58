#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/record/text_scan.hpp"
#include "engine/record/trace_form.hpp"

namespace verisim {
namespace {

/// The layout of a foreign file.
struct Layout {
  char separator = ',';            ///< ' ': any number of blanks and tabs
  std::vector<std::string> names;  ///< empty: the file has no column names
  std::size_t width = 0;
};

// Semicolons first: where there are both, commas are inside of names or texts.
char separator_of(std::string_view line) {
  for (const char c : {';', ',', '\t'}) {
    if (line.find(c) != std::string_view::npos) return c;
  }
  return ' ';
}

std::string_view take_field(std::string_view& rest, char separator) {
  if (separator == ' ') {
    const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
    const std::string_view field = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t", end), rest.size()));
    return field;
  }
  const std::size_t quote = rest.starts_with('"') ? rest.find('"', 1) : 0;  // separators inside of quotes are text
  const std::size_t end = std::min(rest.find(separator, quote == std::string_view::npos ? 0 : quote), rest.size());
  std::string_view field = trimmed(rest.substr(0, end));
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  return field;
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  line = trimmed(line);
  while (!line.empty()) fields.push_back(take_field(line, separator));
}

bool is_remark(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.starts_with('#') || line.starts_with('%');
}

/// Position of the column that a mapping names, from 0.
std::size_t find_column(const std::string& name, const Layout& layout, const std::string& wanted) {
  const std::optional<double> number = number_of(wanted);
  if (number && std::floor(*number) == *number) {
    if (*number >= 1 && *number <= static_cast<double>(layout.width)) return static_cast<std::size_t>(*number) - 1;
    fail(ErrorKind::input, "{}: has no column {}; its columns are 1 to {}", name, wanted, layout.width);
  }
  const auto found = std::find(layout.names.begin(), layout.names.end(), wanted);
  if (found != layout.names.end()) {
    if (std::find(found + 1, layout.names.end(), wanted) != layout.names.end()) {
      fail(ErrorKind::input, "{}: has several columns '{}'; name it by its number, counted from 1", name, wanted);
    }
    return static_cast<std::size_t>(found - layout.names.begin());
  }
  const std::string near = nearest_name(wanted, layout.names);
  fail(ErrorKind::input, "{}: has no column '{}'{}{}", name, wanted,
       near.empty() ? "" : "; did you mean '" + near + "'?",
       layout.names.empty() ? "; it has no names: count from 1" : "");
}

/// One column of the trace to be made.
struct Target {
  std::string name;
  bool constant = false;
  bool summed = false;
  std::size_t column = 0;  ///< in the file
  double scale = 1, offset = 0, sum = 0;
};

bool is_encoder(const std::string& column) {
  return column == "e0" || column == "e1" || column == "e2" || column == "e3";
}

void check_mappings(const ConvertOptions& options, const std::vector<std::string>& known) {
  std::vector<std::string> seen;
  for (const ColumnMapping& m : options.mappings) {
    if (std::find(known.begin(), known.end(), m.target) == known.end()) {
      const std::string near = nearest_name(m.target, known);
      fail(ErrorKind::usage, "a {} trace has no column '{}'{}; its columns are {}", options.kind, m.target,
           near.empty() ? "" : "; did you mean '" + near + "'?", fmt::join(known, " "));
    }
    if (std::find(seen.begin(), seen.end(), m.target) != seen.end()) {
      fail(ErrorKind::usage, "column '{}' is mapped twice; leave one out", m.target);
    }
    seen.push_back(m.target);
  }
}

Target constant(const std::string& name, double value) {
  return {.name = name, .constant = true, .offset = value};
}

// A quaternion needs all of its four or none; of other vectors the unmapped components are 0.
void fill_group(const ColumnGroup& group, const std::vector<Target>& mapped, std::vector<Target>& targets) {
  const bool quaternion = group.columns.front() == "qx";
  const bool vector = group.columns.size() == 3 && group.columns.front() != "gx" && group.columns.front() != "x";
  if (mapped.empty() && quaternion) {
    for (const std::string& column : group.columns) targets.push_back(constant(column, column == "qw" ? 1 : 0));
    return;
  }
  for (const std::string& column : group.columns) {
    const auto found = std::find_if(mapped.begin(), mapped.end(), [&](const Target& t) { return t.name == column; });
    if (found != mapped.end()) {
      targets.push_back(*found);
    } else if (!mapped.empty() && vector) {
      targets.push_back(constant(column, 0));
    }
  }
}

std::vector<Target> make_targets(const std::string& name, const Layout& layout, const ConvertOptions& options) {
  std::vector<Target> targets;
  for (const ColumnGroup& group : column_groups(name, options.kind)) {
    std::vector<Target> mapped;
    for (const ColumnMapping& m : options.mappings) {
      if (std::find(group.columns.begin(), group.columns.end(), m.target) == group.columns.end()) continue;
      Target t{.name = m.target, .constant = m.source.empty(), .scale = m.scale, .offset = m.offset};
      t.summed = options.cumulative && is_encoder(m.target) && !t.constant;
      if (!t.constant) t.column = find_column(name, layout, m.source);
      mapped.push_back(std::move(t));
    }
    fill_group(group, mapped, targets);
  }
  return targets;
}

/// The number in a field; nullopt if the field is empty or not there at all.
std::optional<double> read_field(const std::string& name, std::size_t line, const std::vector<std::string_view>& fields,
                                 std::size_t column) {
  if (column >= fields.size() || fields[column].empty()) return std::nullopt;
  const std::optional<double> value = number_of(fields[column]);
  if (!value) {
    fail(ErrorKind::input, "{}:{}: column {} is '{}', which is no number; skip that row or map another column", name,
         line, column + 1, fields[column]);
  }
  return value;
}

/// Turns rows of the file into rows of the trace, one by one.
class Conversion {
 public:
  Conversion(const std::string& name, const ConvertOptions& options, const Layout& layout)
      : name_(name), options_(options), targets_(make_targets(name, layout, options)) {
    if (options.rate_hz <= 0) time_column_ = find_column(name, layout, options.time_column);
    trace_.kind = options.kind;
    trace_.source = options.source;
    trace_.columns = {"t"};
    for (const Target& t : targets_) trace_.columns.push_back(t.name);
  }

  void add_row(std::size_t line, const std::vector<std::string_view>& fields) {
    const std::size_t row = rows_++;
    const bool taken = row % static_cast<std::size_t>(options_.every) == 0;
    if (!read_values(line, fields)) {
      ++left_out_;
      return;
    }
    if (!taken) return;
    trace_.values.push_back(time_of(row));
    trace_.values.insert(trace_.values.end(), values_.begin(), values_.end());
    lines_.push_back(line);
  }

  Trace finish() {
    if (left_out_ > 0) trace_.extra["rows_left_out"] = std::to_string(left_out_);
    trace_.rate_hz = options_.rate_hz > 0 ? options_.rate_hz / options_.every : measured_rate();
    check_trace(trace_, name_, "", {.allow_gaps = true},
                [&](std::size_t row) { return fmt::format("{}:{}", name_, lines_[row]); });
    return std::move(trace_);
  }

 private:
  const std::string& name_;
  const ConvertOptions& options_;
  std::vector<Target> targets_;
  std::size_t time_column_ = 0;
  Trace trace_;
  std::vector<std::size_t> lines_;  ///< of the file, for each row of the trace
  std::vector<double> values_;      ///< of the row at hand
  double time_value_ = 0;
  std::optional<double> first_time_;
  std::size_t rows_ = 0, left_out_ = 0;

  /// False if the row lacks a value.
  bool read_values(std::size_t line, const std::vector<std::string_view>& fields) {
    values_.clear();
    if (options_.rate_hz <= 0) {
      const std::optional<double> time = read_field(name_, line, fields, time_column_);
      if (!time) return false;
      time_value_ = *time;
    }
    for (Target& t : targets_) {
      const std::optional<double> field = t.constant ? 0 : read_field(name_, line, fields, t.column);
      if (!field && t.summed) {
        fail(ErrorKind::input,
             "{}:{}: an increment of {} is missing, and all counts after it would be wrong; repair the row", name_,
             line, t.name);
      }
      if (!field) return false;
      if (t.summed) t.sum += t.scale * *field;
      values_.push_back(t.summed ? std::round(t.sum + t.offset) + 0.0 : t.scale * *field + t.offset);
    }
    return true;
  }

  // Whole nanoseconds: 35.3835 s - 35.3830 s is meant to be 0.0005 s.
  double time_of(std::size_t row) {
    if (options_.rate_hz > 0) return static_cast<double>(row) / options_.rate_hz;
    if (!first_time_) first_time_ = time_value_;
    return std::round((time_value_ - *first_time_) * options_.time_scale * 1e9) / 1e9;
  }

  double measured_rate() const {
    const std::size_t n = trace_.rows();
    if (n < 2) return 0;
    const double rate = static_cast<double>(n - 1) / (trace_.at(n - 1, 0) - trace_.at(0, 0));
    return std::round(rate * 1000) / 1000;
  }
};

Layout find_layout(std::string_view line) {
  Layout layout;
  layout.separator = separator_of(line);
  std::vector<std::string_view> fields;
  split(line, layout.separator, fields);
  layout.width = fields.size();
  const bool numbers = std::all_of(fields.begin(), fields.end(), [](auto f) { return f.empty() || number_of(f); });
  if (!numbers) layout.names.assign(fields.begin(), fields.end());
  return layout;
}

void check_options(const std::string& name, const ConvertOptions& options) {
  check_mappings(options, known_columns(name, options.kind));
  if (options.every < 1) fail(ErrorKind::usage, "--every is {} but must be at least 1", options.every);
  if (options.skip_rows < 0) fail(ErrorKind::usage, "--skip is {} but must not be negative", options.skip_rows);
  if (options.rate_hz <= 0 && options.time_column.empty()) {
    fail(ErrorKind::usage, "{}: say how time runs: --rate HZ, or --time COLUMN", name);
  }
}

}  // namespace

ColumnMapping parse_mapping(const std::string& text) {
  const auto refuse = [&]() {
    fail(ErrorKind::usage, "'{}' is no mapping; write TARGET=COLUMN, TARGET=COLUMN*SCALE+OFFSET or TARGET=:CONSTANT",
         text);
  };
  ColumnMapping mapping;
  std::string_view rest = text;
  const std::size_t equals = rest.find('=');
  if (equals == std::string_view::npos) refuse();
  mapping.target = trimmed(rest.substr(0, equals));
  rest = trimmed(rest.substr(equals + 1));
  if (mapping.target.empty() || rest.empty()) refuse();
  if (rest.starts_with(':')) {
    const std::optional<double> value = number_of(rest.substr(1));
    if (!value || !std::isfinite(*value)) refuse();
    mapping.offset = *value;
    return mapping;
  }
  const std::size_t end = std::min(rest.find_first_of("*+-"), rest.size());
  mapping.source = trimmed(rest.substr(0, end));
  if (mapping.source.empty()) refuse();
  rest.remove_prefix(end);
  if (rest.starts_with('*')) {
    rest = trimmed(rest.substr(1));
    const std::optional<double> scale = take_number(rest);
    if (!scale) refuse();
    mapping.scale = *scale;
    rest = trimmed(rest);
  }
  if (!rest.empty()) {
    const std::optional<double> offset = number_of(rest.substr(1));
    if (!offset || (rest.front() != '+' && rest.front() != '-')) refuse();
    mapping.offset = rest.front() == '-' ? -*offset : *offset;
  }
  if (!std::isfinite(mapping.scale) || !std::isfinite(mapping.offset)) refuse();
  return mapping;
}

Trace convert_csv(const std::string& name, const std::string& content, const ConvertOptions& options) {
  check_options(name, options);
  std::string_view rest = without_byte_order_mark(content);
  std::size_t line_number = 0;
  const auto take = [&] {
    ++line_number;
    return take_line(rest);
  };
  for (int i = 0; i < options.skip_rows && !rest.empty(); ++i) static_cast<void>(take());
  std::string_view line;
  while (is_remark(line) && !rest.empty()) line = take();
  if (is_remark(line)) fail(ErrorKind::input, "{}: holds no rows; name another file or skip fewer rows", name);
  const Layout layout = find_layout(line);
  Conversion conversion(name, options, layout);
  std::vector<std::string_view> fields;
  for (bool first = true; first || !rest.empty(); first = false) {
    if (!first) line = take();
    if (is_remark(line) || (first && !layout.names.empty())) continue;
    split(line, layout.separator, fields);
    conversion.add_row(line_number, fields);
  }
  return conversion.finish();
}

}  // namespace verisim

// From the command line's words to a design.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/base/csv.hpp"
#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/batch/design.hpp"
#include "engine/batch/design_text.hpp"

namespace verisim::batch {
namespace {

/// Each parameter has one place; the second is an error that names both.
class Places {
 public:
  void take(const std::string& key, const std::string& place, ErrorKind kind = ErrorKind::usage) {
    for (const auto& [known, where] : taken_)
      if (known == key) fail(kind, "{}: '{}' stands in {} already; leave it out of one of them", place, key, where);
    taken_.emplace_back(key, place);
  }

 private:
  std::vector<std::pair<std::string, std::string>> taken_;
};

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

Axis read_axis(const std::string& option, const ReadValue& read) {
  const std::string what = "--vary " + option;
  auto [key, text] = split_key("--vary", option);
  Axis axis{.key = key, .values = {}};
  if (trimmed(text).empty()) fail(ErrorKind::usage, "{}: no value: the grid is empty; write {}=V1,V2", what, key);
  for (const std::string& part : split_outside_brackets(text, ',')) {
    const std::string value = trimmed(part);
    if (value.empty()) fail(ErrorKind::usage, "{}: an empty value between two commas; write {}=V1,V2", what, key);
    const Cell cell = read("--vary", key, value);
    for (const Value& known : axis.values)
      if (known.cell == cell)
        fail(ErrorKind::usage, "{}: '{}' and '{}' are one value; leave one out, or use --repeat", what, known.text,
             value);
    axis.values.push_back({value, cell});
  }
  return axis;
}

/// Two equal rows are one run, told twice: its figures would count as those of two.
void check_rows(const std::string& name, const std::vector<CsvRow>& rows, const Table& table) {
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    std::string key = table.seeds.empty() ? "" : fmt::format("{}\n", table.seeds[i]);
    for (const Value& value : table.rows[i]) key += shown(plain_text(value.cell)) + "\n";
    const std::size_t line = rows[i + 1].line;
    if (const auto [found, is_new] = known.emplace(key, line); !is_new)
      fail(ErrorKind::input, "{}:{}: is the run of line {} again{}; leave one out, or give them seeds or --repeat",
           name, line, found->second, table.seeds.empty() ? "" : ", with its seed");
  }
}

Table read_table(const DesignRequest& request, const ReadValue& read, Places& places) {
  const std::string &name = request.design_name, &content = request.design_content;
  const std::vector<CsvRow> rows = read_csv(name, content);
  if (rows.empty())
    fail(ErrorKind::input, "{}: is empty; its first line names parameters, each further line is a run", name);
  if (rows.size() == 1) fail(ErrorKind::input, "{}: no run below the line of names; write a line for each", name);
  Table table;
  std::vector<std::string> columns;
  for (const std::string& field : rows.front().fields) {
    columns.push_back(trimmed(field));
    if (columns.back().empty()) fail(ErrorKind::input, "{}:1: column {} has no name", name, columns.size());
    places.take(columns.back(), fmt::format("{}:1", name), ErrorKind::input);
    if (columns.back() == "seed" && request.seed_is_a_parameter)
      fail(ErrorKind::input,
           "{}:1: 'seed' may be the runs' seed or the scenario's parameter of that name; call the parameter otherwise, "
           "or vary it with --vary",
           name);
    if (columns.back() != "seed") table.keys.push_back(columns.back());
  }
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::string place = fmt::format("{}:{}", name, rows[i].line);
    if (rows[i].fields.size() != columns.size())
      fail(ErrorKind::input, "{}: {} values, and line 1 names {} columns; write one for each", place,
           rows[i].fields.size(), columns.size());
    table.rows.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string text = trimmed(rows[i].fields[c]);
      if (text.empty()) fail(ErrorKind::input, "{}: '{}' is empty; write a value", place, columns[c]);
      if (columns[c] == "seed") {
        table.seeds.push_back(whole_number(place + ": seed", text, true));
        continue;
      }
      table.rows.back().push_back({text, read(place + ":", columns[c], text)});
    }
  }
  check_rows(name, rows, table);
  return table;
}

/// "100 a=1..2 b=normal:0:1", perhaps several times.
void read_draws(const std::vector<std::string>& words, const ReadValue& read, Places& places, Design& design) {
  bool counted = false;
  for (const std::string& word : words) {
    if (word.find('=') == std::string::npos) {
      const std::uint64_t count = whole_number("--random", word);
      if (count == 0) fail(ErrorKind::usage, "--random 0: no draw: the design is empty; write 1 or more");
      if (counted && count != design.draw_count)
        fail(ErrorKind::usage, "--random {} and --random {}: one number of draws for all", design.draw_count, count);
      counted = true;
      design.draw_count = count;
      continue;
    }
    if (!counted)
      fail(ErrorKind::usage, "--random {}: the number of draws comes first: --random 100 KEY=LOW..HIGH", word);
    const auto [key, text] = split_key("--random", word);
    const std::string what = "--random " + word;
    places.take(key, what);
    const auto number = [&, &key = key](const std::string& figure) {
      const Cell cell = read("--random", key, trimmed(figure));
      if (!std::holds_alternative<double>(cell)) fail(ErrorKind::usage, "{}: '{}' is no number", what, figure);
      return std::get<double>(cell);
    };
    design.draws.push_back({key, distribution_from(what, text, number)});
  }
  if (counted && design.draws.empty())
    fail(ErrorKind::usage, "--random {}: no parameter to draw; write --random {} KEY=LOW..HIGH", design.draw_count,
         design.draw_count);
}

Shard read_shard(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t slash = text.find('/');
  const std::string what = "--shard " + text;
  if (slash == std::string::npos) fail(ErrorKind::usage, "{}: write it as I/N, the I-th of N: --shard 1/4", what);
  const Shard shard{whole_number(what, text.substr(0, slash)), whole_number(what, text.substr(slash + 1))};
  if (shard.index < 1 || shard.index > shard.of)
    fail(ErrorKind::usage, "{}: there is no such part; I goes from 1 to N", what);
  if (shard.of > kRunsMax) fail(ErrorKind::usage, "{}: no batch has so many runs; N is at most {}", what, kRunsMax);
  return shard;
}

void check_count(const Design& design) {
  // As numbers of arbitrary size would have it: a product of doubles does not go round.
  double count = static_cast<double>(design.table ? design.table->rows.size() : 1);
  count *= static_cast<double>(design.draw_count) * static_cast<double>(design.repeat);
  for (const Axis& axis : design.axes) count *= static_cast<double>(axis.values.size());
  if (count > static_cast<double>(kRunsMax))
    fail(ErrorKind::usage,
         "the design has {:.0f} runs, more than the {} that a batch may have; vary less, or use --random", count,
         kRunsMax);
}

}  // namespace

Design make_design(const DesignRequest& request, const ReadValue& read) {
  Design design;
  design.seed = request.seed;
  design.repeat = request.repeat;
  design.shard = read_shard(request.shard);
  if (design.repeat == 0) fail(ErrorKind::usage, "--repeat 0: no run: the design is empty; write 1 or more");
  Places places;
  for (const std::string& key : request.set_keys) places.take(key, "--set " + key);
  if (!request.design_name.empty()) design.table = read_table(request, read, places);
  for (const std::string& option : request.vary) {
    places.take(split_key("--vary", option).first, "--vary " + shown(option, 80));
    design.axes.push_back(read_axis(option, read));
  }
  read_draws(request.random, read, places, design);
  if (design.table && !design.table->seeds.empty() && (design.repeat > 1 || !design.draws.empty()))
    fail(ErrorKind::usage, "{} gives each run its seed, and {} wants others; leave one of them out",
         request.design_name, design.repeat > 1 ? "--repeat" : "--random");
  check_count(design);
  return design;
}

}  // namespace verisim::batch

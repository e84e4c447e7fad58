#include "engine/batch/index.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"
#include "engine/record/file_replace.hpp"

namespace verisim::batch {

namespace {

constexpr int kFormat = 1;
constexpr std::size_t kColumnsMax = 1900;  // SQLite has 2000 at most

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

Json columns_json(const std::vector<IndexColumn>& columns) {
  Json json = Json::array();
  for (const IndexColumn& c : columns)
    json.push_back({{"name", c.name}, {"type", c.type}, {"unit", c.unit}, {"meaning", c.meaning}});
  return json;
}

std::vector<IndexColumn> columns_of(const Json& json) {
  std::vector<IndexColumn> columns;
  for (const Json& c : json) columns.push_back({c.at("name"), c.at("type"), c.at("unit"), c.at("meaning")});
  return columns;
}

/// The columns of `run` before the measures, in the order of the CSV.
std::vector<std::string> head_columns(const Layout& layout) {
  std::vector<std::string> names{"run", "seed"};
  for (const IndexColumn& c : layout.parameters) names.push_back(c.name);
  names.insert(names.end(), {"status", "error", "outcome"});
  return names;
}

bool is_in_head(const std::string& name) {
  return name == "outcome";
}

std::vector<std::string> figure_columns(const Layout& layout) {
  std::vector<std::string> names;
  for (const IndexColumn& c : layout.figures)
    if (!is_in_head(c.name)) names.push_back(c.name);
  return names;
}

std::string list_of(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& name : columns) text += (text.empty() ? "" : ", ") + sql_name(name);
  return text;
}

void add_measure_column(Database& database, const std::string& table, const std::string& column) {
  database.run(fmt::format("ALTER TABLE {} ADD COLUMN {} REAL", sql_name(table), sql_name(column)));
}

const std::vector<IndexColumn>& fixed_columns() {
  static const std::vector<IndexColumn> columns = {
      {"run", "INTEGER", "1", "number of the run in the order of the design, from 0"},
      {"seed", "", "1", "seed of every random stream of the run"},
      {"status", "TEXT", "", "done, failed, diverged, timeout or memory"},
      {"error", "TEXT", "", "why the run is not done"},
      {"outcome", "TEXT", "", "the scenario's own word"},
  };
  return columns;
}

}  // namespace

Json to_json(const Layout& layout) {
  return {{"parameters", columns_json(layout.parameters)},
          {"figures", columns_json(layout.figures)},
          {"timing", columns_json(layout.timing)}};
}

Layout layout_of(const Json& json) {
  return {columns_of(json.at("parameters")), columns_of(json.at("figures")), columns_of(json.at("timing"))};
}

Index::Index(const std::string& path, const Layout& layout, const std::string& version)
    : Index(path, Database::Access::write) {
  const Cell format = database_->value("PRAGMA user_version");
  if (format == Cell(std::int64_t{0})) {
    if (database_->value("SELECT count(*) FROM sqlite_master") != Cell(std::int64_t{0}))
      refuse_damaged(path, "no format");
    layout_ = layout;
    make_tables(version);
    return;
  }
  check_version(version);
}

Index Index::open(const std::string& path, const std::string& version) {
  if (!identity_of(path)) fail(ErrorKind::input, "{}: there is no such index; name a folder of verisim batch", path);
  Index index(path, Database::Access::read);
  index.check_version(version);
  return index;
}

void Index::check_version(const std::string& version) {
  const Cell format = database_->value("PRAGMA user_version");
  if (format == Cell(std::int64_t{0})) refuse_damaged(database_->path(), "no format");
  if (format != Cell(std::int64_t{kFormat}))
    fail(ErrorKind::input,
         "{}: has format {}, this program writes {}; go on with the version that wrote it, or name "
         "another folder with -o",
         database_->path(), plain_text(format), kFormat);
  const std::string made_by = plain_text(database_->value("SELECT value FROM meta WHERE name = 'version'"));
  if (made_by != version)
    fail(ErrorKind::input,
         "{}: was made by verisim {}, this is {}: their figures need not agree; go on with that version, or name "
         "another "
         "folder with -o",
         database_->path(), shown(made_by, 80), version);
  try {
    layout_ = layout_of(parse_json(plain_text(database_->value("SELECT value FROM meta WHERE name = 'layout'"))));
  } catch (const Json::exception&) {
    refuse_damaged(database_->path(), "no layout");
  }
  check_tables();
}

/// What a reader takes for granted.
void Index::check_tables() {
  const std::string& path = database_->path();
  const auto expect = [&](const std::string& table, const std::vector<std::string>& columns) {
    const std::vector<std::string> there = database_->columns(table);
    for (const std::string& column : columns)
      if (std::find(there.begin(), there.end(), column) == there.end())
        refuse_damaged(path, fmt::format("{} has no column {}", table, column));
  };
  expect("run", head_columns(layout_));
  expect("run", figure_columns(layout_));
  std::vector<std::string> timing{"run"};
  for (const IndexColumn& column : layout_.timing) timing.push_back(column.name);
  expect("timing", timing);
  std::string known;
  for (const char* status : kStatuses) known += fmt::format("{}'{}'", known.empty() ? "" : ", ", status);
  const auto count = [&](const std::string& of) { return database_->value("SELECT count(*) FROM " + of); };
  if (count("run WHERE status IS NULL OR status NOT IN (" + known + ")") != Cell(std::int64_t{0}))
    refuse_damaged(path, "a run of no known status");
  const Cell runs = count("run");
  if (runs != count("timing") || runs != count("run JOIN timing USING (run)"))
    refuse_damaged(path, "runs without their times");
}

/// Without the measures.
void Index::make_run_table(const std::string& name) {
  std::string run = "run INTEGER PRIMARY KEY, seed";
  for (const IndexColumn& c : layout_.parameters) run += fmt::format(", {} {}", sql_name(c.name), c.type);
  run += ", status TEXT, error TEXT, outcome TEXT";
  for (const IndexColumn& c : layout_.figures)
    if (!is_in_head(c.name)) run += fmt::format(", {} {}", sql_name(c.name), c.type);
  database_->run(fmt::format("CREATE TABLE {} ({})", sql_name(name), run));
}

void Index::make_tables(const std::string& version) {
  std::string timing = "run INTEGER PRIMARY KEY";
  for (const IndexColumn& c : layout_.timing) timing += fmt::format(", {} {}", sql_name(c.name), c.type);
  database_->transaction([&] {
    make_run_table("run");
    database_->run("CREATE TABLE timing (" + timing + ")");
    database_->run("CREATE TABLE unit (\"column\" TEXT PRIMARY KEY, unit TEXT, meaning TEXT)");
    database_->run("CREATE TABLE input (name TEXT PRIMARY KEY, sha256 TEXT)");
    database_->run("CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT)");
    Statement unit = database_->prepare("INSERT OR IGNORE INTO unit VALUES (?, ?, ?)");
    for (const auto& columns : {fixed_columns(), layout_.parameters, layout_.figures, layout_.timing})
      for (const IndexColumn& c : columns) {
        unit.bind(1, c.name);
        unit.bind(2, c.unit);
        unit.bind(3, c.meaning);
        unit.step();
      }
    Statement meta = database_->prepare("INSERT INTO meta VALUES (?, ?)");
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"version", version}, {"layout", json_text(to_json(layout_))}}) {
      meta.bind(1, name);
      meta.bind(2, value);
      meta.step();
    }
    database_->run(fmt::format("PRAGMA user_version = {}", kFormat));
  });
}

void Index::expect_input(const std::string& name, const std::string& sha256) {
  Answer expected;
  expected.inputs[name] = sha256;
  database_->transaction([&] { add_inputs(expected); });
}

std::vector<std::string> Index::inputs() {
  std::vector<std::string> names;
  Statement statement = database_->prepare("SELECT name FROM input ORDER BY name");
  while (statement.step()) names.push_back(plain_text(statement.column(0)));
  return names;
}

std::vector<std::uint64_t> Index::runs(std::uint64_t end) {
  std::vector<std::uint64_t> all;
  Statement statement = database_->prepare("SELECT run FROM run ORDER BY run");
  while (statement.step()) all.push_back(static_cast<std::uint64_t>(std::get<std::int64_t>(statement.column(0))));
  if (!all.empty() && all.back() >= end)
    refuse_damaged(database_->path(), fmt::format("run {} is none of its design", all.back()));
  return all;
}

std::string Index::column_of(const Measure& measure) {
  std::vector<std::string> fixed = head_columns(layout_);
  for (const auto& columns : {layout_.figures, layout_.timing})
    for (const IndexColumn& c : columns) fixed.push_back(c.name);
  const bool taken = std::any_of(fixed.begin(), fixed.end(),
                                 [&](const std::string& name) { return lower(name) == lower(measure.name); });
  std::string column = taken ? "measure." + measure.name : measure.name;
  const std::vector<std::string> all = database_->columns("run");
  for (const std::string& known : all)
    if (lower(known) == lower(column) && known != column)
      fail(ErrorKind::input,
           "measures '{}' and '{}' differ in capital letters alone, and columns of SQL do not; rename one",
           shown(known), shown(column));
  if (std::find(all.begin(), all.end(), column) == all.end()) {
    if (all.size() >= kColumnsMax)
      fail(ErrorKind::input, "{}: more than {} columns; measure less", database_->path(), kColumnsMax);
    add_measure_column(*database_, "run", column);
  }
  Statement unit = database_->prepare("SELECT unit FROM unit WHERE \"column\" = ?");
  unit.bind(1, column);
  if (!unit.step()) {
    Statement insert = database_->prepare("INSERT INTO unit VALUES (?, ?, 'measured by the scenario')");
    insert.bind(1, column);
    insert.bind(2, measure.unit);
    insert.step();
  } else if (plain_text(unit.column(0)) != measure.unit) {
    fail(ErrorKind::input, "measure '{}' has the unit '{}' in one run and '{}' in another; give it one",
         shown(measure.name), shown(plain_text(unit.column(0))), shown(measure.unit));
  }
  return column;
}

void Index::add_inputs(const Answer& answer) {
  Statement known = database_->prepare("SELECT sha256 FROM input WHERE name = ?");
  Statement insert = database_->prepare("INSERT INTO input VALUES (?, ?)");
  for (const auto& [name, sha256] : answer.inputs) {
    known.bind(1, name);
    if (known.step()) {
      const std::string before = plain_text(known.column(0));
      known.step();
      if (before != sha256)
        fail(ErrorKind::input,
             "{}: was changed since the batch began: its runs would not be of one scenario; put the former content "
             "back, or name another folder with -o",
             shown(name));
      continue;
    }
    insert.bind(1, name);
    insert.bind(2, sha256);
    insert.step();
  }
}

void Index::add(const RowHead& head, const Answer& answer) {
  VERISIM_ASSERT(head.parameters.size() == layout_.parameters.size());
  database_->transaction([&] {
    add_inputs(answer);
    std::vector<std::pair<std::string, Cell>> cells = {
        {"run", cell_of(head.run)}, {"seed", cell_of(head.seed)}, {"status", answer.status}};
    if (!answer.error.empty()) cells.emplace_back("error", answer.error);
    for (std::size_t i = 0; i < head.parameters.size(); ++i)
      cells.emplace_back(layout_.parameters[i].name, head.parameters[i]);
    for (const auto& [name, cell] : answer.figures) cells.emplace_back(name, cell);
    for (const Measure& measure : answer.measures) cells.emplace_back(column_of(measure), measure.value);
    const auto insert = [&](const std::string& table, const std::vector<std::pair<std::string, Cell>>& row) {
      std::string names, places;
      for (const auto& [name, cell] : row) {
        names += (names.empty() ? "" : ", ") + sql_name(name);
        places += places.empty() ? "?" : ", ?";
      }
      Statement statement = database_->prepare(fmt::format("INSERT INTO {} ({}) VALUES ({})", table, names, places));
      for (std::size_t i = 0; i < row.size(); ++i) statement.bind(static_cast<int>(i) + 1, row[i].second);
      statement.step();
    };
    insert("run", cells);
    std::vector<std::pair<std::string, Cell>> timing = {{"run", cell_of(head.run)}};
    timing.insert(timing.end(), answer.timing.begin(), answer.timing.end());
    insert("timing", timing);
  });
}

std::vector<std::string> Index::measure_columns() {
  std::vector<std::string> fixed = head_columns(layout_), measures;
  for (const IndexColumn& c : layout_.figures) fixed.push_back(c.name);
  for (const std::string& name : database_->columns("run"))
    if (std::find(fixed.begin(), fixed.end(), name) == fixed.end()) measures.push_back(name);
  std::sort(measures.begin(), measures.end());
  return measures;
}

std::string Index::unit_of(const std::string& column) {
  Statement unit = database_->prepare("SELECT unit FROM unit WHERE \"column\" = ?");
  unit.bind(1, column);
  return unit.step() ? plain_text(unit.column(0)) : "";
}

void Index::read(const std::vector<std::string>& columns, const std::function<void(const std::vector<Cell>&)>& row) {
  Statement statement = database_->prepare("SELECT " + list_of(columns) + " FROM run ORDER BY run");
  std::vector<Cell> cells(columns.size());
  while (statement.step()) {
    for (std::size_t i = 0; i < columns.size(); ++i) cells[i] = statement.column(static_cast<int>(i));
    row(cells);
  }
}

std::string Index::table_csv(const std::string& table, const std::vector<std::string>& columns) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) text += (i == 0 ? "" : ",") + csv_field(columns[i]);
  text += "\n";
  Statement statement = database_->prepare("SELECT " + list_of(columns) + " FROM " + table + " ORDER BY run");
  while (statement.step()) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      text += (i == 0 ? "" : ",") + csv_field(statement.column(static_cast<int>(i)));
    text += "\n";
  }
  return text;
}

/// Measures got their columns as runs brought them, in an order that hangs on jobs and shards.
void Index::put_in_order() {
  const std::vector<std::string> measures = measure_columns(), there = database_->columns("run");
  if (std::equal(measures.begin(), measures.end(), there.end() - static_cast<std::ptrdiff_t>(measures.size()))) return;
  const std::string all = list_of(there);
  database_->transaction([&] {
    make_run_table("run in order");
    for (const std::string& name : measures) add_measure_column(*database_, "run in order", name);
    database_->run(
        fmt::format("INSERT INTO {0} ({1}) SELECT {1} FROM run ORDER BY run", sql_name("run in order"), all));
    database_->run("DROP TABLE run");
    database_->run(fmt::format("ALTER TABLE {} RENAME TO {}", sql_name("run in order"), sql_name("run")));
  });
}

void Index::write_csv(const std::string& folder) {
  put_in_order();
  std::vector<std::string> columns = head_columns(layout_);
  for (const auto& more : {measure_columns(), figure_columns(layout_)})
    columns.insert(columns.end(), more.begin(), more.end());
  const auto write = [&](const std::string& name, const std::string& content) {
    Replacement file(folder + "/" + name, ".part");
    file.write(content);
    file.commit();
  };
  write("index.csv", table_csv("run", columns));
  write("timing.csv", table_csv("timing", database_->columns("timing")));
  database_->settle();
}

std::uint64_t Index::count(const std::string& status) {
  Statement statement = database_->prepare("SELECT count(*) FROM run WHERE status = ?");
  statement.bind(1, status);
  statement.step();
  return static_cast<std::uint64_t>(std::get<std::int64_t>(statement.column(0)));
}

std::uint64_t Index::count_unanswered(const std::string& status) {
  Statement statement = database_->prepare(
      "SELECT count(*) FROM timing JOIN run USING (run) WHERE answered = 0 AND (?1 = '' OR status = ?1)");
  statement.bind(1, status);
  statement.step();
  return static_cast<std::uint64_t>(std::get<std::int64_t>(statement.column(0)));
}

void Index::forget_unanswered() {
  database_->transaction([&] {
    database_->run("DELETE FROM run WHERE run IN (SELECT run FROM timing WHERE answered = 0)");
    database_->run("DELETE FROM timing WHERE answered = 0");
  });
}

void Index::count_timing_by(const std::vector<std::string>& columns,
                            const std::function<void(const std::vector<Cell>&, std::uint64_t)>& each) {
  const std::string list = list_of(columns);
  Statement statement =
      database_->prepare(fmt::format("SELECT {0}, count(*) FROM timing GROUP BY {0} ORDER BY min(run)", list));
  while (statement.step()) {
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < columns.size(); ++i) cells.push_back(statement.column(static_cast<int>(i)));
    const Cell count = statement.column(static_cast<int>(columns.size()));
    each(cells, static_cast<std::uint64_t>(std::get<std::int64_t>(count)));
  }
}

std::uint64_t Index::count_without_run_file(bool of_done) {
  return static_cast<std::uint64_t>(std::get<std::int64_t>(database_->value(
      fmt::format("SELECT count(*) FROM run WHERE ifnull(run_file, '') = '' AND status IN ('diverged'{})",
                  of_done ? ", 'done'" : ""))));
}

void Index::take_over(const std::string& path) {
  Index other(path, Database::Access::read);
  other.layout_ = layout_;
  other.check_tables();
  const std::vector<std::string> measures = other.measure_columns();
  std::vector<std::pair<std::string, std::string>> units;
  for (const std::string& name : measures) units.emplace_back(name, other.unit_of(name));
  const std::vector<std::string> run = other.database_->columns("run"), timing = other.database_->columns("timing");
  Answer inputs;
  Statement names = other.database_->prepare("SELECT name, sha256 FROM input");
  while (names.step()) inputs.inputs[plain_text(names.column(0))] = plain_text(names.column(1));
  Statement attach = database_->prepare("ATTACH ? AS shard");
  attach.bind(1, uri_to_read(path));
  attach.step();
  database_->transaction([&] {
    add_inputs(inputs);
    for (const auto& [name, unit] : units) (void)column_of({.name = name, .value = 0, .unit = unit});
    for (const auto& [table, columns] : {std::pair{std::string("run"), run}, std::pair{std::string("timing"), timing}})
      database_->run(fmt::format("INSERT INTO {0} ({1}) SELECT {1} FROM shard.{0}", table, list_of(columns)));
  });
  database_->run("DETACH shard");
}

}  // namespace verisim::batch

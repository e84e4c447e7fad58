#include "engine/cli/stability_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/json.hpp"
#include "engine/base/text_table.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/output_place.hpp"
#include "engine/session/recorded_run.hpp"
#include "engine/stability/map_picture.hpp"
#include "engine/stability/maps.hpp"

namespace verisim::cli {
namespace {

using stability::Figure;
using stability::MapDescription;
using stability::Row;
using stability::RowKind;

std::string shortened(const std::string& text, std::size_t length) {
  return text.size() <= length ? text : text.substr(0, length - 3) + "...";
}

std::string short_number(const Row& row, const std::string& name) {
  const auto figure = row.figure(name);
  return figure && std::isfinite(*figure) ? fmt::format("{:.4g}", *figure) : "";
}

std::string percent(const Row& row, const std::string& name) {
  const auto figure = row.figure(name);
  return figure && std::isfinite(*figure) ? fmt::format("{:.2f} %", 100 * *figure) : "";
}

std::string bounds_table(const std::vector<StabilityRow>& rows, const std::string& map) {
  TextTable table({"bound", "found", "theory", "difference", "promised", "why"}, "<>>>><");
  bool any = false;
  for (const auto& [task, row, cpu_s] : rows) {
    if (task.kind != RowKind::bound || task.map != map) continue;
    any = true;
    table.add({row.what, short_number(row, "found"), short_number(row, "theory"), percent(row, "difference"),
               percent(row, "tolerance"), row.why});
  }
  return any ? table.text() : "";
}

std::string cells_line(const std::vector<StabilityRow>& rows, const std::string& map) {
  std::map<std::string_view, int> outcomes;
  int cells = 0, held = 0;
  for (const auto& [task, row, cpu_s] : rows) {
    if (task.kind != RowKind::cell || task.map != map) continue;
    ++cells;
    held += row.holds ? 1 : 0;
    ++outcomes[name_of(row.outcome)];
  }
  if (cells == 0) return "";
  std::string line = fmt::format("  {} cells:", cells);
  for (const auto& [name, count] : outcomes) line += fmt::format(" {} {},", count, name);
  return line + fmt::format(" {} as theory says\n", held);
}

/// The first figures, which the law is about.
std::string measured(const Row& row) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, row.figures.size()); ++i)
    text += fmt::format("{}{} {:.2g} {}", i > 0 ? ", " : "", row.figures[i].name, row.figures[i].value,
                        row.figures[i].unit);
  return text;
}

std::string extremes_table(const std::vector<StabilityRow>& rows) {
  TextTable table({"extreme", "outcome", "held", "measured", "cpu s", "why"}, "<<<<><");
  bool any = false;
  for (const auto& [task, row, cpu_s] : rows) {
    if (task.kind != RowKind::extreme) continue;
    any = true;
    table.add({row.what, std::string(name_of(row.outcome)), row.holds ? "yes" : "no", measured(row),
               fmt::format("{:.1f}", cpu_s), shortened(row.why, 60)});
  }
  return any ? "extremes, judged by conservation laws and closed forms\n" + table.text() : "";
}

std::string ledgers_table(const std::vector<StabilityRow>& rows) {
  TextTable table({"scenario", "frames", "hand put in", "dissipated", "contacts took", "recomputed", "created",
                   "closing error", "held", "why"},
                  "<>>>>>>><<");
  bool any = false;
  for (const auto& [task, row, cpu_s] : rows) {
    if (task.kind != RowKind::ledger) continue;
    any = true;
    table.add({row.what, short_number(row, "frames"), short_number(row, "input"), short_number(row, "dissipated"),
               short_number(row, "contact"), short_number(row, "contact_recomputed"), short_number(row, "created"),
               short_number(row, "closing_error"), row.holds ? "yes" : "no", shortened(row.why, 60)});
  }
  return any ? "passivity ledgers, J\n" + table.text() : "";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// How each file begins, by its suffix.
constexpr const char* kJsonBegins = "{\"format\":\"verisim-stability\",";
constexpr const char* kCsvBegins = "map,kind,what,outcome,theory,holds,why";
constexpr const char* kSvgBegins = "<svg ";

/// A column for every figure that any of the rows has.
std::string csv_of(const std::vector<StabilityRow>& rows, const std::vector<RowKind>& kinds) {
  std::vector<std::string> names;
  std::vector<const StabilityRow*> wanted;
  for (const StabilityRow& of : rows) {
    if (std::find(kinds.begin(), kinds.end(), of.task.kind) == kinds.end()) continue;
    wanted.push_back(&of);
    for (const Figure& figure : of.row.figures)
      if (std::find(names.begin(), names.end(), figure.name) == names.end()) names.push_back(figure.name);
  }
  std::string csv = kCsvBegins;
  for (const std::string& name : names)  // what theory says is a word, and of bounds a figure, too
    csv += "," + (name == "theory" ? std::string("theory_value") : name);
  csv += "\n";
  for (const StabilityRow* of : wanted) {
    const Row& row = of->row;
    csv += fmt::format("{},{},{},{},{},{},{}", of->task.map, of->task.kind == RowKind::cell ? "cell" : "row",
                       quoted(row.what), name_of(row.outcome), quoted(row.theory), row.holds ? 1 : 0, quoted(row.why));
    for (const std::string& name : names) {
      const auto figure = row.figure(name);
      csv += figure ? fmt::format(",{}", *figure) : ",";
    }
    csv += "\n";
  }
  return csv;
}

std::string place_of(const std::string& folder, const std::string& name, bool force) {
  const char* beginning = name.ends_with(".json") ? kJsonBegins : name.ends_with(".csv") ? kCsvBegins : kSvgBegins;
  return check_output({folder + "/" + name, OutputKind::text, force, beginning});
}

void write_file(const std::string& path, const std::string& content) {
  Replacement file(path, ".part");
  file.write(content);
  file.commit();
}

}  // namespace

Json json_of(const Row& row) {
  Json j = {{"what", row.what}, {"outcome", name_of(row.outcome)}, {"theory", row.theory}, {"holds", row.holds}};
  if (!row.why.empty()) j["why"] = row.why;
  for (const Figure& figure : row.figures) {
    const bool finite = std::isfinite(figure.value);
    j["figures"][figure.name] = {{"value", finite ? Json(figure.value) : Json()}, {"unit", figure.unit}};
  }
  return j;
}

Row row_of(const Json& j) {
  Row row;
  row.what = j.at("what");
  const std::string outcome = j.at("outcome");
  for (std::size_t i = 0; i < stability::kOutcomeNames.size(); ++i)
    if (stability::kOutcomeNames[i] == outcome) row.outcome = static_cast<stability::Outcome>(i);
  row.theory = j.at("theory");
  row.holds = j.at("holds");
  row.why = j.value("why", "");
  if (!j.contains("figures")) return row;
  for (const auto& [name, figure] : j.at("figures").items()) {
    const Json& value = figure.at("value");
    row.figures.push_back({name, figure.at("unit"), value.is_null() ? std::nan("") : value.get<double>()});
  }
  return row;
}

Json json_of(const std::vector<StabilityRow>& rows) {
  Json j = {{"definitions", stability::definitions()},
            {"maps", Json::array()},
            {"extremes", Json::array()},
            {"ledgers", Json::array()}};
  for (const auto& [task, row, cpu_s] : rows) {
    Json one = json_of(row);
    if (task.kind == RowKind::extreme || task.kind == RowKind::ledger) {
      j[task.kind == RowKind::extreme ? "extremes" : "ledgers"].push_back(std::move(one));
      continue;
    }
    one["map"] = task.map;
    one["kind"] = task.kind == RowKind::cell ? "cell" : "bound";
    j["maps"].push_back(std::move(one));
  }
  j["failed"] = broken_promises(rows);
  return j;
}

std::string tables_of(const std::vector<StabilityRow>& rows) {
  std::string text;
  for (const MapDescription& map : stability::map_descriptions()) {
    const std::string cells = cells_line(rows, map.name), bounds = bounds_table(rows, map.name);
    if (!cells.empty() || !bounds.empty()) text += fmt::format("{}: {}\n{}{}", map.title, map.theory, cells, bounds);
  }
  text += extremes_table(rows) + ledgers_table(rows);
  for (const std::string_view definition : stability::definitions()) text += fmt::format("  {}\n", definition);
  const std::vector<std::string> broken = broken_promises(rows);
  for (const std::string& row : broken) text += fmt::format("does not hold: {}\n", row);
  return text;
}

std::vector<std::string> broken_promises(const std::vector<StabilityRow>& rows) {
  std::vector<std::string> broken;
  for (const auto& [task, row, cpu_s] : rows)
    if (task.kind == RowKind::extreme ? row.is_silent() || row.outcome == stability::Outcome::refused : !row.holds)
      broken.push_back(row.what);
  return broken;
}

void check_folder(const std::string& folder, bool force) {
  make_folder_of(folder + "/any", folder);
  for (const char* name : {"stability.json", "maps.csv", "extremes.csv", "ledgers.csv"})
    (void)place_of(folder, name, force);
  for (const MapDescription& map : stability::map_descriptions()) (void)place_of(folder, map.name + ".svg", force);
}

void write_folder(const std::string& folder, bool force, const std::vector<StabilityRow>& rows) {
  const auto write = [&](const std::string& name, const std::string& content) {
    write_file(place_of(folder, name, force), content);
  };
  write("stability.json", fmt::format("{}\n{}\n", kJsonBegins, json_text(json_of(rows)).substr(1)));
  write("maps.csv", csv_of(rows, {RowKind::cell, RowKind::bound}));
  write("extremes.csv", csv_of(rows, {RowKind::extreme}));
  write("ledgers.csv", csv_of(rows, {RowKind::ledger}));
  for (const MapDescription& map : stability::map_descriptions()) {
    std::vector<Row> cells;
    for (const auto& [task, row, cpu_s] : rows)
      if (task.kind == RowKind::cell && task.map == map.name && !row.figures.empty()) cells.push_back(row);
    if (!cells.empty()) write(map.name + ".svg", stability::picture_of(map, cells));
  }
}

}  // namespace verisim::cli

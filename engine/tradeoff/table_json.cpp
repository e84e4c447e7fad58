// tradeoff.json and tradeoff.csv.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/tradeoff/table.hpp"

namespace verisim::tradeoff {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFormat = "verisim-tradeoff";

ordered_json json_of(const Interval& interval) {
  return {{"median", interval.median}, {"low", interval.low}, {"high", interval.high}, {"most", interval.most}};
}

Interval interval_from(const ordered_json& json) {
  const Interval interval{json.at("median"), json.at("low"), json.at("high"), json.at("most")};
  for (const double value : {interval.median, interval.low, interval.high, interval.most})
    if (!std::isfinite(value) || value < 0) throw std::invalid_argument("a time that is none");
  return interval;
}

ordered_json json_of(const std::map<std::string, ordered_json>& parameters) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : parameters) json[name] = value;
  return json;
}

const ordered_json& object(const ordered_json& json) {
  if (!json.is_object()) throw std::invalid_argument("what has to be an object is none");
  return json;
}

std::map<std::string, ordered_json> parameters_from(const ordered_json& json) {
  std::map<std::string, ordered_json> parameters;
  for (const auto& [name, value] : object(json).items()) parameters[name] = value;
  return parameters;
}

ordered_json json_of(const Row& row) {
  ordered_json json = {{"parameters", json_of(row.parameters)}};
  if (!row.failed.empty()) {
    json["failed"] = row.failed;
    return json;
  }
  json["time_us"] = json_of(row.time_us);
  json["frame_us"] = json_of(row.frame_us);
  json["cost"] = ordered_json::object();
  for (const auto& [counter, total] : row.cost) json["cost"][counter] = total;
  json["frames"] = row.frames;
  json["step_s"] = row.step_s;
  json["load"] = row.load();
  json["mean_us"] = row.mean_us;
  json["work_us"] = row.work_us;
  json["errors"] = ordered_json::object();
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    const std::optional<Spread>& error = row.errors[i];
    json["errors"][kKinds[i].name] =
        error ? ordered_json{{"median", error->median}, {"most", error->most}, {"unit", kKinds[i].unit}}
              : ordered_json();
  }
  json["trials"] = ordered_json::array();
  for (const TrialFigures& trial : row.trials) {
    ordered_json figures = {{"seed", trial.seed}, {"time_us", trial.time_us}};
    for (std::size_t i = 0; i < kKinds.size(); ++i)
      figures[kKinds[i].name] = trial.errors[i] ? ordered_json(*trial.errors[i]) : ordered_json();
    json["trials"].push_back(std::move(figures));
  }
  json["dominated"] = row.dominated ? ordered_json(*row.dominated) : ordered_json(false);
  return json;
}

Row row_from(const ordered_json& json) {
  Row row;
  row.parameters = parameters_from(json.at("parameters"));
  if (json.contains("failed")) {
    row.failed = json.at("failed").get<std::string>();
    if (row.failed.empty()) row.failed = "failed";
    return row;
  }
  row.time_us = interval_from(json.at("time_us"));
  row.frame_us = interval_from(json.at("frame_us"));
  for (const auto& [counter, total] : object(json.at("cost")).items())
    row.cost.emplace_back(counter, total.get<std::uint64_t>());
  row.frames = json.at("frames");
  row.step_s = json.at("step_s");
  if (!(row.step_s > 0) || !std::isfinite(row.step_s)) throw std::invalid_argument("a step that is none");
  row.mean_us = json.at("mean_us");
  row.work_us = json.at("work_us");
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    const ordered_json& error = json.at("errors").at(kKinds[i].name);
    if (error.is_null()) continue;
    row.errors[i] = Spread{error.at("median"), error.at("most")};
    if (!std::isfinite(row.errors[i]->most) || row.errors[i]->most < 0)
      throw std::invalid_argument("an error that is none");
  }
  return row;
}

/// "_Nm" of "N m"; nothing of a plain number.
std::string unit_suffix(const std::string& unit) {
  if (unit == "1") return "";
  std::string suffix = "_";
  for (const char c : unit)
    if (c != ' ') suffix += c;
  return suffix;
}

std::string csv_text(const ordered_json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

ordered_json json_of(const Table& table) {
  ordered_json json = {{"format", kFormat},
                       {"format_version", 1},
                       {"version", table.version},
                       {"commit", table.commit},
                       {"scenario", table.scenario},
                       {"scenario_sha256", table.scenario_sha256},
                       {"machine", {{"cpu", table.cpu}, {"compiler", table.compiler}}},
                       {"seed", table.seed},
                       {"repeat", table.repeat},
                       {"duration", table.duration ? ordered_json(*table.duration) : ordered_json()},
                       {"fixed", json_of(table.fixed)},
                       {"truth", table.truth},
                       {"convergence", ordered_json::parse(table.convergence_json)},
                       {"by", kKinds[index_of(table.by)].name},
                       {"notes", table.notes},
                       {"rows", ordered_json::array()}};
  for (const Row& row : table.rows) json["rows"].push_back(json_of(row));
  json["front"] = front_of(table.rows, table.by);
  if (!table.peers_json.empty()) json["peers"] = ordered_json::parse(table.peers_json);
  return json;
}

Table table_from(const std::string& name, const std::string& text) {
  Table table;
  try {
    const ordered_json json = ordered_json::parse(text);
    if (json.at("format") != kFormat) throw std::invalid_argument("another format");
    if (json.at("format_version") != 1) throw std::invalid_argument("another version of the format");
    table.version = json.at("version");
    table.commit = json.at("commit");
    table.scenario = json.at("scenario");
    table.scenario_sha256 = json.at("scenario_sha256");
    table.cpu = json.at("machine").at("cpu");
    table.compiler = json.at("machine").at("compiler");
    table.seed = json.at("seed");
    table.repeat = json.at("repeat");
    if (!json.at("duration").is_null()) table.duration = json.at("duration").get<double>();
    table.fixed = parameters_from(json.at("fixed"));
    table.truth = json.at("truth");
    table.convergence_json = json.at("convergence").dump();
    const std::string by = json.at("by");
    const auto* const kind =
        std::find_if(kKinds.begin(), kKinds.end(), [&](const ErrorKindInfo& k) { return by == k.name; });
    if (kind == kKinds.end()) throw std::invalid_argument("a front by an error that is none");
    table.by = static_cast<Kind>(kind - kKinds.begin());
    for (const ordered_json& row : json.at("rows")) table.rows.push_back(row_from(row));
  } catch (const std::exception& error) {
    fail(ErrorKind::input, "{}: is no table of 'verisim tradeoff' ({}); make it with verisim tradeoff -o FOLDER", name,
         shown(error.what(), 120));
  }
  find_dominated(table.rows, table.by);
  return table;
}

std::string csv_of(const Table& table) {
  std::string csv;
  const std::map<std::string, ordered_json> none;
  const auto& dials = table.rows.empty() ? none : table.rows.front().parameters;
  csv = "setting";
  for (const auto& [name, value] : dials) csv += "," + csv_text(name);
  csv += ",time_us,time_us_low,time_us_high,time_us_most,frame_us,load_us_per_ms,mean_us,work_us";
  for (const ErrorKindInfo& kind : kKinds)
    csv += fmt::format(",{0}_median{1},{0}_most{1}", kind.name, unit_suffix(kind.unit));
  csv += ",dominated,failed\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Row& row = table.rows[i];
    csv += fmt::format("{}", i);
    for (const auto& [name, value] : row.parameters) csv += "," + csv_text(value);
    const bool fine = row.failed.empty();
    csv += fine ? fmt::format(",{},{},{},{},{},{},{},{}", row.time_us.median, row.time_us.low, row.time_us.high,
                              row.time_us.most, row.frame_us.median, row.load(), row.mean_us, row.work_us)
                : ",,,,,,,,";
    for (const std::optional<Spread>& error : row.errors)
      csv += error && fine ? fmt::format(",{},{}", error->median, error->most) : ",,";
    csv +=
        "," + (row.dominated ? fmt::format("{}", *row.dominated) : std::string()) + "," + csv_text(row.failed) + "\n";
  }
  return csv;
}

}  // namespace verisim::tradeoff

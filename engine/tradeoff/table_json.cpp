// tradeoff.json and tradeoff.csv.
#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/tradeoff/json_member.hpp"
#include "engine/tradeoff/table.hpp"

namespace verisim::tradeoff {
namespace {

constexpr const char* kFormat = "verisim-tradeoff";

Json json_of(const Interval& interval) {
  return {{"median", interval.median}, {"low", interval.low}, {"high", interval.high}, {"most", interval.most}};
}

Interval interval_from(const JsonMember& json) {
  return {json.at("median").number_from_0(), json.at("low").number_from_0(), json.at("high").number_from_0(),
          json.at("most").number_from_0()};
}

Json json_of(const std::map<std::string, Json>& parameters) {
  Json json = Json::object();
  for (const auto& [name, value] : parameters) json[name] = value;
  return json;
}

std::map<std::string, Json> parameters_from(const JsonMember& json) {
  std::map<std::string, Json> parameters;
  (void)json.members();
  for (const auto& [name, value] : json.json().items()) parameters[name] = value;
  return parameters;
}

Json json_of(const Row& row) {
  Json json = {{"parameters", json_of(row.parameters)}};
  if (!row.failed.empty()) {
    json["failed"] = row.failed;
    return json;
  }
  json["time_us"] = json_of(row.time_us);
  json["frame_us"] = json_of(row.frame_us);
  json["cost"] = Json::object();
  for (const auto& [counter, total] : row.cost) json["cost"][counter] = total;
  json["frames"] = row.frames;
  json["step_s"] = row.step_s;
  json["load"] = row.load();
  json["mean_us"] = row.mean_us;
  json["work_us"] = row.work_us;
  json["errors"] = Json::object();
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    const std::optional<Spread>& error = row.errors[i];
    json["errors"][kKinds[i].name] =
        error ? Json{{"median", error->median}, {"most", error->most}, {"unit", kKinds[i].unit}} : Json();
  }
  json["trials"] = Json::array();
  for (const TrialFigures& trial : row.trials) {
    Json figures = {{"seed", trial.seed}, {"time_us", trial.time_us}};
    for (std::size_t i = 0; i < kKinds.size(); ++i)
      figures[kKinds[i].name] = trial.errors[i] ? Json(*trial.errors[i]) : Json();
    json["trials"].push_back(std::move(figures));
  }
  json["dominated"] = row.dominated ? Json(*row.dominated) : Json(false);
  return json;
}

Row row_from(const JsonMember& json) {
  Row row;
  row.parameters = parameters_from(json.at("parameters"));
  if (json.has("failed")) {
    row.failed = json.at("failed").text();
    if (row.failed.empty()) row.failed = "failed";
    return row;
  }
  row.time_us = interval_from(json.at("time_us"));
  row.frame_us = interval_from(json.at("frame_us"));
  const JsonMember cost = json.at("cost");
  (void)cost.members();
  for (const auto& [counter, total] : cost.json().items()) row.cost.emplace_back(counter, cost.at(counter).count());
  row.frames = json.at("frames").count();
  row.step_s = json.at("step_s").number();
  if (!(row.step_s > 0)) throw JsonFault("a step is not above 0");
  row.mean_us = json.at("mean_us").number();
  row.work_us = json.at("work_us").number();
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    const JsonMember error = json.at("errors").at(kKinds[i].name);
    if (!error.is_null()) row.errors[i] = Spread{error.at("median").number_from_0(), error.at("most").number_from_0()};
  }
  return row;
}

Kind kind_from(const JsonMember& json) {
  const std::string by = json.text();
  const auto* const kind =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const ErrorKindInfo& k) { return by == k.name; });
  if (kind == kKinds.end()) throw JsonFault("by names no kind of error");
  return static_cast<Kind>(kind - kKinds.begin());
}

Json parsed(const std::string& text) {
  try {
    return parse_json(text);
  } catch (const Json::parse_error& error) {
    throw JsonFault(fmt::format("line {} is no JSON, or the file ends in it", line_of_byte(text, error.byte)));
  }
}

Table table_from(const JsonMember& json) {
  Table table;
  if (json.at("format").text() != kFormat) throw JsonFault("format is another");
  if (json.at("format_version").count() != 1) throw JsonFault("format_version is another");
  table.version = json.at("version").text();
  table.commit = json.at("commit").text();
  table.scenario = json.at("scenario").text();
  table.scenario_sha256 = json.at("scenario_sha256").text();
  table.cpu = json.at("machine").at("cpu").text();
  table.compiler = json.at("machine").at("compiler").text();
  table.seed = json.at("seed").count();
  table.repeat = json.at("repeat").count();
  if (!json.at("duration").is_null()) table.duration = json.at("duration").number();
  table.fixed = parameters_from(json.at("fixed"));
  table.truth = json.at("truth").text();
  table.convergence_json = json_text(json.at("convergence").json());
  table.by = kind_from(json.at("by"));
  for (const JsonMember& row : json.at("rows").elements()) table.rows.push_back(row_from(row));
  return table;
}

/// "_Nm" of "N m"; nothing of a plain number.
std::string unit_suffix(const std::string& unit) {
  if (unit == "1") return "";
  std::string suffix = "_";
  for (const char c : unit)
    if (c != ' ') suffix += c;
  return suffix;
}

std::string csv_text(const Json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

Json json_of(const Table& table) {
  Json json = {{"format", kFormat},
               {"format_version", 1},
               {"version", table.version},
               {"commit", table.commit},
               {"scenario", table.scenario},
               {"scenario_sha256", table.scenario_sha256},
               {"machine", {{"cpu", table.cpu}, {"compiler", table.compiler}}},
               {"seed", table.seed},
               {"repeat", table.repeat},
               {"coverage", coverage_of(table.repeat)},
               {"duration", table.duration ? Json(*table.duration) : Json()},
               {"fixed", json_of(table.fixed)},
               {"truth", table.truth},
               {"convergence", parse_json(table.convergence_json)},
               {"by", kKinds[index_of(table.by)].name},
               {"notes", table.notes},
               {"rows", Json::array()}};
  for (const Row& row : table.rows) json["rows"].push_back(json_of(row));
  json["front"] = front_of(table.rows, table.by);
  if (!table.peers_json.empty()) json["peers"] = parse_json(table.peers_json);
  return json;
}

Table table_from(const std::string& name, const std::string& text) {
  try {
    const Json json = parsed(text);
    Table table = table_from(JsonMember(json, ""));
    find_dominated(table.rows, table.by);
    return table;
  } catch (const JsonFault& fault) {
    fail(ErrorKind::input, "{}: is no table of 'verisim tradeoff': {}; make it with verisim tradeoff -o FOLDER", name,
         shown(fault.what(), 120));
  }
}

std::string csv_of(const Table& table) {
  std::string csv;
  const std::map<std::string, Json> none;
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

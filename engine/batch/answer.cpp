#include "engine/batch/answer.hpp"

#include <nlohmann/json.hpp>

namespace verisim::batch {

using nlohmann::ordered_json;

namespace {

ordered_json cells_json(const std::map<std::string, Cell>& cells) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, cell] : cells) json[name] = json_of(cell);
  return json;
}

std::map<std::string, Cell> cells_of(const ordered_json& json) {
  std::map<std::string, Cell> cells;
  for (const auto& [name, value] : json.items()) cells[name] = cell_of(value);
  return cells;
}

}  // namespace

std::string to_text(const Answer& answer) {
  ordered_json json = {{"status", answer.status},
                       {"error", answer.error},
                       {"answered", answer.answered},
                       {"figures", cells_json(answer.figures)},
                       {"timing", cells_json(answer.timing)},
                       {"parameters", cells_json(answer.parameters)},
                       {"measures", ordered_json::array()},
                       {"inputs", answer.inputs}};
  for (const Measure& measure : answer.measures)
    json["measures"].push_back({{"name", measure.name}, {"value", measure.value}, {"unit", measure.unit}});
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

Answer answer_of(const std::string& text) {
  const ordered_json json = ordered_json::parse(text);
  Answer answer{.status = json.at("status"),
                .error = json.at("error"),
                .answered = json.at("answered"),
                .figures = cells_of(json.at("figures")),
                .timing = cells_of(json.at("timing")),
                .parameters = cells_of(json.at("parameters")),
                .measures = {},
                .inputs = json.at("inputs")};
  for (const ordered_json& measure : json.at("measures"))
    answer.measures.push_back({measure.at("name"), measure.at("value"), measure.at("unit")});
  return answer;
}

}  // namespace verisim::batch

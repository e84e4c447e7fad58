#include "engine/batch/answer.hpp"
#include "engine/base/json.hpp"

namespace verisim::batch {

namespace {

Json cells_json(const std::map<std::string, Cell>& cells) {
  Json json = Json::object();
  for (const auto& [name, cell] : cells) json[name] = json_of(cell);
  return json;
}

std::map<std::string, Cell> cells_of(const Json& json) {
  std::map<std::string, Cell> cells;
  for (const auto& [name, value] : json.items()) cells[name] = cell_of(value);
  return cells;
}

}  // namespace

std::string to_text(const Answer& answer) {
  Json json = {{"status", answer.status},
               {"error", answer.error},
               {"answered", answer.answered},
               {"figures", cells_json(answer.figures)},
               {"timing", cells_json(answer.timing)},
               {"parameters", cells_json(answer.parameters)},
               {"measures", Json::array()},
               {"inputs", answer.inputs}};
  for (const Measure& measure : answer.measures)
    json["measures"].push_back({{"name", measure.name}, {"value", measure.value}, {"unit", measure.unit}});
  return json_text(json);
}

Answer answer_of(const std::string& text) {
  const Json json = parse_json(text);
  Answer answer{.status = json.at("status"),
                .error = json.at("error"),
                .answered = json.at("answered"),
                .figures = cells_of(json.at("figures")),
                .timing = cells_of(json.at("timing")),
                .parameters = cells_of(json.at("parameters")),
                .measures = {},
                .inputs = json.at("inputs")};
  for (const Json& measure : json.at("measures"))
    answer.measures.push_back({measure.at("name"), measure.at("value"), measure.at("unit")});
  return answer;
}

}  // namespace verisim::batch

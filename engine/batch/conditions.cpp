#include "engine/batch/conditions.hpp"
#include "engine/base/json.hpp"

namespace verisim::batch {

std::vector<IndexColumn> condition_columns() {
  return {{"jobs", "INTEGER", "1", "runs at the same time in the call that computed this one"},
          {"threads", "INTEGER", "1", "threads of the run"},
          {"cores", "INTEGER", "1", "cores that the batch could use"},
          {"recorded", "INTEGER", "1", "1: a run file was written"},
          {"simd", "TEXT", "", "SIMD target"},
          {"cpu", "TEXT", "", "the processor, as the system names it"},
          {"cache", "TEXT", "",
           "prepared parts: warm (all were there), cold (none), partly, unused (none were needed), off (--no-cache)"}};
}

void add_conditions(Answer& answer, const Conditions& conditions) {
  answer.timing["jobs"] = std::int64_t{conditions.jobs};
  answer.timing["threads"] = std::int64_t{conditions.threads};
  answer.timing["cores"] = std::int64_t{conditions.cores};
  answer.timing["recorded"] = std::int64_t{conditions.recorded ? 1 : 0};
  answer.timing["simd"] = conditions.simd;
  answer.timing["cpu"] = conditions.cpu;
}

Json conditions_json(Index& index) {
  std::vector<std::string> names;
  for (const IndexColumn& column : condition_columns()) names.push_back(column.name);
  Json json = Json::array();
  index.count_timing_by(names, [&](const std::vector<Cell>& cells, std::uint64_t runs) {
    Json one;
    for (std::size_t i = 0; i < names.size(); ++i) one[names[i]] = json_of(cells[i]);
    one["runs"] = runs;
    json.push_back(std::move(one));
  });
  return json;
}

}  // namespace verisim::batch

#include "engine/batch/design.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.hpp"

namespace verisim::batch {

std::vector<std::string> Design::group_keys() const {
  std::vector<std::string> all;
  if (table) all = table->keys;
  for (const Axis& axis : axes) all.push_back(axis.key);
  return all;
}

std::vector<std::string> Design::keys() const {
  std::vector<std::string> all = group_keys();
  for (const Draw& draw : draws) all.push_back(draw.key);
  return all;
}

std::uint64_t Design::runs() const {
  std::uint64_t count = (table ? table->rows.size() : 1) * draw_count * repeat;
  for (const Axis& axis : axes) count *= axis.values.size();
  return count;
}

std::uint64_t Design::runs_of_shard() const {
  const std::uint64_t all = runs();
  return all / shard.of + (all % shard.of >= shard.index ? 1 : 0);
}

Point Design::point(std::uint64_t run) const {
  VERISIM_ASSERT(run < runs());
  Point point{.run = run, .seed = 0, .values = {}};
  const std::uint64_t repetition = run % (draw_count * repeat);  // a draw is a repetition, too: it has its own seed
  std::uint64_t rest = run / (draw_count * repeat);
  for (std::size_t i = axes.size(); i-- > 0;) {
    point.values.insert(point.values.begin(), axes[i].values[rest % axes[i].values.size()]);
    rest /= axes[i].values.size();
  }
  point.seed = seed_of_repetition(seed, repetition);
  if (table) {
    point.values.insert(point.values.begin(), table->rows[rest].begin(), table->rows[rest].end());
    if (!table->seeds.empty()) point.seed = table->seeds[rest];
  }
  for (const Draw& draw : draws) {
    const double value = drawn(draw.distribution, seed, draw.key, repetition / repeat);
    point.values.push_back({fmt::format("{}", value), value});
  }
  return point;
}

Json to_json(const Design& design) {
  Json json = {{"vary", Json::array()}};
  for (const Axis& axis : design.axes) {
    Json values = Json::array();
    for (const Value& value : axis.values) values.push_back(json_of(value.cell));
    json["vary"].push_back({{"parameter", axis.key}, {"values", values}});
  }
  if (design.table) {
    Json rows = Json::array();
    for (const auto& row : design.table->rows) {
      Json cells = Json::array();
      for (const Value& value : row) cells.push_back(json_of(value.cell));
      rows.push_back(std::move(cells));
    }
    json["table"] = {{"parameters", design.table->keys}, {"rows", rows}, {"seeds", design.table->seeds}};
  }
  if (!design.draws.empty()) {
    json["random"] = {{"draws", design.draw_count}, {"parameters", Json::array()}};
    for (const Draw& draw : design.draws) {
      const bool normal = draw.distribution.kind == Distribution::Kind::normal;
      json["random"]["parameters"].push_back({{"parameter", draw.key},
                                              {"distribution", normal ? "normal" : "uniform"},
                                              {normal ? "mean" : "low", draw.distribution.first},
                                              {normal ? "sd" : "high", draw.distribution.second}});
    }
  }
  json["repeat"] = design.repeat;
  return json;
}

}  // namespace verisim::batch

#include "engine/tradeoff/peers.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/text_table.hpp"

namespace verisim::tradeoff {
namespace {

/// Empty for null: there is no such figure.
std::string scaled(const Json& figure, double factor) {
  return figure.is_null() ? std::string() : fmt::format("{:.3g}", factor * figure.get<double>());
}

std::string named(const Json& row) {
  return shown(row.at("name").get<std::string>() + " " + row.at("version").get<std::string>(), 60);
}

/// Its time with the interval in front.
std::vector<std::string> begun(const Json& row, const Json& time) {
  return {named(row), scaled(time.at("median"), 1), scaled(time.at("low"), 1), scaled(time.at("high"), 1)};
}

/// Of all settings that were tried.
double least_error95(const Json& row) {
  double least = row.at("poses").at("depth_error_m").at("p95").get<double>();
  for (const Json& tried : row.at("searched").at("poses")) {
    const bool errs_as_often =
        tried.at("missed").get<double>() + tried.at("imagined").get<double>() <=
        row.at("poses").at("missed").get<double>() + row.at("poses").at("imagined").get<double>();
    if (errs_as_often) least = std::min(least, tried.at("depth_error_m").at("p95").get<double>());
  }
  return least;
}

std::string table_of_queries(const Json& peers) {
  TextTable table({"engine", "query, us", "from", "to", "99 %", "depth off, um", "95 %", "least of all", "gaps told, %",
                   "off, um, 95 %", "missed, %", "imagined, %", "best of", "setting"});
  for (const Json& row : peers) {
    if (row.contains("missing") || row.at("poses").is_null()) continue;
    const Json& p = row.at("poses");
    std::vector<std::string> cells = begun(row, p.at("query_us"));
    const Json& gap = p.at("gap_error_m");
    cells.insert(
        cells.end(),
        {scaled(p.at("query_us_p99"), 1), scaled(p.at("depth_error_m").at("p50"), 1e6),
         scaled(p.at("depth_error_m").at("p95"), 1e6), scaled(least_error95(row), 1e6), scaled(p.at("gap_told"), 100),
         gap.is_null() ? "" : scaled(gap.at("p95"), 1e6), scaled(p.at("missed"), 100), scaled(p.at("imagined"), 100),
         fmt::format("{}", row.at("searched").at("poses").size()), shown(p.at("setting").get<std::string>(), 100)});
    table.add(std::move(cells));
  }
  return table.text();
}

std::string table_of_insertions(const Json& peers) {
  TextTable table({"engine", "step, us", "from", "to", "passed", "deepest, um", "of clearance", "force off, N",
                   "best of", "setting"});
  for (const Json& row : peers) {
    if (row.contains("missing")) continue;
    const Json& i = row.at("insertion");
    std::vector<std::string> cells = begun(row, i.at("step_us"));
    cells.insert(
        cells.end(),
        {fmt::format("{} of {}", i.at("passed").get<int>(), i.at("of").get<int>()), scaled(i.at("overlap_m"), 1e6),
         scaled(i.at("overlap_of_clearance"), 1), scaled(i.at("force_error_N"), 1),
         fmt::format("{}", row.at("searched").at("insertion").size()), shown(i.at("setting").get<std::string>(), 100)});
    table.add(std::move(cells));
  }
  return table.text();
}

}  // namespace

std::string text_of_peers(const Json& peers) {
  try {
    std::size_t poses = 0, found = 0, pushed = 0;
    std::string missing;
    for (const Json& row : peers) {
      if (row.contains("missing")) {
        missing += fmt::format("{}: not there when verisim-peers was built; apt install {}, then build it again\n",
                               shown(row.at("name").get<std::string>()), shown(row.at("missing").get<std::string>()));
        continue;
      }
      if (!row.at("poses").is_null()) poses = row.at("poses").at("poses").get<std::size_t>();
      found += row.at("searched").at("poses").size();
      pushed += row.at("searched").at("insertion").size();
    }
    return fmt::format(
        "contact queries at {} poses of a pin in a hole; {} settings tried, of each engine the one that errs\n"
        "least often (misses 10 um, or imagines them), then least (95 %, in steps of 10 um), then is fastest; 'least "
        "of\n"
        "all' is the least such error of any setting:\n{}"
        "a hand that leans by half a degree and stands 1 mm beside the axis pushes a pin of 1 kg through a hole; {}\n"
        "settings tried, of each engine the one with most passes, then least overlap (in steps of a tenth of the\n"
        "clearance), then the fastest; overlap and force are of those that passed:\n{}{}"
        "times are medians with their interval over repetitions, of one machine in one run: compare them with each "
        "other\n"
        "alone. Force is that of the last 0.1 s, at rest, where it has a closed form.\n",
        poses, found, table_of_queries(peers), pushed, table_of_insertions(peers), missing);
  } catch (const Json::exception&) {  // a figure is missing or of another kind: it is not this version's
    fail(ErrorKind::input,
         "what verisim-peers said is no list of engines with the figures that this program reads; build it again: "
         "ninja -C build verisim-peers");
  }
}

}  // namespace verisim::tradeoff

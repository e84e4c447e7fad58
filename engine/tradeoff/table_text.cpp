// The table for people, and its plot.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/svg.hpp"
#include "engine/base/text.hpp"
#include "engine/base/text_table.hpp"
#include "engine/tradeoff/table.hpp"

namespace verisim::tradeoff {
namespace {

std::string plain(const Json& value) {
  return shown(value.is_string() ? value.get<std::string>() : json_text(value), 40);
}

/// Columns of the table: those of /errors that say most, and that of the front.
std::vector<Kind> columns_of(const Table& table) {
  std::vector<Kind> columns = {Kind::force,   Kind::force_max, Kind::torque, Kind::position,
                               Kind::overlap, Kind::work,      Kind::flips};
  if (std::find(columns.begin(), columns.end(), table.by) == columns.end()) columns.push_back(table.by);
  return columns;
}

struct Shown {
  const char* unit;
  double factor;
};
/// As people read it: mm, mJ, %.
Shown shown_unit(Kind kind) {
  const std::string unit = kKinds[index_of(kind)].unit;
  if (unit == "m") return {"mm", 1e3};
  if (unit == "J") return {"mJ", 1e3};
  if (unit == "1") return {"%", 1e2};
  return {kKinds[index_of(kind)].unit, 1};
}

/// Frames in a simulated millisecond.
double per_ms(const Row& row) {
  return 1e-3 / row.step_s;
}

double log10_of(double value) {
  return pinned::log(value) / pinned::log(10.0);
}

/// Decades that hold all values, at least one.
struct Decades {
  double low = 0, high = 1;
  explicit Decades(const std::vector<double>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (values.empty()) return;
    low = std::floor(log10_of(*least));
    high = std::max(low + 1, std::ceil(log10_of(*most)));
  }
  [[nodiscard]] double part(double value) const { return (log10_of(value) - low) / (high - low); }
};

}  // namespace

std::string text_of(const std::map<std::string, Json>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", shown(name, 40), plain(value));
  return text;
}

std::string text_of(const Table& table) {
  std::vector<std::string> head = {"#"};
  std::string sides = ">";
  if (!table.rows.empty())
    for (const auto& [name, value] : table.rows.front().parameters) {
      head.push_back(shown(name, 40));
      sides += value.is_number() ? '>' : '<';
    }
  head.insert(head.end(), {"frame, us", "from", "to", "us per ms"});
  sides += ">>>>";
  const std::vector<Kind> columns = columns_of(table);
  for (const Kind kind : columns) {
    head.push_back(fmt::format("{}, {}", kKinds[index_of(kind)].name, shown_unit(kind).unit));
    sides += '>';
  }
  head.emplace_back("");
  sides += '<';
  TextTable text(head, sides);
  std::string failures;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Row& row = table.rows[i];
    std::vector<std::string> cells = {fmt::format("{}", i)};
    for (const auto& [name, value] : row.parameters) cells.push_back(plain(value));
    if (!row.failed.empty()) {
      cells.resize(head.size());
      cells.back() = "failed";
      failures += fmt::format("  {}: {}\n", i, shown(row.failed, 200));
    } else {
      for (const double us : {row.time_us.median, row.time_us.low, row.time_us.high, row.load()})
        cells.push_back(fmt::format("{:.1f}", us));
      for (const Kind kind : columns) {
        const std::optional<Spread>& error = row.errors[index_of(kind)];
        cells.push_back(error ? fmt::format("{:.3g}", error->most * shown_unit(kind).factor) : "");
      }
      if (row.dominated)
        cells.push_back(fmt::format("dominated by {}", *row.dominated));
      else
        cells.emplace_back(row.errors[index_of(table.by)] ? "front" : "");
    }
    text.add(std::move(cells));
  }
  return text.text() + failures;
}

std::string plot_of(const Table& table) {
  constexpr double kLeft = 90, kTop = 40, kWidth = 460, kHeight = 300;
  std::vector<double> times, errors;
  const std::size_t by = index_of(table.by);
  for (const Row& row : table.rows)
    if (row.failed.empty() && row.errors[by] && row.errors[by]->most > 0 && row.time_us.low > 0) {
      times.insert(times.end(), {row.time_us.low * per_ms(row), row.time_us.high * per_ms(row)});
      errors.push_back(row.errors[by]->most);
    }
  const Decades across(times), up(errors);
  // An error of 0 has no logarithm: it stands at the foot.
  const auto y_of = [&](double error) {
    return kTop + kHeight * (1 - (error > 0 ? std::clamp(up.part(error), 0.0, 1.0) : 0));
  };
  const auto x_of = [&](double us) { return kLeft + kWidth * (us > 0 ? std::clamp(across.part(us), 0.0, 1.0) : 0); };
  std::string content;
  for (double power = across.low; power <= across.high; ++power) {
    const double x = kLeft + kWidth * (power - across.low) / (across.high - across.low);
    content += svg::line(x, kTop, x, kTop + kHeight, "#ddd", 1) +
               svg::text(x, kTop + kHeight + 14, "middle", fmt::format("{:g}", pinned::pow(10.0, power)));
  }
  for (double power = up.low; power <= up.high; ++power) {
    const double y = kTop + kHeight * (1 - (power - up.low) / (up.high - up.low));
    content += svg::line(kLeft, y, kLeft + kWidth, y, "#ddd", 1) +
               svg::text(kLeft - 6, y + 4, "end", fmt::format("{:g}", pinned::pow(10.0, power)));
  }
  std::vector<std::pair<double, double>> line;
  for (const std::size_t i : front_of(table.rows, table.by))
    line.emplace_back(x_of(table.rows[i].load()), y_of(table.rows[i].errors[by]->most));
  if (!line.empty()) content += svg::polyline(line, svg::colour(0));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Row& row = table.rows[i];
    if (!row.failed.empty() || !row.errors[by]) continue;
    const char* colour = row.dominated ? "#999999" : svg::colour(0);
    const double y = y_of(row.errors[by]->most);
    content += svg::line(x_of(row.time_us.low * per_ms(row)), y, x_of(row.time_us.high * per_ms(row)), y, colour, 1) +
               svg::dot(x_of(row.load()), y, colour) +
               svg::text(x_of(row.load()) + 5, y - 4, "start", fmt::format("{}", i), colour);
  }
  content += svg::text(kLeft + kWidth / 2, kTop + kHeight + 32, "middle",
                       "us to simulate a ms with contact; numbers: settings of tradeoff.csv; line: the front");
  content +=
      svg::text(kLeft, kTop - 14, "start",
                fmt::format("{}, {}: greatest of {} repetitions", kKinds[by].name, kKinds[by].unit, table.repeat));
  return svg::picture(kLeft + kWidth + 20, kTop + kHeight + 42, content);
}

}  // namespace verisim::tradeoff

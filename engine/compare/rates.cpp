#include "engine/compare/rates.hpp"

#include <boost/math/special_functions/beta.hpp>
#include <cmath>

#include "engine/base/csv.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/base/text.hpp"
#include "engine/compare/comparison.hpp"
#include "engine/compare/embedded.hpp"
#include "engine/compare/index_table.hpp"
#include "engine/compare/shift.hpp"

namespace verisim::compare {
namespace {

constexpr double kCertainty = 0.95;

/// What --programs writes before the times of a run.
bool is_no_figure(const std::string& column) {
  return column == "pair" || column == "program";
}

RunTimes times_in(const std::string& name, const CsvRow& row, const std::vector<std::string>& columns) {
  if (row.fields.size() != columns.size())
    fail(ErrorKind::input, "{}:{}: has {} fields, the first line {}", name, row.line, row.fields.size(),
         columns.size());
  RunTimes times;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (is_no_figure(columns[i])) continue;
    const std::optional<double> time = number_in(row.fields[i]);
    if (!time || !std::isfinite(*time) || *time <= 0)
      fail(ErrorKind::input, "{}:{}: '{}' is no time above 0", name, row.line, shown(row.fields[i], 40));
    times.push_back(*time);
  }
  return times;
}

RunTimes slowed(RunTimes times, double factor) {
  for (double& time : times) time *= factor;
  return times;
}

/// The samples of one comparison that begins with the recorded run `first`.
std::vector<TimeSamples> drawn(const RecordedTimes& recorded, const RateAsked& asked, std::size_t first,
                               std::uint64_t lot) {
  const std::size_t n = asked.repetitions;
  Series series(recorded.figures);
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_apart = asked.order == Order::apart;
    const RunTimes& one = recorded.runs[first + (is_apart ? i : 2 * i)];
    const RunTimes& other = recorded.runs[first + (is_apart ? n + i : 2 * i + 1)];
    const bool b_first = !is_apart && is_b_first(lot, i);
    series.add_pair(b_first ? other : one, slowed(b_first ? one : other, 1 + asked.slower));
  }
  std::vector<TimeSamples> samples = series.samples();
  if (asked.order == Order::apart)
    for (TimeSamples& s : samples) s.is_paired = false;
  return samples;
}

}  // namespace

RecordedTimes read_times(const std::string& name, const std::string& text) {
  RecordedTimes recorded;
  std::vector<std::string> columns;
  for (const CsvRow& row : read_csv(name, text)) {
    if (row.fields.front().starts_with("#")) continue;
    if (!columns.empty()) {
      recorded.runs.push_back(times_in(name, row, columns));
      continue;
    }
    columns = row.fields;
    for (const std::string& column : columns)
      if (!is_no_figure(column)) recorded.figures.push_back({column, column.ends_with("_s") ? "s" : "ns"});
  }
  if (recorded.runs.empty() || recorded.figures.empty()) fail(ErrorKind::input, "{}: has no times", name);
  return recorded;
}

const RecordedTimes& built_in_times() {
  static const RecordedTimes recorded = read_times("times.csv", kTimesText);
  return recorded;
}

Rate measure_rate(const RecordedTimes& recorded, const RateAsked& asked, const TimeRule& rule) {
  const std::size_t needed = 2 * asked.repetitions;
  VERISIM_ASSERT(asked.repetitions > 0);
  VERISIM_ASSERT(recorded.runs.size() >= needed);
  const RandomStream where(asked.seed, "compare.rates.where"), lot(asked.seed, "compare.rates.lot");
  Rate rate{.asked = asked};
  for (std::uint64_t i = 0; i < asked.comparisons; ++i) {
    const auto places = static_cast<double>(recorded.runs.size() - needed + 1);
    const auto first = static_cast<std::size_t>(where.uniform(i) * places);
    Comparison c;
    c.times = judge_times(drawn(recorded, asked, first, lot.bits(i)), rule);
    const Verdict verdict = verdict_of(c);
    rate.worse += verdict == Verdict::worse ? 1 : 0;
    rate.better += verdict == Verdict::better ? 1 : 0;
    rate.different += verdict == Verdict::different ? 1 : 0;
  }
  std::vector<double> first_figure;
  for (const RunTimes& run : recorded.runs) first_figure.push_back(run[0]);
  rate.seconds = static_cast<double>(needed) * median_of(first_figure);
  return rate;
}

double upper_bound(std::size_t count, std::size_t trials) {
  if (count >= trials) return 1;
  return boost::math::ibeta_inv(static_cast<double>(count + 1), static_cast<double>(trials - count), kCertainty);
}

double lower_bound(std::size_t count, std::size_t trials) {
  if (count == 0) return 0;
  return boost::math::ibeta_inv(static_cast<double>(count), static_cast<double>(trials - count + 1), 1 - kCertainty);
}

}  // namespace verisim::compare

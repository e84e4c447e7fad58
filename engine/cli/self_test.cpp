#include "engine/cli/self_test.hpp"
#include "engine/base/json.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/text_table.hpp"
#include "engine/base/user_file.hpp"
#include "engine/compare/bounds.hpp"
#include "engine/session/progress_line.hpp"

namespace verisim::cli {
namespace {

using compare::Order;
using compare::Rate;

constexpr std::size_t kComparisons = 1000;
constexpr double kSlower = 0.05, kFalseAlarms = 0.01, kCaught = 0.95;

const char* name_of(Order order) {
  switch (order) {
    case Order::in_turns:
      return "in turns";
    case Order::apart:
      return "A, then B";
  }
  return "";
}

std::size_t alarms_of(const Rate& rate) {
  return rate.worse + rate.better + rate.different;
}

bool is_kept(const Rate& rate) {
  if (rate.asked.slower == 0) return compare::upper_bound(alarms_of(rate), rate.asked.comparisons) < kFalseAlarms;
  return compare::lower_bound(rate.worse, rate.asked.comparisons) > kCaught;
}

}  // namespace

SelfTest self_test(const std::string& times_file, bool quiet) {
  compare::RecordedTimes read;
  if (!times_file.empty()) read = compare::read_times(times_file, UserFile(times_file, times_file).content());
  const compare::RecordedTimes& recorded = times_file.empty() ? compare::built_in_times() : read;
  if (recorded.runs.size() < 4 * kJudgedRuns)
    fail(ErrorKind::input, "{}: has {} runs; {} or more are needed", times_file, recorded.runs.size(), 4 * kJudgedRuns);
  SelfTest test{.from = fmt::format("{} recorded runs{}", recorded.runs.size(),
                                    times_file.empty() ? " (bench/baseline/README.md)" : " of " + times_file)};
  test.kept = true;
  const ProgressLine line(!quiet);
  for (const Order order : {Order::in_turns, Order::apart})
    for (const std::size_t repetitions : {std::size_t{50}, std::size_t{100}, kJudgedRuns})
      for (const double slower : {0.0, kSlower}) {
        line.say(fmt::format("{}, {} repetitions, {:.0f} % slower", name_of(order), repetitions, 100 * slower));
        test.rates.push_back(compare::measure_rate(
            recorded,
            {.order = order, .repetitions = repetitions, .slower = slower, .comparisons = kComparisons, .seed = 1},
            {.effect = compare::built_in_bounds().effect_interleaved,
             .alpha = order == Order::in_turns ? compare::kAlphaInTurns : compare::kAlphaApart}));
        if (order == Order::in_turns && repetitions == kJudgedRuns) test.kept = test.kept && is_kept(test.rates.back());
      }
  return test;
}

std::string table_of(const SelfTest& test) {
  std::string text =
      fmt::format("resampled from {}; {} comparisons a row, all figures judged together\n", test.from, kComparisons);
  TextTable table({"order of runs", "of each", "takes", "B is slower by", "slower", "faster", "both", ""});
  for (const Rate& rate : test.rates) {
    const auto percent = [&](std::size_t count) {
      return fmt::format("{:.1f} %", 100 * static_cast<double>(count) / static_cast<double>(rate.asked.comparisons));
    };
    const bool is_alike = rate.asked.slower == 0;
    const std::size_t n = rate.asked.comparisons;
    table.add({name_of(rate.asked.order), fmt::format("{}", rate.asked.repetitions),
               fmt::format("{:.0f} s", rate.seconds), fmt::format("{:.0f} %", 100 * rate.asked.slower),
               percent(rate.worse), percent(rate.better), percent(rate.different),
               is_alike ? fmt::format("false alarms: at most {:.2f} %", 100 * compare::upper_bound(alarms_of(rate), n))
                        : fmt::format("caught: at least {:.1f} %", 100 * compare::lower_bound(rate.worse, n))});
  }
  text += table.text();
  text += fmt::format("{} repetitions in turns: false alarms under 1 %, 5 % caught over 95 %: {}\n", kJudgedRuns,
                      test.kept ? "kept" : "NOT KEPT");
  return text;
}

Json json_of(const SelfTest& test) {
  Json j = {{"from", test.from}, {"kept", test.kept}, {"rates", Json::array()}};
  for (const Rate& rate : test.rates)
    j["rates"].push_back({{"order", name_of(rate.asked.order)},
                          {"repetitions", rate.asked.repetitions},
                          {"seconds", rate.seconds},
                          {"slower_by", rate.asked.slower},
                          {"comparisons", rate.asked.comparisons},
                          {"worse", rate.worse},
                          {"better", rate.better},
                          {"different", rate.different}});
  return j;
}

}  // namespace verisim::cli

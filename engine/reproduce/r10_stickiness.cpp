// R10: what sticks in the bubble technique (section 4.3.2). An operator carries a box to a wall 3 m away and back
// (scenarios/bubble_stickiness.lua), with every law, spring, device and cure, 30 operators each.
//
// Published in words: after a contact made while the bubble moved, the hand needs as much way back as the bubble moved
// meanwhile; the peak ring "anecdotally improved" what is felt of a collision, and frees the box sooner.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/statistics.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/chart.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

/// One column of the table; all of one row have the same 30 operators.
struct Condition {
  std::string law, device, operators, cure;
  double stiffness = 50;  ///< N/m
};
constexpr std::array kLaws = {"cubic", "quadratic", "linear", "peak-ring"};
/// A surprised operator believes the wall half a metre further, and turns when the box has stood for half a second.
constexpr std::array kOperators = {"sees the wall", "is surprised"};
constexpr std::array kFacts = {"way back", "time back", "bubble moved", "speed", "collision's share of force",
                               "saturated"};
enum Fact { way_back, time_back, bubble_moved, speed, force_share, saturated };

using Facts = std::array<double, kFacts.size()>;
/// By operator; none: it did not come to the wall, or not off it.
using Outcome = std::vector<std::optional<Facts>>;

std::vector<Condition> conditions(bool quick) {
  std::vector<Condition> all;
  if (quick) {
    for (const char* law : {"cubic", "quadratic", "peak-ring"}) all.push_back({law, "omni", kOperators[1], "none"});
    return all;
  }
  for (const char* law : kLaws)
    for (const char* device : {"omni", "virtuose", "ideal"})
      for (const char* operators : kOperators)
        for (const double stiffness : {25.0, 50.0, 100.0}) all.push_back({law, device, operators, "none", stiffness});
  for (const char* law : kLaws)
    for (const char* operators : kOperators)
      for (const char* cure : {"bubble stops in collision", "bump of 2 N"})
        all.push_back({law, "omni", operators, cure});
  return all;
}

RunRequest request_of(const Condition& c, const std::string& file, std::uint64_t seed) {
  RunRequest request{.scenario = "bubble_stickiness",
                     .file = file,
                     .sets = {{"law", c.law}, {"device", c.device}, {"stiffness", fmt::format("{}", c.stiffness)}}};
  if (c.operators == kOperators[1]) request.sets.emplace_back("surprise", "0.5");
  if (c.cure == "bubble stops in collision") request.sets.emplace_back("stop", "true");
  if (c.cure == "bump of 2 N") request.sets.emplace_back("bump", "2");
  request.seed = seed;
  return request;
}

Outcome run_all(const Workshop& workshop, const Condition& c, std::uint64_t seeds, const std::string& file,
                std::string& csv) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const TimedRun run = workshop.run(request_of(c, file, seed));
    csv += fmt::format("{},{},{},{},{},{},{}", c.law, c.device, c.operators, c.cure, c.stiffness, seed, run.outcome);
    outcome.emplace_back();
    if (run.outcome == "released") {
      outcome.back().emplace();
      for (std::size_t f = 0; f < kFacts.size(); ++f) (*outcome.back())[f] = run.measure(kFacts[f]);
    }
    for (std::size_t f = 0; f < kFacts.size(); ++f)
      csv += outcome.back() ? fmt::format(",{}", (*outcome.back())[f]) : ",";
    csv += fmt::format(",{}\n", run.state_hash);
  }
  return outcome;
}

/// Of the operators who came off the wall here and in `beside`.
std::vector<double> samples(const Outcome& outcome, Fact fact, const Outcome& beside) {
  std::vector<double> all;
  for (std::size_t i = 0; i < outcome.size(); ++i)
    if (outcome[i] && beside[i]) all.push_back((*outcome[i])[static_cast<std::size_t>(fact)]);
  return all;
}
Estimate mean(const Outcome& outcome, Fact fact) {
  const std::vector<double> all = samples(outcome, fact, outcome);
  return all.size() < 2 ? Estimate{} : mean_of(all);
}

/// A row with an estimate, or without one if too few operators came through.
Row row_of(std::string what, std::string unit, Figure published, std::size_t came_off, std::size_t tried,
           const std::function<Estimate()>& estimate, const std::vector<std::string>& files) {
  Row row{"R10", std::move(what), std::move(unit), std::move(published), "too few came off", {}, {}, files};
  row.why = fmt::format("{} of {} operators", came_off, tried);
  if (came_off < 2) return row;
  const Estimate e = estimate();
  row.here = e.value;
  row.interval = e.interval;
  row.why += fmt::format(", 95 % interval [{:.3g}, {:.3g}]", e.interval.first, e.interval.second);
  return row;
}

std::string name_of(const Condition& c) {
  std::string name = fmt::format("{}, {}, {:g} N/m", c.device, c.operators, c.stiffness);
  return c.cure == "none" ? name : name + ", " + c.cure;
}

/// Times of those who carry a peg 3 m through the bubble and put it into its hole, one row a law.
std::vector<Row> assembly_rows(const Workshop& workshop, std::uint64_t seeds) {
  const std::string file = workshop.file("r10_assembly.h5"), table = workshop.file("r10_assembly.csv");
  std::string csv = "law,seed,outcome,time_s,state_hash\n";
  std::vector<Row> rows;
  std::vector<const char*> laws = {"peak-ring"};
  if (!workshop.quick) laws = {"cubic", "quadratic", "linear", "peak-ring"};
  for (const char* law : laws) {
    std::vector<double> times;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      RunRequest request = request_of({law, "omni", kOperators[0], "none"}, file, seed);
      request.sets.emplace_back("task", "assemble");
      const TimedRun run = workshop.run(request);
      const bool is_assembled = run.outcome == "assembled";
      if (is_assembled) times.push_back(run.measure("time to assemble"));
      csv += fmt::format("{},{},{},{},{}\n", law, seed, run.outcome,
                         is_assembled ? fmt::format("{}", times.back()) : "", run.state_hash);
    }
    Row row = row_of(fmt::format("time to assemble across 3 m, {}", law), "s", "anecdotally", times.size(), seeds,
                     [&] { return mean_of(times); }, {table, file});
    rows.push_back(std::move(row));
  }
  write_text(table, csv, workshop.force);
  return rows;
}

/// A figure for each condition with a dot for each law.
std::string figure_of(const std::vector<Condition>& all, const std::vector<Outcome>& outcomes, Fact fact,
                      const std::string& label) {
  std::vector<std::string> laws, names;
  const auto place = [](std::vector<std::string>& list, const std::string& name) {
    const auto found = std::find(list.begin(), list.end(), name);
    if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
    list.push_back(name);
    return list.size() - 1;
  };
  std::vector<std::vector<Estimate>> estimates;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t row = place(names, name_of(all[i])), law = place(laws, all[i].law);
    estimates.resize(std::max(estimates.size(), row + 1));
    estimates[row].resize(std::max(estimates[row].size(), law + 1));
    estimates[row][law] = mean(outcomes[i], fact);
  }
  std::vector<IntervalRow> rows;
  for (std::size_t row = 0; row < names.size(); ++row) {
    estimates[row].resize(laws.size());
    rows.push_back({names[row], estimates[row]});
  }
  return interval_chart(label, laws, rows);
}

}  // namespace

std::vector<Row> r10_stickiness(const Workshop& workshop) {
  const std::uint64_t seeds = workshop.quick ? 2 : 30;
  const std::string file = workshop.file("r10_stickiness.h5"), table = workshop.file("r10_stickiness.csv");
  const std::vector<Condition> all = conditions(workshop.quick);
  std::vector<Outcome> outcomes;
  std::string csv = "law,device,operator,cure,stiffness_N_per_m,seed,outcome";
  for (const char* fact : {"way_back_m", "time_back_s", "bubble_moved_m", "speed_m_per_s", "collision_share_of_force",
                           "saturated_share", "state_hash"})
    csv += fmt::format(",{}", fact);
  csv += "\n";
  for (const Condition& c : all) outcomes.push_back(run_all(workshop, c, seeds, file, csv));
  write_text(table, csv, workshop.force);
  std::vector<std::string> files = {table, file};
  for (const auto& [fact, name, label] :
       {std::tuple{way_back, "way_back", "way of the hand to release [m]"},
        std::tuple{time_back, "time_back", "time to release [s]"},
        std::tuple{speed, "speed", "mean speed to the wall [m/s]"},
        std::tuple{force_share, "force_share", "collision's share of force at onset, beside the bubble's"}}) {
    files.push_back(workshop.file(fmt::format("r10_{}.svg", name)));
    write_text(files.back(), figure_of(all, outcomes, fact, label), workshop.force);
  }

  // The rows: the published set-up, an Omni and 50 N/m, with operators who are surprised by the wall.
  const auto of = [&](const char* law) -> const Outcome& {
    const auto is_published = [&](const Condition& c) {
      return c.law == law && c.device == "omni" && c.operators == kOperators[1] && c.stiffness == 50 &&
             c.cure == "none";
    };
    const auto found = std::find_if(all.begin(), all.end(), is_published);
    VERISIM_ASSERT(found != all.end());
    return outcomes[static_cast<std::size_t>(found - all.begin())];
  };
  const Outcome &cubic = of("cubic"), &ring = of("peak-ring");
  std::vector<Row> rows;
  for (const char* law : {"cubic", "quadratic", "peak-ring"}) {
    const Outcome& outcome = of(law);
    const std::vector<double> back = samples(outcome, way_back, outcome),
                              moved = samples(outcome, bubble_moved, outcome);
    rows.push_back(row_of(
        fmt::format("way back over way of the bubble, {}", law), "", 1.0, back.size(), outcome.size(),
        [&] { return ratio_of(back, moved); }, files));
    for (const auto& [fact, what, unit] :
         {std::tuple{way_back, "way back", "m"}, std::tuple{time_back, "time back", "s"},
          std::tuple{speed, "mean speed to the wall", "m/s"}, std::tuple{saturated, "share of frames saturated", ""},
          std::tuple{force_share, "collision's share of force at onset", ""}}) {
      rows.push_back(row_of(
          fmt::format("{}, {}", what, law), unit, "anecdotally", back.size(), outcome.size(),
          [&, f = fact] { return mean(outcome, f); }, files));
    }
  }
  for (const auto& [fact, what] : {std::tuple{way_back, "way back"}, std::tuple{time_back, "time back"}}) {
    const std::vector<double> a = samples(ring, fact, cubic), b = samples(cubic, fact, ring);
    rows.push_back(row_of(
        fmt::format("{}, peak ring over cubic, same operators", what), "", "less", a.size(), ring.size(),
        [&] { return ratio_of(a, b); }, files));
  }
  for (Row& row : assembly_rows(workshop, seeds)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace verisim::reproduce

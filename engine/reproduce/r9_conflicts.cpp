// R9: parts whose constraints contradict each other must neither assemble nor be given energy (figures 8.1 and 8.2).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/record/output_place.hpp"
#include "engine/record/run_file.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

/// Adjacent values of /state/energy: energy that has left the parts for good (dampers, contact, the discretization).
constexpr std::size_t kTerms = 8, kFirstLoss = 3, kLosses = 3;

/// The least energy lost since the start, over all frames [J]. Below zero, energy was generated.
double least_lost(const std::string& path) {
  const RunFile run(path);
  double least = 0;
  for (const Column& column : run.schema().columns()) {
    if (column.path != "/state/energy") continue;
    const std::vector<std::byte> bytes = run.column(column);
    for (std::size_t at = kFirstLoss * sizeof(double); at < bytes.size(); at += kTerms * sizeof(double)) {
      std::array<double, kLosses> losses{};
      std::memcpy(losses.data(), bytes.data() + at, sizeof losses);
      least = std::min(least, losses[0] + losses[1] + losses[2]);
    }
  }
  return least;
}

struct Conflict {
  const char* kind;
  const char* what;
  const char* assembles;  ///< published, in words
};

std::vector<Row> try_out(const Workshop& workshop, const Conflict& conflict, const char* hybrid, std::uint64_t seeds) {
  const std::string name = fmt::format("r9_{}_{}", conflict.kind, hybrid);
  const std::string run_file = workshop.file(name + ".h5");
  const std::string csv_file = workshop.file(name + ".csv");
  std::string csv = "seed,outcome,depth_m,least_energy_lost_J,state_hash\n";
  std::uint64_t assembled = 0;
  double least = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const TimedRun run = workshop.run(
        {.scenario = "pins", .file = run_file, .sets = {{"hybrid", hybrid}, {"kind", conflict.kind}}, .seed = seed});
    const double energy = least_lost(run_file);
    assembled += run.outcome == "assembled" ? 1 : 0;
    least = std::min(least, energy);
    csv += fmt::format("{},{},{},{},{}\n", seed, run.outcome, run.measure("depth"), energy, run.state_hash);
  }
  write_text(csv_file, csv, workshop.force);
  return {{"R9",
           fmt::format("{}, {}: assembles", conflict.what, hybrid),
           "",
           conflict.assembles,
           fmt::format("{} of {}", assembled, seeds),
           {},
           "as many seeded operators tried",
           {run_file, csv_file}},
          {"R9",
           fmt::format("{}, {}: energy gained, at most", conflict.what, hybrid),
           "J",
           0.0,
           std::max(0.0, -least),
           {},
           "by the ledger: dampers, contact and discretization together, at any frame of any trial",
           {run_file, csv_file}}};
}

}  // namespace

std::vector<Row> r9_conflicts(const Workshop& workshop) {
  constexpr Conflict kConflicts[] = {{"angled", "angled pins (fig. 8.1)", "never"},
                                     {"spaced", "pins too far apart (fig. 8.2)", "never"},
                                     {"single", "one of these pins alone", "goes in"}};
  std::vector<Row> rows;
  for (const Conflict& conflict : kConflicts)
    for (const char* hybrid : {"restore", "exact"})
      for (Row& row : try_out(workshop, conflict, hybrid, workshop.quick ? 2 : 100)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace verisim::reproduce

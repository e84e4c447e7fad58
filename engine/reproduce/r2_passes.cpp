// R2: how often the same operator gets the pin through the hole with and without restored degrees of freedom (section
// 8.5), over seeds, clearances and voxel sizes. The dissertation counted one operator once.
#include <fmt/format.h>

#include "engine/base/statistics.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

struct Fit {
  double clearance, voxel_size;  ///< m
};
constexpr Fit kFits[] = {{0.005, 0.0045}, {0.002, 0.0045}, {0.001, 0.0045},
                         {0.005, 0.002},  {0.002, 0.002},  {0.001, 0.002}};

struct Batch {
  std::string run_file, csv_file;
  std::vector<double> rates;  ///< passes per second, seed by seed
};

/// The trial once per seed. All write to one run file, of which the last seed's remains, and a table tells how to
/// repeat each.
Batch run_batch(const Workshop& workshop, const Fit& fit, const char* hybrid, std::uint64_t seeds, double duration) {
  const std::string name =
      fmt::format("r2_{}_clearance_{:g}mm_voxel_{:g}mm", hybrid, 1e3 * fit.clearance, 1e3 * fit.voxel_size);
  Batch batch{workshop.file(name + ".h5"), workshop.file(name + ".csv"), {}};
  std::string csv = "seed,passes,simulated_s,collision_frames,force_max_N,state_hash\n";
  RunRequest request{.scenario = "peg_in_hole",
                     .file = batch.run_file,
                     .sets = {{"hybrid", hybrid},
                              {"clearance", fmt::format("{}", fit.clearance)},
                              {"voxelsize", fmt::format("{}", fit.voxel_size)}},
                     .duration = duration};
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    request.seed = seed;
    const TimedRun run = workshop.run(request);
    const double passes = run.measure("passes");
    batch.rates.push_back(passes / run.simulated_s);
    csv += fmt::format("{},{},{},{},{},{}\n", seed, passes, run.simulated_s, run.collision_frames, run.force_max,
                       run.state_hash);
  }
  write_text(batch.csv_file, csv, workshop.force);
  return batch;
}

Row rate_row(const std::string& what, Figure published, const Batch& batch) {
  const Estimate rate = mean_of(batch.rates);
  return {"R2",
          what,
          "1/s",
          std::move(published),
          rate.value,
          rate.interval,
          fmt::format("mean of {} seeds, 95 % interval [{:.3g}, {:.3g}]", batch.rates.size(), rate.interval.first,
                      rate.interval.second),
          {batch.run_file, batch.csv_file}};
}

Row ratio_row(const std::string& what, Figure published, const Batch& on, const Batch& off) {
  Row row{"R2", what, "", std::move(published), "off never passes", {}, {}, {on.csv_file, off.csv_file}};
  const Estimate ratio = ratio_of(on.rates, off.rates);
  if (mean_of(off.rates).value > 0) {
    row.here = ratio.value;
    row.interval = ratio.interval;
    row.why = fmt::format("95 % interval [{:.3g}, {:.3g}] over {} seeds; ", ratio.interval.first, ratio.interval.second,
                          on.rates.size());
  }
  row.why += "off is not weakened for the comparison: its penalty is stable and its operator searches as well";
  return row;
}

}  // namespace

std::vector<Row> r2_passes(const Workshop& workshop) {
  const std::uint64_t seeds = workshop.quick ? 3 : 30;
  const double duration = workshop.quick ? 6 : 20;
  const std::span<const Fit> fits = std::span(kFits).first(workshop.quick ? 1 : std::size(kFits));
  std::vector<Row> rows;
  for (const Fit& fit : fits) {
    const bool as_published = &fit == kFits;
    const auto figure = [&](double value) { return as_published ? Figure(value) : Figure("not reported"); };
    const std::string where =
        fmt::format("{:g} mm clearance, {:g} mm voxels", 1e3 * fit.clearance, 1e3 * fit.voxel_size);
    const Batch off = run_batch(workshop, fit, "off", seeds, duration);
    const Batch on = run_batch(workshop, fit, "restore", seeds, duration);
    rows.push_back(rate_row("passes, off, " + where, figure(3.0 / 28), off));
    rows.push_back(rate_row("passes, restore, " + where, figure(5.0 / 10), on));
    rows.push_back(ratio_row("rate, restore to off, " + where, figure(14.0 / 3), on, off));
  }
  return rows;
}

}  // namespace verisim::reproduce

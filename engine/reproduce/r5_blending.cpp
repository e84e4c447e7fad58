// R5: costs of the approach before the dissertation's: a blended force from a constraint solver (the loop fell below
// 500 Hz, often to 100 Hz, while the pin went in), and the association of voxels with entities (minutes).
//
// Both exist here as well: hybrid = "blend" with a solver written for the purpose, and the association of every surface
// voxel. The comparison separates the cost of the method from that of its CAD kernel.
#include <algorithm>
#include <chrono>

#include "engine/base/quantile.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kNsPerSecond = 1e9;

TimedRun insert_pin(const Workshop& workshop, const std::string& hybrid) {
  return workshop.run({.scenario = "peg_in_hole",
                       .file = workshop.file("r5_" + hybrid + ".h5"),
                       .sets = {{"hybrid", hybrid}},
                       .duration = workshop.quick ? 10 : 45.833});
}

Solid solid(Solid::Kind kind, std::vector<double> sizes) {
  return {kind, std::move(sizes), {}, {}};
}
/// The block and the pin of scenarios/peg_in_hole.lua.
Solid block() {
  return {Solid::Kind::difference,
          {},
          {std::make_shared<const Solid>(solid(Solid::Kind::box, {0.375, 0.375, 0.2})),
           std::make_shared<const Solid>(solid(Solid::Kind::cylinder, {0.075, 0.2}))},
          {}};
}
Solid pin() {
  return solid(Solid::Kind::cylinder, {0.07, 0.4});
}

struct Association {
  std::uint32_t voxels = 0;
  double seconds = 0;
};
/// Least of three.
Association associate_timed(const char* name, const Solid& shape, double voxel_size) {
  using Clock = std::chrono::steady_clock;
  const Part part = load_solid(shape, {});
  VoxelBody body = voxelize(name, part.mesh, {.voxel_size = voxel_size});
  Association best{body.voxmap.surface_count, std::numeric_limits<double>::infinity()};
  for (int turn = 0; turn < 3; ++turn) {
    const auto begin = Clock::now();
    (void)associate(name, part, {}, body);
    best.seconds = std::min(best.seconds, std::chrono::duration<double>(Clock::now() - begin).count());
  }
  return best;
}

Row association_row(const Workshop& workshop) {
  const std::string file = workshop.file("r5_association.csv");
  std::string csv = "voxel_m,block_voxels,block_s,pin_voxels,pin_s\n";
  double coarse = 0;
  Association fine;
  for (const double voxel_size : {0.0045, 0.001}) {
    const Association a = associate_timed("block", block(), voxel_size);
    const Association b = associate_timed("pin", pin(), voxel_size);
    csv += fmt::format("{},{},{:.6f},{},{:.6f}\n", voxel_size, a.voxels, a.seconds, b.voxels, b.seconds);
    if (coarse == 0) coarse = a.seconds + b.seconds;
    fine = {a.voxels + b.voxels, a.seconds + b.seconds};
  }
  write_text(file, csv, workshop.force);
  return {
      "R5",
      "association of voxels with b-reps, block and pin",
      "s",
      "several minutes",
      coarse,
      {},
      fmt::format("voxels of 4.5 mm; of 1 mm ({} surface voxels): {:.2f} s. Each entity is walked through the voxels "
                  "it crosses, where D-Cubed was asked for the intersection of every voxel with every entity",
                  fine.voxels, fine.seconds),
      {file}};
}

}  // namespace

std::vector<Row> r5_blending(const Workshop& workshop) {
  TimedRun blend = insert_pin(workshop, "blend");
  TimedRun restore = insert_pin(workshop, "restore");
  const std::vector<std::string> runs = {blend.run_file, restore.run_file};
  const double slow = quantile(blend.collision_frame_times_ns, 0.99);
  const auto late = std::count_if(blend.collision_frame_times_ns.begin(), blend.collision_frame_times_ns.end(),
                                  [](std::uint32_t ns) { return ns > kNsPerSecond / 500; });
  const double median = quantile(blend.collision_frame_times_ns, 0.5);
  const double cost = median / quantile(restore.collision_frame_times_ns, 0.5);
  return {
      {"R5",
       "rate during insertion with force blending",
       "Hz",
       100.0,
       kNsPerSecond / slow,
       {},
       fmt::format("what 99 % of the {} frames with contact keep; {} of them are slower than 500 Hz",
                   blend.collision_frames, late),
       runs},
      {"R5",
       "frame with contact: with solver and blending over without",
       "",
       10.0,
       cost,
       {},
       "1000 Hz became 100 Hz; medians here, blend over restore: six unknowns solved in place cost microseconds, so "
       "the published cost was the CAD kernel's, not the idea's",
       runs},
      association_row(workshop)};
}

}  // namespace verisim::reproduce

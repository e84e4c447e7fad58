// R3: collisions of voxels in one run, and how many of them needed recognition (section 6.5).
#include <fmt/format.h>

#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {

std::vector<Row> r3_collisions(const Workshop& workshop) {
  const std::string file = workshop.file("r3_collisions.h5");
  const TimedRun run =
      workshop.run({.scenario = "peg_in_hole", .file = file, .sets = {{"hybrid", "restore"}}, .duration = 110});
  const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
  const std::uint64_t found = run.cache_misses - run.null_misses;
  return {
      {"R3",
       "collisions in one run",
       "",
       7'273'610.0,
       number(run.collisions),
       {},
       fmt::format("the trial of section 8.5, longer: {} s in {:.2f} s of computing", run.simulated_s, run.wall_s),
       {file}},
      {"R3",
       "cache misses",
       "",
       4.0,
       number(run.cache_misses),
       {},
       "one for each pair of feature sets that ever met; a rim's voxels here hold the rim itself beside its faces",
       {file}},
      {"R3", "misses that found no constraint", "", 3.0, number(run.null_misses), {}, "as above", {file}},
      {"R3",
       "misses that found one",
       "",
       1.0,
       number(found),
       {},
       "of the pairs of feature sets that met; walls with walls, and rims with either",
       {file}},
  };
}

}  // namespace verisim::reproduce

// R1: how often the paced loop misses its millisecond in the dissertation's trial (section 8.5). Blocks of one second
// alternate with an empty paced loop, which measures the overruns of the machine alone.
#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/statistics.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

constexpr std::uint64_t kBlock = 1000;            ///< frames: one second
constexpr std::uint32_t kTooLong_ns = 1'500'000;  ///< 1.5 periods, as the dissertation counts them

std::vector<double> overrun_fractions(const std::vector<std::uint32_t>& counts) {
  std::vector<double> result;
  for (const std::uint32_t count : counts) result.push_back(count / static_cast<double>(kBlock));
  return result;
}

/// Periods over 1.5 ms: of the run, and of an empty loop second by second in turn with it.
Row overruns_row(const TimedRun& run, const std::string& file) {
  const std::vector<double> loaded = overrun_fractions(run.block_overruns);
  const std::vector<double> empty = overrun_fractions(run.empty_block_overruns);
  if (loaded.size() < 2 || loaded.size() != empty.size())
    fail(ErrorKind::interrupted, "{}: the paced run ended before two blocks were done", file);
  std::vector<double> more;
  for (std::size_t i = 0; i < loaded.size(); ++i) more.push_back(loaded[i] - empty[i]);
  const Estimate fraction = mean_of(loaded);
  const Estimate idle = mean_of(empty);
  const Estimate difference = mean_of(more);
  const bool shows = difference.interval.first > 0;
  return {"R1",
          "periods over 1.5 ms, of all frames",
          "%",
          0.124,
          100 * fraction.value,
          std::pair(100 * fraction.interval.first, 100 * fraction.interval.second),
          fmt::format("{} real-time priority; an empty paced loop on this machine, second by second in turn: {:.3g} % "
                      "[{:.3g}, {:.3g}]; the difference {:+.3g} % [{:+.3g}, {:+.3g}] is {}",
                      run.realtime_priority ? "with" : "without", 100 * idle.value, 100 * idle.interval.first,
                      100 * idle.interval.second, 100 * difference.value, 100 * difference.interval.first,
                      100 * difference.interval.second,
                      shows ? "beyond its own 95 % interval" : "within its own 95 % interval"),
          {file}};
}

}  // namespace

std::vector<Row> r1_overruns(const Workshop& workshop) {
  const std::string file = workshop.file("r1_paced.h5");
  RunRequest request{
      .scenario = "peg_in_hole", .file = file, .sets = {{"hybrid", "restore"}}, .paced = true, .empty_block = kBlock};
  if (workshop.quick) request.duration = 4;
  const TimedRun run = workshop.run(request);
  const auto slow = static_cast<double>(std::count_if(run.frame_times_ns.begin(), run.frame_times_ns.end(),
                                                      [](std::uint32_t ns) { return ns > kTooLong_ns; }));
  const auto frames = static_cast<double>(run.frames);
  return {
      {"R1",
       "frames of the trial",
       "",
       45833.0,
       frames,
       {},
       workshop.quick ? "shortened by --quick" : "the same duration",
       {file}},
      {"R1",
       "frames with collision",
       "",
       11053.0,
       static_cast<double>(run.collision_frames),
       {},
       "another operator: he touches the wall more often",
       {file}},
      overruns_row(run, file),
      {"R1",
       "overruns per hundred frames with collision",
       "%",
       0.516,
       100 * static_cast<double>(run.overruns) / static_cast<double>(std::max<std::uint64_t>(run.collision_frames, 1)),
       {},
       "as above, divided by fewer frames, as the dissertation does",
       {file}},
      {"R1",
       "frames computed in over 1.5 ms",
       "%",
       "not reported",
       100 * slow / frames,
       {},
       fmt::format("the slowest frame took {:.0f} us",
                   *std::max_element(run.frame_times_ns.begin(), run.frame_times_ns.end()) / 1e3),
       {file}},
  };
}

}  // namespace verisim::reproduce

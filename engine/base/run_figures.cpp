#include "engine/base/run_figures.hpp"

#include <algorithm>
#include <array>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

template <auto member>
RunFigure::Value get(const RunFigures& run) {
  return run.*member;
}

constexpr std::array kFigures = {
    RunFigure{"scenario", "", "file name of the scenario", get<&RunFigures::scenario>},
    RunFigure{"run_file", "", "where the run is recorded", get<&RunFigures::run_file>, true},
    RunFigure{"frames", "1", "frames computed", get<&RunFigures::frames>},
    RunFigure{"simulated_s", "s", "simulated time", get<&RunFigures::simulated_s>},
    RunFigure{"wall_s", "s", "wall clock from the first frame to the closed file", get<&RunFigures::wall_s>, true},
    RunFigure{"load_s", "s", "wall clock of loading before that", get<&RunFigures::load_s>, true},
    RunFigure{"realtime_factor", "1", "simulated time over wall clock",
              [](const RunFigures& run) -> RunFigure::Value { return run.realtime_factor(); }, true},
    RunFigure{"collision_frames", "1", "frames with a contact", get<&RunFigures::collision_frames>},
    RunFigure{"overruns", "1", "frames over 1.5 time steps", get<&RunFigures::overruns>, true},
    RunFigure{"realtime_priority", "", "the system granted real-time priority", get<&RunFigures::realtime_priority>,
              true},
    RunFigure{"collisions", "1", "contacts, summed over all frames", get<&RunFigures::collisions>},
    RunFigure{"by_voxels", "1", "of those, the ones that voxels answered", get<&RunFigures::by_voxels>},
    RunFigure{"exact_frames", "1", "frames with a contact of a pair that was to be exact",
              get<&RunFigures::exact_frames>},
    RunFigure{"exact_frames_by_voxels", "1", "of those, the ones in which voxels answered such a contact",
              get<&RunFigures::exact_frames_by_voxels>},
    RunFigure{"cache_hits", "1", "constraint look-ups that were memoized", get<&RunFigures::cache_hits>},
    RunFigure{"cache_misses", "1", "constraint look-ups that had to be recognized", get<&RunFigures::cache_misses>},
    RunFigure{"null_misses", "1", "of those, the ones that led to no constraint", get<&RunFigures::null_misses>},
    RunFigure{"max_force_N", "N", "largest contact force on a body", get<&RunFigures::force_max>},
    RunFigure{"max_penetration_m", "m", "deepest contact", get<&RunFigures::penetration_max>},
    RunFigure{"penetration_source", "", "what said that: voxels, exact surfaces or triangles",
              get<&RunFigures::penetration_source>},
    RunFigure{"outcome", "", "the scenario's own word", get<&RunFigures::outcome>},
    RunFigure{"end", "", "how the run ended", get<&RunFigures::end>},
    RunFigure{"state_hash", "", "hash of every value of /state", get<&RunFigures::state_hash>},
    RunFigure{"frame_ns", "ns", "wall clock of a frame", get<&RunFigures::frame_ns>, true},
    RunFigure{"collision_frame_ns", "ns", "wall clock of a frame with contact", get<&RunFigures::collision_frame_ns>,
              true},
};

}  // namespace

std::span<const RunFigure> run_figures() {
  return kFigures;
}

double RunFigures::measure(const std::string& name) const {
  const auto found = std::find_if(measures.begin(), measures.end(), [&](const Measure& m) { return m.name == name; });
  if (found == measures.end())
    fail(ErrorKind::input, "{}: the scenario measured no '{}'; run it by itself to see what it measures", run_file,
         name);
  return found->value;
}

}  // namespace verisim

// The report at the end of a run: a JSON object, a table for a terminal, the attributes of /summary.
#pragma once

#include <map>
#include <string>

#include "engine/cli/run_loop.hpp"
#include "engine/cli/session.hpp"

namespace verisim::cli {

struct Summary {
  std::string scenario, run_file, outcome, state_hash, end;
  std::uint64_t frames = 0, collision_frames = 0, overruns = 0;
  std::uint64_t collisions = 0, cache_hits = 0, cache_misses = 0, null_misses = 0;
  std::vector<std::pair<std::string, std::uint64_t>>
      constraints;  ///< name, frames in which a pair of bodies was under it
  bool realtime_priority = false;
  double simulated_s = 0, wall_s = 0, load_s = 0, force_max = 0, penetration_max = 0;
  struct Times {
    std::uint32_t p50 = 0, p99 = 0, max = 0;
  };
  Times frame_ns, collision_frame_ns;
  std::vector<Measure> measures;
};

[[nodiscard]] Summary summarize(const Session& session, LoopResult& loop, const std::string& run_file);
[[nodiscard]] std::string to_json(const Summary& summary);
[[nodiscard]] std::string to_table(const Summary& summary);
[[nodiscard]] std::map<std::string, Attribute> to_attributes(const Summary& summary);

}  // namespace verisim::cli

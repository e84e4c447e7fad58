// The options shared by all commands that simulate (INTERFACES section 1).
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace verisim::cli {

/// Where a command writes, and whether it may replace what is not of its kind.
struct OutOptions {
  std::string path;
  bool force = false;
};

struct SimulateOptions {
  OutOptions out;
  std::vector<std::string> sets;   ///< KEY=VALUE
  std::vector<std::string> binds;  ///< NAME=SOURCE
  std::optional<double> duration;
  std::optional<std::uint64_t> seed;
  unsigned threads = 1;
  std::string simd;
  bool realtime = false;
  bool json = false;
  bool quiet = false;
  bool no_embed = false;
  bool no_cache = false;
};

/// --threads and --simd. They change how fast a run is and none of its bits.
void add_speed_options(CLI::App& command, unsigned& threads, std::string& simd);

/// --no-cache.
void add_cache_option(CLI::App& command, bool& no_cache);

/// Declares them on a command.
void add_simulate_options(CLI::App& command, SimulateOptions& options);

/// -o/--out and --force.
CLI::Option* add_out_options(CLI::App& command, OutOptions& out, const std::string& description);

/// A seed: decimal digits alone, up to 2^64 - 1. Anything else is wrong usage that names it.
void add_seed_option(CLI::App& command, std::function<void(std::uint64_t)> take, const std::string& description);

/// A place that has a name: an empty one, as of a shell's variable that is not set, is none.
[[nodiscard]] CLI::Validator named();

/// Seconds: finite and above 0.
[[nodiscard]] CLI::Validator seconds();

/// "KEY=VALUE" split at the first '='. Error(usage) naming `option` if there is none or the key is empty.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> split_pairs(const std::string& option,
                                                                           const std::vector<std::string>& texts);

}  // namespace verisim::cli

// The options shared by all commands that simulate (INTERFACES section 1).
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace verisim::cli {

struct SimulateOptions {
  std::string out;
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
};

/// Declares them on a command.
void add_simulate_options(CLI::App& command, SimulateOptions& options);

/// "KEY=VALUE" split at the first '='. Error(usage) naming `option` if there is none or the key is empty.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> split_pairs(const std::string& option,
                                                                           const std::vector<std::string>& texts);

}  // namespace verisim::cli

#include "engine/cli/options.hpp"

#include "engine/base/error.hpp"

namespace verisim::cli {

void add_simulate_options(CLI::App& command, SimulateOptions& o) {
  command.add_option("-o,--out", o.out, "Run file to write (default: runs/SCENARIO.h5)");
  command
      .add_option("--set", o.sets,
                  "KEY=VALUE: scenario parameter, a Lua expression; a bare word is a string; an unknown "
                  "KEY lists what the scenario knows")
      ->take_all();
  command.add_option("--bind", o.binds, "NAME=SOURCE: drive the device NAME from a trace file")->take_all();
  command.add_option("--duration", o.duration, "Simulated seconds")->check(CLI::PositiveNumber);
  command.add_option("--seed", o.seed, "Seed of every random stream");
  command.add_option("--threads", o.threads, "Threads (same bits for any number)")->check(CLI::Range(1, 256));
  command.add_option("--simd", o.simd, "SIMD target: scalar or any that 'verisim doctor' lists (same bits)");
  command.add_flag("--realtime", o.realtime, "Pace by the wall clock, with real-time priority if the system grants it");
  command.add_flag("--json", o.json, "One JSON object on stdout, all else on stderr");
  command.add_flag("--quiet", o.quiet, "No progress, no summary");
  command.add_flag("--no-embed", o.no_embed, "Leave the content of input files out of the run file");
}

std::vector<std::pair<std::string, std::string>> split_pairs(const std::string& option,
                                                             const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      fail(ErrorKind::usage, "{} {}: write it as NAME=VALUE", option, text);
    pairs.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return pairs;
}

}  // namespace verisim::cli

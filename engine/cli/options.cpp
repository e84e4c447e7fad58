#include "engine/cli/options.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "engine/base/error.hpp"

namespace verisim::cli {

CLI::Option* add_out_options(CLI::App& command, OutOptions& out, const std::string& description) {
  command.add_flag("--force", out.force, "Let -o replace a plain file of any kind; an input, a device, a folder never");
  return command.add_option("-o,--out", out.path, description)->check(named());
}

void add_seed_option(CLI::App& command, std::function<void(std::uint64_t)> take, const std::string& description) {
  command
      .add_option_function<std::string>(
          "--seed",
          [take = std::move(take)](const std::string& text) {
            std::uint64_t seed = 0;
            const char* end = text.data() + text.size();
            const auto [stop, error] = std::from_chars(text.data(), end, seed);
            if (error != std::errc() || stop != end)
              throw CLI::ValidationError("--seed " + text,
                                         "a seed is a whole number from 0 to " +
                                             std::to_string(std::numeric_limits<std::uint64_t>::max()) +
                                             ", in decimal digits alone");
            take(seed);
          },
          description)
      ->type_name("UINT64");
}

CLI::Validator named() {
  return CLI::Validator(
      [](const std::string& text) { return text.empty() ? "is empty; name one, or leave it out" : std::string(); }, "",
      "named");
}

CLI::Validator seconds() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0) return {};
    return text + " is no number of seconds that is finite and above 0";
  };
  return CLI::Validator(check, "SECONDS");
}

void add_speed_options(CLI::App& command, unsigned& threads, std::string& simd) {
  command.add_option("--threads", threads, "Threads of a run (same bits for any number)")->check(CLI::Range(1, 256));
  command.add_option("--simd", simd, "SIMD target: scalar or any that 'verisim doctor' lists (same bits)");
}

void add_cache_option(CLI::App& command, bool& no_cache) {
  command.add_flag("--no-cache", no_cache,
                   "Prepare all parts anew; without it those that a run prepared before are read from VERISIM_CACHE "
                   "(default: ~/.cache/verisim). Same bits");
}

void add_simulate_options(CLI::App& command, SimulateOptions& o) {
  add_out_options(command, o.out,
                  "Run file to write; only a run file is replaced (default: runs/SCENARIO.h5, or runs/SCENARIO-2.h5 "
                  "while another run writes that)");
  command
      .add_option("--set", o.sets,
                  "KEY=VALUE: scenario parameter, a Lua expression; a bare word is a string; an unknown "
                  "KEY lists what the scenario knows")
      ->take_all();
  command.add_option("--bind", o.binds, "NAME=SOURCE: drive the device NAME from a trace file")->take_all();
  command.add_option("--duration", o.duration, "Simulated seconds")->check(seconds());
  add_seed_option(
      command, [&o](std::uint64_t seed) { o.seed = seed; }, "Seed of every random stream (0 to 2^64 - 1)");
  add_speed_options(command, o.threads, o.simd);
  command.add_flag("--realtime", o.realtime, "Pace by the wall clock, with real-time priority if the system grants it");
  command.add_flag("--json", o.json, "One JSON object on stdout, all else on stderr");
  command.add_flag("--quiet", o.quiet, "No progress, no summary");
  add_cache_option(command, o.no_cache);
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

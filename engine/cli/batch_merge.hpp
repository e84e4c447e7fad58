// `verisim batch merge`: the shards of a batch become one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace verisim::cli {

struct MergeOptions {
  std::string out;
  std::vector<std::string> shards;
  bool json = false, quiet = false;
};

/// Declares it below `batch`.
[[nodiscard]] CLI::App* add_merge(CLI::App& batch, MergeOptions& options);
/// Its exit code.
[[nodiscard]] int run_merge(const MergeOptions& options);

}  // namespace verisim::cli

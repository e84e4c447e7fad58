// What the runs of a batch are: every row of a table x every point of a grid x every draw x every repetition, numbered
// from 0 in that order, the repetition fastest. Plain data; a run is found from its number, none is stored.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/batch/cell.hpp"
#include "engine/batch/distribution.hpp"

namespace verisim::batch {

/// More runs than this are refused.
inline constexpr std::uint64_t kRunsMax = 10'000'000;

/// A parameter's value: as `--set` takes it, and what that is.
struct Value {
  std::string text;
  Cell cell;
};

/// --vary KEY=V1,V2
struct Axis {
  std::string key;
  std::vector<Value> values;
};

/// --design FILE.csv
struct Table {
  std::vector<std::string> keys;
  std::vector<std::vector<Value>> rows;
  std::vector<std::uint64_t> seeds;  ///< of the rows; empty: it has no column `seed`
};

/// --random N KEY=…
struct Draw {
  std::string key;
  Distribution distribution;
};

/// The part of the runs that one of several batches computes: those whose number is index - 1 modulo `of`.
struct Shard {
  std::uint64_t index = 1, of = 1;
};

/// One run of a design.
struct Point {
  std::uint64_t run = 0, seed = 0;
  std::vector<Value> values;  ///< in the order of Design::keys
};

struct Design {
  std::optional<Table> table;
  std::vector<Axis> axes;
  std::vector<Draw> draws;
  std::uint64_t draw_count = 1, repeat = 1;
  std::uint64_t seed = 1;
  Shard shard;

  [[nodiscard]] std::vector<std::string> keys() const;        ///< of table, grid and draws, in this order
  [[nodiscard]] std::vector<std::string> group_keys() const;  ///< of table and grid: what the summary groups by
  [[nodiscard]] std::uint64_t runs() const;                   ///< of all shards
  [[nodiscard]] bool has(std::uint64_t run) const { return run % shard.of == shard.index - 1; }
  [[nodiscard]] std::uint64_t runs_of_shard() const;
  /// @pre run < runs()
  [[nodiscard]] Point point(std::uint64_t run) const;
};

/// What the command line says of a design.
struct DesignRequest {
  std::vector<std::string> vary, random;
  std::string design_name, design_content;  ///< the CSV's; an empty name: none
  std::vector<std::string> set_keys;        ///< of --set: equal in all runs
  bool seed_is_a_parameter = false;         ///< the scenario has one of that name: a column `seed` says too little
  std::uint64_t repeat = 1, seed = 1;
  std::string shard;  ///< "I/N"; empty: all runs
};

/// The value that `--set KEY=TEXT` would give. Error(input): no such parameter, no such value. It begins with `option`:
/// where the text stands, an option or FILE:LINE:
using ReadValue = std::function<Cell(const std::string& option, const std::string& key, const std::string& text)>;

/// Error(usage): nothing to vary, a KEY in two places, a value twice, too many runs (says how many), a shard that there
/// is not. Error(input) with FILE:LINE for the table, too if its column `seed` may be the runs' or a parameter's.
[[nodiscard]] Design make_design(const DesignRequest& request, const ReadValue& read);

/// All that makes two designs the same but the seed and the shard; for batch.json.
[[nodiscard]] Json to_json(const Design& design);

}  // namespace verisim::batch

// What a batch came to: per group of parameters the shares of outcomes and the means of measures, with intervals.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/batch/index.hpp"
#include "engine/batch/intervals.hpp"

namespace verisim::batch {

struct Share {
  std::string outcome;  ///< the scenario's word; of a run that is not done its status; "no outcome" if it said none
  std::uint64_t count = 0;
  double share = 0;
  Interval interval;
};

struct Mean {
  std::string name, unit;
  std::uint64_t runs = 0;  ///< that have a value
  double mean = 0;
  std::optional<Interval> interval;  ///< none of one run
};

struct Group {
  std::vector<Cell> values;  ///< of Summary::keys
  std::uint64_t runs = 0;
  std::vector<Share> shares;  ///< the most frequent first
  std::vector<Mean> means;
};

struct Summary {
  std::vector<std::string> keys;  ///< parameters that make the groups
  std::vector<Group> groups;      ///< in the order of the design
};

/// Of all rows. Besides the measures the means are of insertion_s, max_force_N, max_penetration_m and overlap_m.
/// @param seed the batch's
[[nodiscard]] Summary summarize(Index& index, const std::vector<std::string>& keys, std::uint64_t seed);

[[nodiscard]] Json to_json(const Summary& summary);
/// Columns that line up; of more than 40 groups the first, and how many there are.
[[nodiscard]] std::string table_of(const Summary& summary);

}  // namespace verisim::batch

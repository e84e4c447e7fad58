// What a row of a run file holds (INTERFACES section 2), each fact declared once (base/columns.hpp), and the sums over
// the run. The row's state bytes, chained to the hash of the row before, are the state hash.
#pragma once

#include <vector>

#include "engine/record/run_file.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/stages/stages.hpp"
#include "engine/simulation/totals.hpp"

namespace verisim {

class Recording {
 public:
  /// All of it is read once a frame, so it must outlive the recording.
  Recording(const World& world, const Stages& stages, const FrameCost& cost);

  /// After a frame: sums, row, hash.
  void take(const World& world, const Stages& stages, const FrameCost& cost);

  [[nodiscard]] const Schema& schema() const { return schema_; }
  [[nodiscard]] const std::vector<std::byte>& row() const { return row_; }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] const Totals& totals() const { return totals_; }

 private:
  void add_up(const World& world, const Stages& stages, const FrameCost& cost);

  Columns columns_;
  Schema schema_;
  std::vector<std::byte> row_;
  std::uint64_t hash_ = 0;
  Totals totals_;
};

}  // namespace verisim

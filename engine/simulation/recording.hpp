// What a row of a run file holds (INTERFACES section 2), each fact declared once (base/columns.hpp), and the sums over
// the run. The state hash is that of the row's state, then of those of the frame's links, chained to the hash of the
// row before. Of the state each body has a hash of its own, which stays while its values do: of many bodies few move.
#pragma once

#include <span>
#include <vector>

#include "engine/base/finite.hpp"
#include "engine/record/run_file.hpp"
#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/stages/stages.hpp"
#include "engine/simulation/totals.hpp"

namespace verisim {

class Recording {
 public:
  /// All of it is read once a frame, so it must outlive the recording.
  Recording(const World& world, const Stages& stages, const FrameCost& cost);
  /// Between frames: for so many links in a frame.
  void make_room(std::size_t links) {
    table_.reserve(links * columns_.table_bytes());
    recorded_links_.reserve(links);
    pair_totals_.resize(links);
  }

  /// After a frame: row, sums, hash. Sets FrameCost::links. Error(diverged) with the column if a number is not finite;
  /// sums and hash are then those of the frame before.
  void take(const World& world, const Stages& stages, FrameCost& cost);

  [[nodiscard]] const Schema& schema() const { return schema_; }
  [[nodiscard]] const std::vector<std::byte>& row() const { return row_; }
  /// Bodies that cannot move and of which the row says something else than at rest, ascending: those that are touched.
  [[nodiscard]] std::span<const std::size_t> awake() const { return awake_; }
  /// Calls f(offset, bytes) for all of the row but what bodies at rest have in it.
  template <typename F>
  void each_awake(const F& f) const {
    for (const ByteRange& range : without_rest_) f(range.offset, range.bytes);
    for (const std::size_t i : awake_) columns_.of_part(i, f);
  }
  [[nodiscard]] std::span<const std::byte> table_rows() const { return table_; }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] const Totals& totals() const { return totals_; }
  [[nodiscard]] const PairTotals& totals_of(std::size_t link) const { return pair_totals_[link]; }

 private:
  void take_links(const World& world, const Stages& stages);
  void update_hash(std::span<const std::size_t> written);
  void list_awake(const World& world);
  void check_finite(const World& world) const;
  void add_up(const World& world, const Stages& stages, const FrameCost& cost);
  void add_up_answers(const World& world, const Stages& stages);

  Columns columns_;
  FiniteNumbers state_numbers_, other_numbers_, table_numbers_;
  std::vector<std::byte> rest_;  ///< state of a row in which nothing has happened yet
  Schema schema_;
  std::vector<ByteRange> without_rest_;
  std::vector<std::byte> row_, table_;
  std::vector<bool> is_awake_;  ///< by body
  std::vector<std::size_t> awake_;
  std::vector<std::size_t> recorded_links_;  ///< whose rows the table holds
  std::vector<std::uint64_t> body_hashes_;
  std::uint64_t hash_ = 0;
  Totals totals_;
  std::vector<PairTotals> pair_totals_;  ///< by link
};

}  // namespace verisim

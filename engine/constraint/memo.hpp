// Memoized recognition between the feature sets of two bodies: each pair of sets is recognized once.
//
// Source: dissertation section 6.4.2. One memo per pair of bodies (per collision link). Key: the pair of set ids.
// Value: the constraints recognized between the two sets, also if there are none. Each constraint is stored once,
// however many pairs of sets lead to it, so that pose-dependent state can be kept per constraint.
//
// All memory is allocated at construction, for what the two bodies can need up to stated bounds. Beyond a bound,
// results are computed anew each time and counted in `overflows`; they stay correct.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/pair_map.hpp"
#include "engine/constraint/reduction.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

struct MemoLimits {
  std::size_t pairs = 16384;       ///< of set ids; 60 bytes each
  std::size_t constraints = 4096;  ///< 250 bytes each, with their state in a frame
};

/// Deterministic counts: the same in every run of the same input.
struct MemoCounts {
  std::uint64_t hits = 0;
  std::uint64_t misses_null = 0;        ///< recognition found no constraint
  std::uint64_t misses_constraint = 0;  ///< recognition found at least one
  std::uint64_t recognitions = 0;       ///< pairs of entities that recognition tested
  std::uint64_t overflows = 0;          ///< results and constraints that could not be stored
  [[nodiscard]] std::uint64_t misses() const { return misses_null + misses_constraint; }
};

/// The constraints recognized between two sets, as numbers in the memo.
struct Candidates {
  static constexpr std::size_t kMax = 8;  ///< different constraints at one pair of voxels; further ones are dropped
  std::array<std::uint16_t, kMax> constraint = {};
  std::uint8_t count = 0;
};

class ConstraintMemo {
 public:
  /// `a` and `b` must outlive the memo. @pre the tolerances are finite and not negative
  ConstraintMemo(const EntitySets& a, const EntitySets& b, Reduction reduction, const Tolerances& tolerances,
                 const MemoLimits& limits = {});

  /// The number of the pair's candidates. An id beyond the last set counts as the empty set. No allocation.
  /// Cost: a hit 3 ns; a miss, about 10 ns per pair of entities.
  [[nodiscard]] std::uint32_t look_up(FeatureSetId a, FeatureSetId b) {
    const std::uint32_t known = pairs_.find(a, b);
    if (known == PairMap::kAbsent) return recognize_sets(a, b);
    ++counts_.hits;
    return known;
  }

  /// @pre number < candidates_max(), as look_up gave it
  [[nodiscard]] const Candidates& candidates(std::uint32_t number) const {
    VERISIM_ASSERT(number < candidates_.size());
    return candidates_[number];
  }
  /// @pre number < constraints_known()
  [[nodiscard]] const Constraint& constraint(std::uint32_t number) const {
    VERISIM_ASSERT(number < constraints_known_);
    return constraints_[number];
  }
  /// Numbers of the axial constraints that gate this one if it is planar (reduction.hpp): one for each pair of axes.
  /// None under `exactly_one`. @pre number < constraints_known()
  [[nodiscard]] std::span<const std::uint16_t> gates_of(std::uint32_t number) const {
    VERISIM_ASSERT(number < constraints_known_);
    return {gates_.data() + gates_of_[number].first, gates_of_[number].count};
  }
  [[nodiscard]] const MemoCounts& counts() const { return counts_; }
  void count_hits(std::uint64_t more) { counts_.hits += more; }  ///< look-ups that the caller saved

  [[nodiscard]] std::size_t candidates_max() const { return candidates_.size(); }  ///< numbers that may occur
  [[nodiscard]] std::size_t constraints_max() const { return constraints_.size(); }

 private:
  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  std::uint32_t recognize_sets(FeatureSetId a, FeatureSetId b);
  Candidates candidates_of(FeatureSetId a, FeatureSetId b);
  void add(Candidates& found, std::uint32_t constraint);
  std::uint32_t number_of(std::uint32_t entity_a, std::uint32_t entity_b);
  void find_gates(std::uint32_t planar, std::uint32_t entity_a, std::uint32_t entity_b);
  void add_gate(Range& gates, std::uint32_t round);

  const EntitySets* a_;
  const EntitySets* b_;
  Reduction reduction_;
  Tolerances tolerances_;
  PairMap pairs_;                       ///< (set of A, set of B) -> candidates
  PairMap known_;                       ///< (entity of A, entity of B) -> constraint, or kNone
  std::vector<Candidates> candidates_;  ///< one more than pairs_ can hold: the last is for overflows
  std::vector<Constraint> constraints_;
  std::size_t constraints_known_ = 0;
  std::vector<Range> gates_of_;       ///< by constraint: its gates in gates_
  std::vector<std::uint16_t> gates_;  ///< numbers of constraints
  std::uint32_t gates_known_ = 0;
  MemoCounts counts_;
};

}  // namespace verisim

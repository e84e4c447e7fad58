#include "engine/constraint/memo.hpp"

#include <algorithm>
#include <type_traits>

#include "engine/base/contract.hpp"
#include "engine/constraint/recognition.hpp"

namespace verisim {
namespace {

constexpr std::uint32_t kNone = PairMap::kAbsent - 1;  ///< "recognized: none"; larger than any constraint's number

bool is_edge(const Entity& e) {
  return std::visit(
      [](const auto& bounded) { return std::is_constructible_v<Curve, std::decay_t<decltype(bounded.shape)>>; }, e);
}

constexpr int kRanks = 4;

/// Priority of a candidate when candidates are merged or too many: faces before edges, `other` last.
int rank(const Constraint& c, const Entity& a, const Entity& b) {
  if (c.kind == ConstraintKind::other) return kRanks - 1;
  return int{is_edge(a)} + int{is_edge(b)};
}

}  // namespace

ConstraintMemo::ConstraintMemo(const EntitySets& a, const EntitySets& b, Reduction reduction,
                               const Tolerances& tolerances, const MemoLimits& limits)
    : a_(&a),
      b_(&b),
      reduction_(reduction),
      tolerances_(tolerances),
      pairs_(std::min(limits.pairs, a.size() * b.size())),
      known_(std::min(8 * limits.constraints, a.entities().size() * b.entities().size())),
      candidates_(pairs_.capacity() + 1),
      constraints_(std::min({limits.constraints, a.entities().size() * b.entities().size(), std::size_t{65535}})),
      gates_of_(constraints_.size()),
      gates_(2 * constraints_.size()) {
  VERISIM_ASSERT(is_not_negative(tolerances.clearance_relative_max));
  VERISIM_ASSERT(is_not_negative(tolerances.interference_max));
  VERISIM_ASSERT(is_not_negative(tolerances.half_angle_difference_max));
  VERISIM_ASSERT(is_not_negative(tolerances.core_relative_max));
}

std::uint32_t ConstraintMemo::recognize_sets(FeatureSetId a, FeatureSetId b) {
  const Candidates found = candidates_of(a, b);
  ++(found.count == 0 ? counts_.misses_null : counts_.misses_constraint);
  std::uint32_t number = static_cast<std::uint32_t>(pairs_.size());
  if (pairs_.size() < pairs_.capacity()) {
    pairs_.insert(a, b, number);
  } else {
    ++counts_.overflows;
  }
  candidates_[number] = found;
  return number;
}

Candidates ConstraintMemo::candidates_of(FeatureSetId a, FeatureSetId b) {
  Candidates found;
  std::size_t recognized = 0;
  for (int wanted = 0; wanted < kRanks; ++wanted) {
    for (const std::uint32_t entity_a : a_->set(a)) {
      for (const std::uint32_t entity_b : b_->set(b)) {
        const std::uint32_t number = number_of(entity_a, entity_b);
        if (number == kNone) continue;
        if (rank(constraints_[number], a_->entity(entity_a), b_->entity(entity_b)) != wanted) continue;
        ++recognized;
        add(found, number);
      }
    }
  }
  if (reduction_ == Reduction::exactly_one) {
    if (recognized != 1) found.count = 0;
    return found;
  }
  return found;
}

void ConstraintMemo::add(Candidates& found, std::uint32_t constraint) {
  if (reduction_ == Reduction::common_freedom) {
    for (std::size_t i = 0; i < found.count; ++i) {
      if (same_axes(constraints_[found.constraint[i]], constraints_[constraint])) return;
    }
  }
  if (found.count == Candidates::kMax) {
    ++counts_.overflows;
    return;
  }
  found.constraint[found.count++] = static_cast<std::uint16_t>(constraint);
}

std::uint32_t ConstraintMemo::number_of(std::uint32_t entity_a, std::uint32_t entity_b) {
  std::uint32_t number = known_.find(entity_a, entity_b);
  if (number != PairMap::kAbsent) return number;
  ++counts_.recognitions;
  const Constraint c = recognize(a_->entity(entity_a), b_->entity(entity_b), tolerances_);
  number = kNone;
  if (c.kind != ConstraintKind::none) {
    if (constraints_known_ < constraints_.size()) {
      number = static_cast<std::uint32_t>(constraints_known_++);
      constraints_[number] = c;
    } else {
      ++counts_.overflows;
    }
  }
  if (known_.size() < known_.capacity()) known_.insert(entity_a, entity_b, number);
  if (number != kNone && c.kind == ConstraintKind::planar && reduction_ == Reduction::common_freedom) {
    find_gates(number, entity_a, entity_b);
  }
  return number;
}

/// Finds the gates of a planar constraint among the curved faces and rims at both planes.
void ConstraintMemo::find_gates(std::uint32_t planar, std::uint32_t entity_a, std::uint32_t entity_b) {
  Range gates{gates_known_, 0};
  for (const std::uint32_t round_a : a_->curved_neighbors(entity_a)) {
    for (const std::uint32_t round_b : b_->curved_neighbors(entity_b)) {
      const std::uint32_t number = number_of(round_a, round_b);
      if (number != kNone && is_gated_by(constraints_[planar], constraints_[number])) add_gate(gates, number);
    }
  }
  gates_of_[planar] = gates;
}

void ConstraintMemo::add_gate(Range& gates, std::uint32_t round) {
  for (std::uint32_t i = gates.first; i < gates_known_; ++i) {
    if (same_axes(constraints_[gates_[i]], constraints_[round])) return;
  }
  if (gates_known_ == gates_.size()) {
    ++counts_.overflows;
    return;
  }
  gates_[gates_known_++] = static_cast<std::uint16_t>(round);
  ++gates.count;
}

}  // namespace verisim

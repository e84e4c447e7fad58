#include "engine/constraint/memo.hpp"

#include <algorithm>
#include <type_traits>

#include "engine/constraint/recognition.hpp"

namespace verisim {
namespace {

constexpr std::uint32_t kNone = PairMap::kAbsent - 1;  ///< "recognized: nothing"; more than any constraint's number

bool is_edge(const Entity& e) {
  return std::visit(
      [](const auto& bounded) { return std::is_constructible_v<Curve, std::decay_t<decltype(bounded.shape)>>; }, e);
}

constexpr int kRanks = 4;

/// Faces before edges, lower kinds before `other`: what stays when candidates are merged or more than there is room
/// for.
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
      constraints_(std::min({limits.constraints, a.entities().size() * b.entities().size(), std::size_t{65535}})) {}

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
  for (std::size_t i = 0; i < found.count; ++i) {
    for (std::size_t j = 0; j < found.count; ++j) {
      if (!hands_over(constraints_[found.constraint[i]], constraints_[found.constraint[j]])) continue;
      found.yields_to[i] = static_cast<std::uint8_t>(found.yields_to[i] | (1U << j));
    }
  }
  return found;
}

void ConstraintMemo::add(Candidates& found, std::uint32_t constraint) const {
  if (found.count == Candidates::kMax) return;
  if (reduction_ == Reduction::common_freedom) {
    for (std::size_t i = 0; i < found.count; ++i) {
      if (same_axes(constraints_[found.constraint[i]], constraints_[constraint])) return;
    }
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
  return number;
}

}  // namespace verisim

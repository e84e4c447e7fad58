// A second recognizer for a pair of types, in an order to be chosen.
#pragma once

#include "engine/constraint/recognizers.hpp"

namespace verisim {

template <typename A, typename B>
struct Another {
  using First = A;
  using Second = B;
  static constexpr ConstraintKind kKind = ConstraintKind::other;
  static bool matches(const Bounded<A>&, const Bounded<B>&, const Tolerances&) { return true; }
  static Constraint make(const Bounded<A>&, const Bounded<B>&) { return {}; }
};

/// Makes the compiler look at the list.
template <typename List>
inline constexpr std::size_t kLookedAt = List::kSize;

}  // namespace verisim

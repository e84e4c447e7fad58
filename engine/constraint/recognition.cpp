#include "engine/constraint/recognition.hpp"

#include "engine/constraint/recognizers.hpp"

namespace verisim {

Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances) {
  return recognize_by<Recognizers>(a, b, tolerances);
}

std::vector<Match> recognize_all(std::span<const Entity> a, std::span<const Entity> b, const Tolerances& tolerances) {
  const SortedSet<Entity> sorted_a(a);
  const SortedSet<Entity> sorted_b(b);
  std::vector<Match> matches(a.size() * b.size() + 1);
  matches.resize(match_sets<Recognizers>(sorted_a, sorted_b, tolerances, matches));
  return matches;
}

}  // namespace verisim

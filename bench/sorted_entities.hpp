// What recognition would cost if whole sets were recognized at once: entities sorted by type, so that the question
// "which recognizer?" is asked once per block of two types and not once per pair, and blocks that have none cost
// nothing. The engine meets its pairs one by one and remembers them; this is what its cost per pair is compared with.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/constraint/multi_method.hpp"

namespace verisim::bench {

/// A pair of entities that fit, by their numbers in the two sets. Six bytes.
struct Match {
  std::uint16_t a, b;
  ConstraintKind kind;
  friend bool operator==(const Match&, const Match&) = default;
};

template <typename Variant>
class SortedSet;

/// The entities of one set, type after type; within a type in the order given. At most 65,535 entities.
template <typename... Shape>
class SortedSet<std::variant<Bounded<Shape>...>> {
 public:
  using Variant = std::variant<Bounded<Shape>...>;
  template <typename S>
  struct Block {
    std::vector<Bounded<S>> entities;
    std::vector<std::uint16_t> numbers;  ///< of each entity in the set as given
  };

  explicit SortedSet(std::span<const Variant> entities) : size_(entities.size()) {
    VERISIM_ASSERT(size_ <= 0xFFFF);
    for (std::size_t i = 0; i < size_; ++i) {
      std::visit(
          [&]<typename S>(const Bounded<S>& e) {
            auto& block = std::get<Block<S>>(blocks_);
            block.entities.push_back(e);
            block.numbers.push_back(static_cast<std::uint16_t>(i));
          },
          entities[i]);
    }
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  template <typename S>
  [[nodiscard]] const Block<S>& block() const {
    return std::get<Block<S>>(blocks_);
  }

 private:
  std::size_t size_;
  std::tuple<Block<Shape>...> blocks_;
};

/// Writes every pair and keeps it only if it fits: no branch for the processor to guess.
template <typename List, typename A, typename B, typename Set>
inline Match* match_block(const Set& a, const Set& b, const Tolerances& tolerances, Match* out) {
  using Recognizer = typename List::template For<A, B>;
  if constexpr (!std::is_void_v<Recognizer>) {
    const auto& rows = a.template block<A>();
    const auto& columns = b.template block<B>();
    for (std::size_t i = 0; i < rows.entities.size(); ++i) {
      for (std::size_t j = 0; j < columns.entities.size(); ++j) {
        *out = {rows.numbers[i], columns.numbers[j], Recognizer::kKind};
        out += recognizing::match<List>(rows.entities[i], columns.entities[j], tolerances) ? 1 : 0;
      }
    }
  }
  return out;
}

template <typename List, typename... Shape, typename Set>
Match* match_all(const Set& a, const Set& b, const Tolerances& tolerances, Match* out,
                 TypeOf<std::variant<Bounded<Shape>...>> /*types*/) {
  const auto row = [&]<typename A>(TypeOf<A> /*type*/) {
    ((out = match_block<List, A, Shape>(a, b, tolerances, out)), ...);
  };
  (row(TypeOf<Shape>()), ...);
  return out;
}

/// All pairs that fit, type block after type block; returns how many. About half a nanosecond per pair; no allocation.
/// @pre matches.size() > a.size() * b.size(): one place more than there are pairs
template <typename List, typename Variant>
[[nodiscard]] std::size_t match_sets(const SortedSet<Variant>& a, const SortedSet<Variant>& b,
                                     const Tolerances& tolerances, std::span<Match> matches) {
  VERISIM_ASSERT(matches.size() > a.size() * b.size());
  const Match* end = match_all<List>(a, b, tolerances, matches.data(), TypeOf<Variant>());
  return static_cast<std::size_t>(end - matches.data());
}

}  // namespace verisim::bench

// A function of two arguments that is chosen by the types of both (a multi-method) over the closed variant Entity.
//
// Source: dissertation chapter 7, whose engine used Boost.Variant and specializations of a class template. Here a
// recognizer is a struct, and the list of recognizers is a type:
//
//     struct CircleCylinder {                       // recognize/circle_cylinder.hpp
//       using First = Circle;
//       using Second = Cylinder;
//       static constexpr ConstraintKind kKind = ConstraintKind::cylindrical;
//       static bool matches(const Bounded<First>&, const Bounded<Second>&, const Tolerances&);     // sizes and roles
//       static Constraint make(const Bounded<First>&, const Bounded<Second>&);     // only asked if they match
//     };
//     using Recognizers = RecognizerList<PlanePlane, CircleCylinder, ...>;          // recognizers.hpp
//
// Decided at compile time: a recognizer of (First, Second) also serves (Second, First), with the sides swapped. A pair
// with two recognizers, in either order, does not compile. A pair without one costs a table look-up.
//
// Cost of a pair: one table look-up and one indirect call, as std::visit over two variants. No allocation.
#pragma once

#include <array>
#include <string_view>
#include <type_traits>
#include <utility>

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

template <typename Shape>
struct TypeOf {
  using type = Shape;
};

namespace recognizing {

template <typename Recognizer, typename A, typename B>
inline constexpr bool kServesAsWritten =
    std::is_same_v<typename Recognizer::First, A>&& std::is_same_v<typename Recognizer::Second, B>;

/// In either order; a pair of equal types counts once.
template <typename Recognizer, typename A, typename B>
inline constexpr bool kServes = kServesAsWritten<Recognizer, A, B> || kServesAsWritten<Recognizer, B, A>;

/// The one recognizer of the list that serves (A, B), or void.
template <typename A, typename B, typename... Recognizer>
struct Find {
  using type = void;
};
template <typename A, typename B, typename First, typename... Rest>
struct Find<A, B, First, Rest...> : std::conditional_t<kServes<First, A, B>, TypeOf<First>, Find<A, B, Rest...>> {};

template <typename Recognizer, typename... All>
inline constexpr bool kStandsAlone = (int{kServes<All, typename Recognizer::First, typename Recognizer::Second>} +
                                      ...) == 1;

}  // namespace recognizing

template <typename... Recognizer>
struct RecognizerList {
  static_assert((recognizing::kStandsAlone<Recognizer, Recognizer...> && ...),
                "this pair of entity types is already recognized (in this order or in the other)");

  static constexpr std::size_t kSize = sizeof...(Recognizer);
  template <typename... More>
  using With = RecognizerList<Recognizer..., More...>;
  /// The recognizer of (A, B) in either order; void: none.
  template <typename A, typename B>
  using For = typename recognizing::Find<A, B, Recognizer...>::type;
};

namespace recognizing {

/// True if a pair fits by size and role, in either order.
template <typename List, typename A, typename B>
[[nodiscard]] inline bool match(const Bounded<A>& a, const Bounded<B>& b, const Tolerances& tolerances) {
  using Recognizer = typename List::template For<A, B>;
  if constexpr (kServesAsWritten<Recognizer, A, B>) {
    return Recognizer::matches(a, b, tolerances);
  } else {
    return Recognizer::matches(b, a, tolerances);
  }
}

template <typename List, typename A, typename B>
[[nodiscard]] inline Constraint make(const Bounded<A>& a, const Bounded<B>& b) {
  using Recognizer = typename List::template For<A, B>;
  if constexpr (kServesAsWritten<Recognizer, A, B>) {
    return Recognizer::make(a, b);
  } else {
    return mirrored(Recognizer::make(b, a));
  }
}

/// Alternative I of a variant without the check of std::get.
template <std::size_t I, typename Variant>
[[nodiscard]] inline const auto& known_to_be(const Variant& v) {
  const auto* alternative = std::get_if<I>(&v);
  if (alternative == nullptr) __builtin_unreachable();
  return *alternative;
}

template <typename Variant>
using Cell = Constraint (*)(const Variant&, const Variant&, const Tolerances&);

/// One cell of the matrix: a function, or nullptr where nothing is recognized.
template <typename List, typename Variant, std::size_t I, std::size_t J>
constexpr Cell<Variant> cell() {
  using A = decltype(std::variant_alternative_t<I, Variant>::shape);
  using B = decltype(std::variant_alternative_t<J, Variant>::shape);
  if constexpr (std::is_void_v<typename List::template For<A, B>>) {
    return nullptr;
  } else {
    return +[](const Variant& a, const Variant& b, const Tolerances& tolerances) {
      const auto& first = known_to_be<I>(a);
      const auto& second = known_to_be<J>(b);
      if (!match<List>(first, second, tolerances)) return Constraint();
      return make<List>(first, second);
    };
  }
}

template <typename List, typename Variant, std::size_t... K>
constexpr auto table(std::index_sequence<K...>) {
  constexpr std::size_t n = std::variant_size_v<Variant>;
  return std::array<Cell<Variant>, n * n>{cell<List, Variant, K / n, K % n>()...};
}

template <typename List, typename Variant>
inline constexpr auto kTable =
    table<List, Variant>(std::make_index_sequence<std::variant_size_v<Variant> * std::variant_size_v<Variant>>());

}  // namespace recognizing

/// The constraint of a pair of entities, in either order; kind `none` if the list has no recognizer for their types or
/// if sizes or roles do not fit. `Variant` is Entity or any other variant of Bounded shapes.
template <typename List, typename Variant>
[[nodiscard]] inline Constraint recognize_by(const Variant& a, const Variant& b, const Tolerances& tolerances) {
  constexpr std::size_t n = std::variant_size_v<Variant>;
  const auto cell = recognizing::kTable<List, Variant>[a.index() * n + b.index()];
  if (cell == nullptr) return {};
  return cell(a, b, tolerances);
}

/// One letter per cell of the matrix that a list spans, row by row: the initial of the constraint's kind, '-' for none,
/// '.' for what the mirrored cell says. To be compared with the drawing in recognizers.hpp.
template <typename List, typename Variant>
[[nodiscard]] consteval auto drawing_of() {
  constexpr std::size_t n = std::variant_size_v<Variant>;
  std::array<std::array<char, n>, n> drawing{};
  const auto draw = [&]<std::size_t I, std::size_t J>() {
    using A = decltype(std::variant_alternative_t<I, Variant>::shape);
    using B = decltype(std::variant_alternative_t<J, Variant>::shape);
    using Recognizer = typename List::template For<A, B>;
    if constexpr (J < I) {
      drawing[I][J] = '.';
    } else if constexpr (std::is_void_v<Recognizer>) {
      drawing[I][J] = '-';
    } else {
      constexpr std::string_view kInitials = "-PCKSAO";  // K: conical
      drawing[I][J] = kInitials[static_cast<std::size_t>(Recognizer::kKind)];
    }
  };
  [&]<std::size_t... K>(std::index_sequence<K...>) {
    (draw.template operator()<K / n, K % n>(), ...);
  }
  (std::make_index_sequence<n * n>());
  return drawing;
}

}  // namespace verisim

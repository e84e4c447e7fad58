// One callable of several, to ask std::visit for each alternative of a variant by its type.
//
//   std::visit(Overloaded{[](const Line& l) { … }, [](const Circle& c) { … }}, curve)
//
// A variant with an alternative that no callable takes does not compile: write one per alternative and none for all of
// them (`auto`), so that a new kind of entity is met everywhere.
#pragma once

namespace verisim {

template <typename... Callable>
struct Overloaded : Callable... {
  using Callable::operator()...;
};
template <typename... Callable>
Overloaded(Callable...) -> Overloaded<Callable...>;

}  // namespace verisim

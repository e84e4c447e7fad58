// The messages between verisim and its CAD child process: named groups of tables as bytes, in native byte order (both
// run on one machine). A request is one group "request"; an answer is one group per part, named after it, or one
// group "error" (see cad/main.cpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/named_array.hpp"
#include "engine/geometry/solid.hpp"

namespace verisim {

struct Group {
  std::string name;
  std::vector<NamedArray> tables;
};
using Message = std::vector<Group>;

[[nodiscard]] std::string encode(const Message& message);

/// Throws Error(input) if the bytes are not a whole message: never reads or allocates beyond them.
[[nodiscard]] Message decode(std::string_view bytes);

/// The argument with which the CAD program takes one request after the other until there are no more. Each, and each
/// answer, then has its length before it (8 bytes).
inline constexpr const char* kManyRequests = "many";
[[nodiscard]] std::string with_length(std::string_view bytes);
/// What follows the length; nothing if not all of it is there yet.
[[nodiscard]] std::optional<std::string_view> after_length(std::string_view bytes);

/// A text as a table of bytes, and the table called `name` as a text. Throws Error(input) if there is none.
[[nodiscard]] NamedArray text_table(std::string name, std::string_view text);
[[nodiscard]] std::string text_of(const Group& group, std::string_view name);

/// The first value of the table called `name`. Throws Error(input) if there is none.
[[nodiscard]] double number_of(const Group& group, std::string_view name);
[[nodiscard]] NamedArray number_table(std::string name, double value);

/// A solid's tree in post-order, and back. @pre no child is null
[[nodiscard]] std::vector<NamedArray> tables_of(const Solid& solid);
[[nodiscard]] Solid solid_from(const Group& group);

}  // namespace verisim

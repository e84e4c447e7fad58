// One value of a batch's tables: nothing, a whole number, a number or a text.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "engine/base/json.hpp"

namespace verisim::batch {

using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// As a field of CSV (RFC 4180): the shortest digits that give the number back, a text in quotes where it needs them.
[[nodiscard]] std::string csv_field(const Cell& cell);
/// As people read it, and as CSV has it but for the quotes.
[[nodiscard]] std::string plain_text(const Cell& cell);

[[nodiscard]] Json json_of(const Cell& cell);
/// A scalar of JSON; true and false are texts, a list or an object is its JSON text.
[[nodiscard]] Cell cell_of(const Json& json);
/// A whole number where it fits 63 bits, else its digits as text: a table of SQLite holds no more.
[[nodiscard]] Cell cell_of(std::uint64_t number);

}  // namespace verisim::batch

// How the command line writes lists of values.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace verisim::batch {

/// The parts of `text` between those `separator`s that are outside of brackets and quotes. Never empty: "" is one empty
/// part.
[[nodiscard]] std::vector<std::string> split_outside_brackets(const std::string& text, char separator);

/// "KEY=TEXT" at the first '='. Error(usage) that begins with `option` if there is none, or the key is empty.
[[nodiscard]] std::pair<std::string, std::string> split_key(const std::string& option, const std::string& text);

/// Decimal digits alone, up to 2^64 - 1. Error(`input`: a file says it, or wrong usage) that begins with `what`.
[[nodiscard]] std::uint64_t whole_number(const std::string& what, const std::string& text, bool input = false);

/// Whole numbers as people list them: "0, 3 to 5, 9"; of more than `most` ranges the first, and how many there are.
[[nodiscard]] std::string ranges_text(const std::vector<std::uint64_t>& sorted, std::size_t most = 12);

}  // namespace verisim::batch

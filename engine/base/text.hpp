// Texts from outside (scripts, command lines, files) that end in a run file, in JSON or on a terminal. Names are
// doubted where they enter: name_fault. What is only said (events, messages, prints) is made harmless: shown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace verisim {

inline constexpr std::size_t kLongestName = 200;       ///< bytes
inline constexpr std::size_t kLongestValue = 1 << 16;  ///< bytes
inline constexpr std::size_t kLongestShown = 1000;     ///< bytes

/// What makes `text` unfit to be a name (of a body, a measure, an outcome, a file): "is not UTF-8 (byte 0xff at 3)",
/// has a control character, is longer than kLongestName. Empty if nothing does. Quotes and backslashes are fit.
[[nodiscard]] std::string name_fault(std::string_view text);

/// The same for a value, of kLongestValue bytes at most, which may have lines and tabs.
[[nodiscard]] std::string value_fault(std::string_view text);

/// The same, of any length and without control characters: one argument of a command line.
[[nodiscard]] std::string line_fault(std::string_view text);

/// `text` as one harmless line of UTF-8: control characters but the tab, and bytes that are not UTF-8, become \n, \x1b;
/// what is beyond `longest` bytes is left out and counted.
[[nodiscard]] std::string shown(std::string_view text, std::size_t longest = kLongestShown);

/// The same for a terminal, which may have lines.
[[nodiscard]] std::string shown_lines(std::string_view text);

/// The line, from 1, in which the byte of that number, from 1, stands; of one behind the end the last.
[[nodiscard]] std::size_t line_of_byte(std::string_view text, std::size_t byte);

/// The longest begin of `text` of at most `longest` bytes that cuts no character in two.
[[nodiscard]] std::string_view begin_of(std::string_view text, std::size_t longest);

}  // namespace verisim

#include "engine/batch/design_text.hpp"

#include <fmt/format.h>

#include <charconv>

#include "engine/base/error.hpp"

namespace verisim::batch {

std::vector<std::string> split_outside_brackets(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '[' || c == '{') {
      ++depth;
    } else if (c == ')' || c == ']' || c == '}') {
      --depth;
    } else if (c == separator && depth <= 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
  }
  return parts;
}

std::pair<std::string, std::string> split_key(const std::string& option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) fail(ErrorKind::usage, "{} {}: write it as KEY=…", option, text);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::uint64_t whole_number(const std::string& what, const std::string& text, bool input) {
  std::uint64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end)
    fail(input ? ErrorKind::input : ErrorKind::usage, "{}: '{}' is no whole number; decimal digits alone are", what,
         text);
  return number;
}

std::string ranges_text(const std::vector<std::uint64_t>& sorted, std::size_t most) {
  std::string text;
  std::size_t ranges = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t last = i;
    while (last + 1 < sorted.size() && sorted[last + 1] == sorted[last] + 1) ++last;
    if (ranges++ < most) {
      text += text.empty() ? "" : ", ";
      text += last == i ? fmt::format("{}", sorted[i]) : fmt::format("{} to {}", sorted[i], sorted[last]);
    }
    i = last + 1;
  }
  if (ranges > most) text += fmt::format(", … ({} in all)", sorted.size());
  return text;
}

}  // namespace verisim::batch

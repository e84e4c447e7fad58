#include "engine/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace verisim {
namespace {

struct Character {
  std::size_t size;    ///< bytes; 1 for one that is not UTF-8
  std::uint32_t code;  ///< of Unicode
  bool is_utf8 = true;
};

/// The character that begins at `at`. Overlong forms, surrogates and codes beyond Unicode's are not UTF-8.
Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(at);
  if (first < 0x80) return {1, first};
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const Character wrong{1, first, false};
  if (first < 0xc2 || first > 0xf4 || at + size > text.size()) return wrong;
  std::uint32_t code = first & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(at + i) & 0xc0U) != 0x80) return wrong;
    code = (code << 6) | (byte(at + i) & 0x3fU);
  }
  if (code < kLeast[size] || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) return wrong;
  return {size, code};
}

bool is_control(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

std::string fault(std::string_view text, std::size_t longest, bool lines) {
  if (text.size() > longest) return fmt::format("is {} bytes long; {} are allowed", text.size(), longest);
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    if (!c.is_utf8) return fmt::format("is not UTF-8 (byte 0x{:02x} at {})", c.code, at + 1);
    if (is_control(c.code) && !(lines && (c.code == '\n' || c.code == '\t')))
      return fmt::format("has a control character (0x{:02x} at {})", c.code, at + 1);
    at += c.size;
  }
  return {};
}

}  // namespace

std::string name_fault(std::string_view text) {
  return fault(text, kLongestName, false);
}
std::string value_fault(std::string_view text) {
  return fault(text, kLongestValue, true);
}
std::string line_fault(std::string_view text) {
  return fault(text, text.size(), false);
}

std::size_t line_of_byte(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

std::string_view begin_of(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80) --end;
  return text.substr(0, end);
}

namespace {

std::string escaped(std::string_view text, std::size_t longest, bool lines) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    if (line.size() >= longest) return line + fmt::format("… ({} more bytes)", text.size() - at);
    const Character c = character_at(text, at);
    if (c.code == '\t' || (lines && c.code == '\n'))
      line += static_cast<char>(c.code);
    else if (c.code == '\n')
      line += "\\n";
    else if (!c.is_utf8 || is_control(c.code))
      line += fmt::format("\\x{:02x}", c.code);
    else
      line += text.substr(at, c.size);
    at += c.size;
  }
  return line;
}

}  // namespace

std::string shown(std::string_view text, std::size_t longest) {
  return escaped(text, longest, false);
}
std::string shown_lines(std::string_view text) {
  return escaped(text, kLongestValue, true);
}

}  // namespace verisim

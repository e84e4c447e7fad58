#include <fmt/format.h>

#include <algorithm>

#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

constexpr std::size_t kWide = 100;  ///< columns that a reason may take

std::string text_of(const Figure& figure, const std::string& unit) {
  if (const auto* words = std::get_if<std::string>(&figure)) return *words;
  return fmt::format("{:.5g}{}{}", std::get<double>(figure), unit.empty() ? "" : " ", unit);
}

/// `text` broken between words into lines of at most kWide, each indented.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string lines;
  std::string line;
  const auto flush = [&] {
    if (!line.empty()) lines += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    if (line.size() + 1 + end - at > kWide) flush();
    line += (line.empty() ? "" : " ") + text.substr(at, end - at);
    at = end + 1;
  }
  flush();
  return lines;
}

}  // namespace

std::string table_of(const std::vector<Row>& rows) {
  std::size_t what = 4;
  std::size_t published = 9;
  std::size_t here = 4;
  for (const Row& r : rows) {
    what = std::max(what, r.what.size());
    published = std::max(published, text_of(r.published, r.unit).size());
    here = std::max(here, text_of(r.here, r.unit).size());
  }
  std::string text = fmt::format("{:<5}{:<{}}  {:>{}}  {:>{}}  {:>8}\n", "", "what", what, "published", published,
                                 "here", here, "ratio");
  for (const Row& r : rows) {
    const std::optional<double> q = ratio(r);
    text += fmt::format("{:<5}{:<{}}  {:>{}}  {:>{}}  {:>8}\n", r.id, r.what, what, text_of(r.published, r.unit),
                        published, text_of(r.here, r.unit), here, q ? fmt::format("{:.4g}", *q) : "-");
    text += wrapped(r.why, 5);
  }
  return text;
}

}  // namespace verisim::reproduce

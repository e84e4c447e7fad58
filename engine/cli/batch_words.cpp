#include "engine/cli/batch_words.hpp"

#include <fmt/format.h>

#include <sstream>

#include "engine/base/text.hpp"

namespace verisim::cli {
namespace {

constexpr std::size_t kLinesMax = 20;

/// The run's name stands behind the word that says how grave a line is.
std::string with_name(const std::string& line, const std::string& name) {
  for (const char* word : {"warning: ", "error: ", "note: "})
    if (line.starts_with(word)) return word + name + ": " + line.substr(std::string(word).size());
  return name + ": " + line;
}

}  // namespace

std::vector<std::string> RunWords::take(std::uint64_t run, const std::string& name, const std::string& words) {
  std::vector<std::string> lines;
  std::istringstream text(words);
  for (std::string line; std::getline(text, line);) {
    if (const auto known = said_.find(line); known != said_.end()) {
      if (known->second.first != run) ++known->second.more;
      continue;
    }
    if (said_.size() < kLinesMax) {
      said_[line] = {run, 0};
      lines.push_back(with_name(shown(line), name));
    } else if (!is_full_) {
      is_full_ = true;
      lines.emplace_back("what runs say further is not shown; the column warning of index.csv has their first");
    }
  }
  return lines;
}

std::vector<std::string> RunWords::rest() const {
  constexpr std::size_t kBegin = 80;  // of the line
  std::vector<std::string> lines;
  for (const auto& [line, said] : said_)
    if (said.more > 0)
      lines.push_back(fmt::format("note: {} more run{} what run {} says: {}", said.more,
                                  said.more == 1 ? " says" : "s say", said.first, shown(line, kBegin)));
  return lines;
}

}  // namespace verisim::cli

// The work of compiling a text, found by going through its tokens. Lua's compiler takes more than linear time for two
// things: a name is looked for in every function around it, and the jumps of "and", "or", "break" and "elseif" stand in
// lists that are walked through for each that is added.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/script/work.hpp"

namespace verisim::script {
namespace {

constexpr std::uint64_t kWorkPerByte = 4;
constexpr std::uint64_t kWorkPerName = 40;  // in each function around it, which may have 200 names of its own
constexpr std::uint64_t kJumpsPerWork = 16;

class SourceReader {
 public:
  explicit SourceReader(std::string_view text) : text_(text) {}

  std::uint64_t work() {
    while (at_ < text_.size()) token();
    return kWorkPerByte * text_.size() + names_ + jumps_ * jumps_ / kJumpsPerWork;
  }

 private:
  void token() {
    const char c = text_[at_];
    if (is_word(c)) {
      word();
    } else if (c == '-' && next_is(1, '-')) {
      at_ += 2;
      if (!long_bracket()) skip_to('\n');
    } else if (c == '"' || c == '\'') {
      quoted(c);
    } else if (c != '[' || !long_bracket()) {
      ++at_;
    }
  }

  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
  [[nodiscard]] bool next_is(std::size_t ahead, char c) const {
    return at_ + ahead < text_.size() && text_[at_ + ahead] == c;
  }
  void skip_to(char c) {
    const std::size_t found = text_.find(c, at_);
    at_ = found == std::string_view::npos ? text_.size() : found;
  }

  // [[ … ]] or [==[ … ]==] from here.
  bool long_bracket() {
    if (!next_is(0, '[')) return false;
    std::size_t level = 0;
    while (next_is(1 + level, '=')) ++level;
    if (!next_is(1 + level, '[')) return false;
    at_ += level + 2;
    while (at_ < text_.size()) {
      skip_to(']');
      std::size_t closing = 0;
      while (next_is(1 + closing, '=')) ++closing;
      const bool closed = closing == level && next_is(1 + closing, ']');
      at_ = std::min(text_.size(), at_ + (closed ? closing + 2 : closing + 1));
      if (closed) break;
    }
    return true;
  }

  void quoted(char quote) {
    for (++at_; at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n'; ++at_)
      if (text_[at_] == '\\') ++at_;
    if (at_ < text_.size()) ++at_;
  }

  void word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (name == "function") {
      blocks_.push_back(true);
      ++functions_;
    } else if (name == "do" || name == "if") {
      blocks_.push_back(false);
    } else if (name == "end" && !blocks_.empty()) {
      if (blocks_.back()) --functions_;
      blocks_.pop_back();
    }
    for (const std::string_view jump : {"and", "or", "break", "if", "elseif", "else", "while", "for", "return", "not"})
      if (name == jump) ++jumps_;
    names_ += kWorkPerName * functions_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<bool> blocks_;  ///< those that "end" closes: is it a function's?
  std::uint64_t functions_ = 1;
  std::uint64_t names_ = 0;
  std::uint64_t jumps_ = 0;
};

}  // namespace

std::uint64_t work_of_compiling(const char* text, std::uint64_t size) {
  return SourceReader({text, size}).work();
}

}  // namespace verisim::script

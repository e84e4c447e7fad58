#include "engine/script/lua_pattern.hpp"

#include <algorithm>
#include <cctype>

#include "engine/base/error.hpp"
#include "engine/script/work.hpp"

namespace verisim::script {
namespace {

constexpr std::ptrdiff_t kNoMatch = -1;

bool class_matches(unsigned char c, unsigned char letter) {
  bool member = false;
  switch (std::tolower(letter)) {
    case 'a':
      member = std::isalpha(c) != 0;
      break;
    case 'c':
      member = std::iscntrl(c) != 0;
      break;
    case 'd':
      member = std::isdigit(c) != 0;
      break;
    case 'l':
      member = std::islower(c) != 0;
      break;
    case 'p':
      member = std::ispunct(c) != 0;
      break;
    case 's':
      member = std::isspace(c) != 0;
      break;
    case 'u':
      member = std::isupper(c) != 0;
      break;
    case 'w':
      member = std::isalnum(c) != 0;
      break;
    case 'x':
      member = std::isxdigit(c) != 0;
      break;
    case 'z':
      member = c == 0;
      break;
    default:
      return letter == c;
  }
  return std::isupper(letter) != 0 ? !member : member;
}

}  // namespace

PatternMatcher::PatternMatcher(std::string_view subject, std::string_view pattern, std::uint64_t steps_max)
    : subject_(subject),
      pattern_(pattern),
      anchored_(!pattern.empty() && pattern.front() == '^'),
      steps_max_(steps_max) {
  if (anchored_) pattern_.remove_prefix(1);
}

std::ptrdiff_t PatternMatcher::match_at(std::ptrdiff_t start) {
  VERISIM_ASSERT(start >= 0);
  VERISIM_ASSERT(start <= static_cast<std::ptrdiff_t>(subject_.size()));
  captures_.clear();
  depth_ = 0;
  return match(start, 0);
}

void PatternMatcher::step(std::uint64_t steps) {
  work.used += steps;
  steps_ += steps;
  if (steps_ > steps_max_)
    fail(ErrorKind::input,
         "the pattern '{}' takes more than {} steps on a text of {} bytes; make it simpler or the text shorter",
         pattern_.substr(0, 40), steps_max_, subject_.size());
}

// The item (one character, class or set) at p ends before the returned position.
std::size_t PatternMatcher::item_end(std::size_t p) {
  const char first = pattern_[p++];
  if (first == '%') {
    if (p == pattern_.size()) fail(ErrorKind::input, "malformed pattern (ends with '%')");
    return p + 1;
  }
  if (first != '[') return p;
  const std::size_t begin = p;
  if (p < pattern_.size() && pattern_[p] == '^') ++p;
  do {  // a ']' right at the begin stands for itself
    if (p == pattern_.size()) fail(ErrorKind::input, "malformed pattern (missing ']')");
    if (pattern_[p++] == '%' && p < pattern_.size()) ++p;
  } while (p >= pattern_.size() || pattern_[p] != ']');
  step((p - begin) / 4);
  return p + 1;
}

// The set from the '[' at p to the ']' at last.
bool PatternMatcher::set_matches(unsigned char c, std::size_t p, std::size_t last) {
  step((last - p) / 2);
  const bool complement = pattern_[p + 1] == '^';
  for (std::size_t i = complement ? p + 2 : p + 1; i < last; ++i) {
    const auto letter = static_cast<unsigned char>(pattern_[i]);
    if (letter == '%' && i + 1 < last) {
      if (class_matches(c, static_cast<unsigned char>(pattern_[++i]))) return !complement;
    } else if (i + 2 < last && pattern_[i + 1] == '-') {
      i += 2;
      if (letter <= c && c <= static_cast<unsigned char>(pattern_[i])) return !complement;
    } else if (letter == c) {
      return !complement;
    }
  }
  return complement;
}

bool PatternMatcher::item_matches(std::ptrdiff_t s, std::size_t p, std::size_t end) {
  step();
  if (s >= static_cast<std::ptrdiff_t>(subject_.size())) return false;
  const auto c = static_cast<unsigned char>(subject_[static_cast<std::size_t>(s)]);
  switch (pattern_[p]) {
    case '.':
      return true;
    case '%':
      return class_matches(c, static_cast<unsigned char>(pattern_[p + 1]));
    case '[':
      return set_matches(c, p, end - 1);
    default:
      return static_cast<unsigned char>(pattern_[p]) == c;
  }
}

std::ptrdiff_t PatternMatcher::match(std::ptrdiff_t s, std::size_t p) {
  if (++depth_ > kDepthMax) fail(ErrorKind::input, "the pattern is too complex (more than {} nested items)", kDepthMax);
  struct Leave {
    int& depth;
    ~Leave() { --depth; }
  } const leave{depth_};
  while (p < pattern_.size()) {
    step();
    const char letter = pattern_[p];
    if (letter == '(') return match_capture_start(s, p);
    if (letter == ')') return match_capture_end(s, p);
    if (letter == '$' && p + 1 == pattern_.size())
      return s == static_cast<std::ptrdiff_t>(subject_.size()) ? s : kNoMatch;
    if (letter == '%' && p + 1 < pattern_.size()) {
      const char second = pattern_[p + 1];
      if (second == 'b') return match_balanced(s, p);
      if (second == 'f') return match_frontier(s, p);
      if (std::isdigit(static_cast<unsigned char>(second)) != 0) return match_back_reference(s, p);
    }
    const std::size_t end = item_end(p);
    if (end < pattern_.size() && std::string_view("?*+-").find(pattern_[end]) != std::string_view::npos)
      return match_quantified(s, p, end);
    if (!item_matches(s, p, end)) return kNoMatch;
    ++s;
    p = end;
  }
  return s;
}

std::ptrdiff_t PatternMatcher::match_quantified(std::ptrdiff_t s, std::size_t p, std::size_t end) {
  switch (pattern_[end]) {
    case '?': {
      if (item_matches(s, p, end)) {
        const std::ptrdiff_t with = match(s + 1, end + 1);
        if (with != kNoMatch) return with;
      }
      return match(s, end + 1);
    }
    case '+':
      return item_matches(s, p, end) ? match_greedy(s + 1, p, end) : kNoMatch;
    case '*':
      return match_greedy(s, p, end);
    default:
      return match_shortest(s, p, end);
  }
}

std::ptrdiff_t PatternMatcher::match_greedy(std::ptrdiff_t s, std::size_t p, std::size_t end) {
  std::ptrdiff_t count = 0;
  while (item_matches(s + count, p, end)) ++count;
  for (; count >= 0; --count) {
    const std::ptrdiff_t rest = match(s + count, end + 1);
    if (rest != kNoMatch) return rest;
  }
  return kNoMatch;
}

std::ptrdiff_t PatternMatcher::match_shortest(std::ptrdiff_t s, std::size_t p, std::size_t end) {
  while (true) {
    const std::ptrdiff_t rest = match(s, end + 1);
    if (rest != kNoMatch) return rest;
    if (!item_matches(s, p, end)) return kNoMatch;
    ++s;
  }
}

std::ptrdiff_t PatternMatcher::match_capture_start(std::ptrdiff_t s, std::size_t p) {
  if (captures_.size() >= kCapturesMax) fail(ErrorKind::input, "the pattern has more than {} captures", kCapturesMax);
  const bool position = p + 1 < pattern_.size() && pattern_[p + 1] == ')';
  captures_.push_back({.start = s, .length = position ? kPosition : kUnclosed});
  const std::size_t level = captures_.size();
  const std::ptrdiff_t rest = match(s, position ? p + 2 : p + 1);
  if (rest == kNoMatch) captures_.resize(level - 1);
  return rest;
}

std::ptrdiff_t PatternMatcher::match_capture_end(std::ptrdiff_t s, std::size_t p) {
  const auto open =
      std::find_if(captures_.rbegin(), captures_.rend(), [](const Capture& c) { return c.length == kUnclosed; });
  if (open == captures_.rend()) fail(ErrorKind::input, "malformed pattern (')' without '(')");
  const auto level = static_cast<std::size_t>(captures_.rend() - open) - 1;
  captures_[level].length = s - captures_[level].start;
  const std::ptrdiff_t rest = match(s, p + 1);
  if (rest == kNoMatch) captures_[level].length = kUnclosed;
  return rest;
}

std::ptrdiff_t PatternMatcher::match_balanced(std::ptrdiff_t s, std::size_t p) {
  if (p + 3 >= pattern_.size()) fail(ErrorKind::input, "malformed pattern (missing arguments to '%b')");
  const auto size = static_cast<std::ptrdiff_t>(subject_.size());
  const char open = pattern_[p + 2];
  const char close = pattern_[p + 3];
  if (s >= size || subject_[static_cast<std::size_t>(s)] != open) return kNoMatch;
  int level = 1;
  for (std::ptrdiff_t i = s + 1; i < size; ++i) {
    step();
    const char c = subject_[static_cast<std::size_t>(i)];
    if (c == close) {
      if (--level == 0) return match(i + 1, p + 4);
    } else if (c == open) {
      ++level;
    }
  }
  return kNoMatch;
}

std::ptrdiff_t PatternMatcher::match_frontier(std::ptrdiff_t s, std::size_t p) {
  if (p + 2 >= pattern_.size() || pattern_[p + 2] != '[')
    fail(ErrorKind::input, "malformed pattern (missing '[' after '%f')");
  const std::size_t end = item_end(p + 2);
  const auto at = [&](std::ptrdiff_t i) {
    return i < 0 || i >= static_cast<std::ptrdiff_t>(subject_.size())
               ? static_cast<unsigned char>(0)
               : static_cast<unsigned char>(subject_[static_cast<std::size_t>(i)]);
  };
  if (set_matches(at(s - 1), p + 2, end - 1) || !set_matches(at(s), p + 2, end - 1)) return kNoMatch;
  return match(s, end);
}

std::ptrdiff_t PatternMatcher::match_back_reference(std::ptrdiff_t s, std::size_t p) {
  const auto level = static_cast<std::size_t>(pattern_[p + 1] - '1');
  if (pattern_[p + 1] == '0' || level >= captures_.size() || captures_[level].length == kUnclosed)
    fail(ErrorKind::input, "malformed pattern (%{} refers to no closed capture)", pattern_[p + 1]);
  const Capture& capture = captures_[level];
  if (capture.length == kPosition) return kNoMatch;  // a position is no text
  const std::ptrdiff_t length = capture.length;
  step(static_cast<std::uint64_t>(length) / 8);
  if (static_cast<std::ptrdiff_t>(subject_.size()) - s < length) return kNoMatch;
  const std::string_view wanted =
      subject_.substr(static_cast<std::size_t>(capture.start), static_cast<std::size_t>(length));
  if (subject_.substr(static_cast<std::size_t>(s), static_cast<std::size_t>(length)) != wanted) return kNoMatch;
  return match(s + length, p + 2);
}

}  // namespace verisim::script

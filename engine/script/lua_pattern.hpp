// Lua 5.1's patterns with a bound on their work. Lua's own matcher backtracks without an end that a limit could reach
// (a subject of 64 KiB and four quantifiers take hours); this one counts its steps, as work (work.hpp) and against a
// limit of its own. Semantics: Lua 5.1 manual, 5.4.1.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace verisim::script {

/// One match of a pattern in a subject. Positions are offsets from the subject's begin.
class PatternMatcher {
 public:
  static constexpr int kCapturesMax = 32;
  static constexpr int kDepthMax = 200;

  /// `steps_max`: comparisons over the life of this matcher; each is a unit of work as well, whatever becomes of the
  /// match. Both texts must outlive it.
  PatternMatcher(std::string_view subject, std::string_view pattern, std::uint64_t steps_max);

  /// Matches the pattern exactly at `start`. Throws Error(input): malformed pattern, too many captures, too many steps.
  /// @pre 0 <= start <= the subject's length
  /// @returns the end of the match, or -1.
  [[nodiscard]] std::ptrdiff_t match_at(std::ptrdiff_t start);
  /// Does the pattern begin with '^'?
  [[nodiscard]] bool anchored() const { return anchored_; }

  struct Capture {
    std::ptrdiff_t start = 0;
    std::ptrdiff_t length = 0;  ///< kUnclosed, kPosition, or a length
  };
  static constexpr std::ptrdiff_t kUnclosed = -1;
  static constexpr std::ptrdiff_t kPosition = -2;
  /// Of the last match.
  [[nodiscard]] const std::vector<Capture>& captures() const { return captures_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }

 private:
  std::ptrdiff_t match(std::ptrdiff_t s, std::size_t p);
  std::ptrdiff_t match_quantified(std::ptrdiff_t s, std::size_t p, std::size_t item_end);
  std::ptrdiff_t match_greedy(std::ptrdiff_t s, std::size_t p, std::size_t item_end);
  std::ptrdiff_t match_shortest(std::ptrdiff_t s, std::size_t p, std::size_t item_end);
  std::ptrdiff_t match_capture_start(std::ptrdiff_t s, std::size_t p);
  std::ptrdiff_t match_capture_end(std::ptrdiff_t s, std::size_t p);
  std::ptrdiff_t match_balanced(std::ptrdiff_t s, std::size_t p);
  std::ptrdiff_t match_frontier(std::ptrdiff_t s, std::size_t p);
  std::ptrdiff_t match_back_reference(std::ptrdiff_t s, std::size_t p);
  [[nodiscard]] std::size_t item_end(std::size_t p);
  [[nodiscard]] bool item_matches(std::ptrdiff_t s, std::size_t p, std::size_t end);
  [[nodiscard]] bool set_matches(unsigned char c, std::size_t p, std::size_t last);
  void step(std::uint64_t steps = 1);

  std::string_view subject_;
  std::string_view pattern_;
  bool anchored_;
  std::uint64_t steps_ = 0;
  std::uint64_t steps_max_;
  int depth_ = 0;
  std::vector<Capture> captures_;
};

}  // namespace verisim::script

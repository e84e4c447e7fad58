// The line of stderr that says how far long work is. On a terminal it is written in place and gone at the end, however
// the work ends; in a pipe there is none.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

namespace verisim {

class ProgressLine {
 public:
  explicit ProgressLine(bool wanted) : shown_(wanted && ::isatty(STDERR_FILENO) == 1) {}
  ~ProgressLine() { say(""); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  [[nodiscard]] bool is_shown() const { return shown_; }
  /// In place of what it said before. @param text of at most kWidth characters
  void say(const std::string& text) const {
    if (!shown_) return;
    std::fprintf(stderr, "\r%-*s\r%s", kWidth, "", text.c_str());
    std::fflush(stderr);
  }

 private:
  static constexpr int kWidth = 60;
  bool shown_;
};

}  // namespace verisim

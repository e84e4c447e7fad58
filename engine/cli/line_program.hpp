// A program that answers lines: one on its stdin, one on its stdout.
#pragma once

#include <string>

namespace verisim::cli {

class LineProgram {
 public:
  /// Starts `sh -c command`. Its stderr is this program's. Error(io) if that fails.
  explicit LineProgram(const std::string& command);
  /// Ends it: by force what has not hung up within a second of its stdin's end, or left a process behind.
  ~LineProgram();
  LineProgram(const LineProgram&) = delete;
  LineProgram& operator=(const LineProgram&) = delete;

  /// Sends a line and waits for one. Error(input) if the program ends or says nothing for `patience_s`.
  [[nodiscard]] std::string ask(const std::string& line, double patience_s);

 private:
  /// True if it hangs up within a second.
  [[nodiscard]] bool wait_for_its_end() const;
  [[noreturn]] void complain(const std::string& what);

  std::string command_;
  int pid_ = -1;
  int to_ = -1;
  int from_ = -1;
  std::string received_;
};

}  // namespace verisim::cli

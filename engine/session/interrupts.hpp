// Ctrl-C (SIGINT), a request to end (SIGTERM) and a terminal that was closed (SIGHUP). Each ends a command at once with
// exit code 128 + its number, but while an InterruptScope lives: what it surrounds looks at was_interrupted() and ends
// in good order. A second signal does not wait for that.
#pragma once

#include <string>

namespace verisim {

/// To be called early in main. A SIGHUP that is ignored (nohup) stays ignored.
void handle_interrupts();

/// While it lives a signal asks, and does not end the process.
class InterruptScope {
 public:
  InterruptScope();
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
};

/// True if a signal has asked to stop.
[[nodiscard]] bool was_interrupted();
/// 128 + the signal's number: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP; 0 if there was none.
[[nodiscard]] int interrupted_exit_code();
/// "interrupted by SIGTERM".
[[nodiscard]] std::string interruption();

}  // namespace verisim

#include "engine/session/interrupts.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

namespace verisim {
namespace {

struct Named {
  int signal;
  const char* name;
};
constexpr std::array<Named, 3> kSignals = {{{SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGHUP, "SIGHUP"}}};

constexpr int kSignalled = 128;

std::atomic<int> interrupted = 0;  ///< the signal that asked
std::atomic<int> scopes = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal's handler may use no other");

const char* name_of_signal(int signal) {
  for (const Named& named : kSignals)
    if (named.signal == signal) return named.name;
  return "a signal";
}

void write_text_of(const char* text) {
  static_cast<void>(!::write(STDERR_FILENO, text, std::strlen(text)));
}

// Only what a handler may call.
void on_signal(int signal) {
  int none = 0;
  if (interrupted.compare_exchange_strong(none, signal) && scopes > 0) return;
  write_text_of("error: interrupted by ");
  write_text_of(name_of_signal(signal));
  write_text_of("\n");
  ::_exit(kSignalled + signal);
}

}  // namespace

void handle_interrupts() {
  for (const Named& named : kSignals) {
    struct sigaction action {};
    if (named.signal == SIGHUP && ::sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(named.signal, &action, nullptr);
  }
}

InterruptScope::InterruptScope() {
  ++scopes;
}
InterruptScope::~InterruptScope() {
  --scopes;
}

bool was_interrupted() {
  return interrupted != 0;
}

int interrupted_exit_code() {
  return interrupted == 0 ? 0 : kSignalled + interrupted;
}

std::string interruption() {
  return std::string("interrupted by ") + name_of_signal(interrupted);
}

}  // namespace verisim

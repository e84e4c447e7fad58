#include "engine/cli/line_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>

#include "engine/base/error.hpp"

namespace verisim::cli {
namespace {

constexpr int kFarewell = 1000;            // ms to end by itself once its stdin has ended
constexpr std::size_t kLineMax = 1 << 20;  // bytes: who sends more without an end of line sends no pose

/// Unlike a pipe, a socket whose reader has died can be written to without a SIGPIPE.
void connect_pair(const std::string& command, int& ours, int& theirs) {
  int pair[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    fail(ErrorKind::io, "'{}' cannot be reached: {}", command, std::generic_category().message(errno));
  ours = pair[0];
  theirs = pair[1];
}

}  // namespace

LineProgram::LineProgram(const std::string& command) : command_(command) {
  int child_in = -1;
  int child_out = -1;
  connect_pair(command, to_, child_in);
  connect_pair(command, from_, child_out);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, child_in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, child_out, STDOUT_FILENO);
  posix_spawnattr_t attributes;  // a group of its own: what the shell starts ends with it
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::string text = command;
  char shell[] = "sh";
  char option[] = "-c";
  char* const arguments[] = {shell, option, text.data(), nullptr};
  const int failure = posix_spawn(&pid_, "/bin/sh", &actions, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(child_in);
  close(child_out);
  if (failure == 0) return;
  close(to_);
  close(from_);
  fail(ErrorKind::io, "'{}' cannot be started: {}", command, std::generic_category().message(failure));
}

LineProgram::~LineProgram() {
  close(to_);
  (void)wait_for_its_end();
  close(from_);
  kill(-pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

bool LineProgram::wait_for_its_end() const {
  pollfd ended = {from_, 0, 0};  // nothing but its hanging up
  return poll(&ended, 1, kFarewell) > 0;
}

void LineProgram::complain(const std::string& what) {
  fail(ErrorKind::input, "'{}' {}; it must answer each line with one, and flush it", command_, what);
}

std::string LineProgram::ask(const std::string& line, double patience_s) {
  using Clock = std::chrono::steady_clock;
  const std::string request = line + "\n";
  if (send(to_, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
    complain(wait_for_its_end() ? "has ended" : "takes no more lines");
  const auto end = Clock::now() + std::chrono::duration<double>(patience_s);
  for (;;) {
    if (const std::size_t at = received_.find('\n'); at != std::string::npos) {
      std::string answer = received_.substr(0, at);
      received_.erase(0, at + 1);
      return answer;
    }
    const std::chrono::duration<double, std::milli> left = end - Clock::now();
    if (left.count() <= 0) complain(fmt::format("has said nothing for {} s", patience_s));
    pollfd ready = {from_, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(left.count()) + 1) <= 0) continue;
    char buffer[4096];
    const ssize_t n = read(from_, buffer, sizeof buffer);
    if (n <= 0) complain("has ended");
    received_.append(buffer, static_cast<std::size_t>(n));
    if (received_.size() > kLineMax) complain("sends a line without end");
  }
}

}  // namespace verisim::cli

#include "engine/cli/streams.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::cli {
namespace {

constexpr int kSignalled = 128;  // exit codes from here on say which signal ended the command

bool error_stands_on_stdout = false;

/// True if nobody will ever read from this pipe or socket.
bool is_closed_pipe(int descriptor) {
  pollfd state{descriptor, POLLOUT, 0};
  return ::poll(&state, 1, 0) == 1 && (state.revents & (POLLERR | POLLHUP)) != 0;
}

std::string text_about(const char* stream, int cause) {
  const std::string why = cause == 0 ? "" : " (" + std::generic_category().message(cause) + ")";
  return std::string("error: ") + stream + ": not all of it could be written" + why +
         "; free some space or open it, and run the command again\n";
}

bool failed(std::FILE* stream) {
  errno = 0;
  return std::fflush(stream) != 0 || std::ferror(stream) != 0;
}

}  // namespace

void prepare_streams() {
  static std::array<char, 1 << 20> held;
  if (::isatty(STDOUT_FILENO) == 0) std::setvbuf(stdout, held.data(), _IOFBF, held.size());
}

void print_error(const char* text) {
  constexpr std::size_t kLongest = 4000;
  const std::string line = shown(text, kLongest);
  if (std::fprintf(stderr, "error: %s\n", line.c_str()) >= 0) return;
  std::printf("error: %s\n", line.c_str());
  error_stands_on_stdout = true;
}

int finish_streams(int exit_code) {
  const bool stderr_failed = failed(stderr);
  if (stderr_failed && !error_stands_on_stdout && !is_closed_pipe(STDERR_FILENO))
    std::fputs(text_about("stderr", 0).c_str(), stdout);
  bool stdout_failed = failed(stdout);
  const int cause = errno;
  const bool pipe_closed = stdout_failed && is_closed_pipe(STDOUT_FILENO);
  if (std::fclose(stdout) != 0) stdout_failed = true;  // a remote disk may say only now that it is full
  if (stdout_failed && !pipe_closed) std::fputs(text_about("stdout", cause).c_str(), stderr);
  if ((!stdout_failed && !stderr_failed) || exit_code > kSignalled) return exit_code;
  return static_cast<int>(ErrorKind::io);
}

}  // namespace verisim::cli

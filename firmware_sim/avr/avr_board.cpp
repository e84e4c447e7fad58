// The client of verisim-avr.
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>

#include "firmware_sim/avr/wire.hpp"

extern char** environ;

namespace verisim::firmware {
namespace {

constexpr int kPatienceMs = 60'000;  // for one millisecond's answer, which takes well below one

[[noreturn]] void fail(const std::string& what, int code) {
  throw std::runtime_error(what + ": " + std::generic_category().message(code));
}

/// The running program. Its stdin and stdout are one socket: unlike a pipe, it can be written to without a SIGPIPE when
/// its reader has died.
class Process {
 public:
  explicit Process(std::string program) : program_(std::move(program)) {
    if (access(program_.c_str(), X_OK) != 0)
      throw std::runtime_error(
          program_ +
          " is not there: board \"avr\" needs verisim-avr, which is built where avr-g++, avr-libc, "
          "libsimavr-dev and libelf-dev are installed; install them and build, or use board \"host\"");
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) fail("verisim-avr cannot be reached", errno);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pair[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, pair[1], STDOUT_FILENO);
    char* const arguments[] = {program_.data(), nullptr};
    const int failure = posix_spawn(&pid_, program_.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pair[1]);
    socket_ = pair[0];
    if (failure == 0) return;
    close(socket_);
    fail(program_ + " cannot be started", failure);
  }

  ~Process() {
    close(socket_);
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send_all(const void* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
      const ssize_t n = send(socket_, static_cast<const char*>(bytes) + done, size - done, MSG_NOSIGNAL);
      if (n < 0 && errno != EINTR) ended();
      if (n > 0) done += static_cast<std::size_t>(n);
    }
  }

  void receive_all(void* bytes, std::size_t size) {
    for (std::size_t have = 0; have < size;) {
      pollfd ready{socket_, POLLIN, 0};
      const int found = poll(&ready, 1, kPatienceMs);
      if (found == 0) throw std::runtime_error(program_ + " has not answered for a minute; the AVR board is lost");
      const ssize_t n = recv(socket_, static_cast<char*>(bytes) + have, size - have, 0);
      if (n == 0 || (n < 0 && errno != EINTR)) ended();
      if (n > 0) have += static_cast<std::size_t>(n);
    }
  }

 private:
  [[noreturn]] void ended() {
    throw std::runtime_error(program_ + " has ended in mid-run; its last words are on stderr. The AVR board is lost");
  }

  std::string program_;
  pid_t pid_ = -1;
  int socket_ = -1;
};

class AvrBoard final : public Board {
 public:
  explicit AvrBoard(const std::string& program) : process_(program) { receive(); }

  const char* described() const override { return "avr: an ATmega328P at 16 MHz under simavr, cycle by cycle"; }

  void advance(std::span<const EncoderEdge> edges, std::span<const TimedByte> in) override {
    assert(edges.size() <= kEventsMax);
    assert(in.size() <= kEventsMax);
    const Request request{Ask::advance, static_cast<std::uint32_t>(edges.size()),
                          static_cast<std::uint32_t>(in.size())};
    process_.send_all(&request, sizeof request);
    process_.send_all(edges.data(), edges.size_bytes());
    process_.send_all(in.data(), in.size_bytes());
    receive();
  }

  std::span<const TimedByte> sent() const override { return {state_.sent.data(), state_.sent_count}; }
  const std::array<std::int16_t, 4>& duty() const override { return state_.duty; }
  const BoardLoad& load() const override { return state_.load; }
  void reset() override { ask(Ask::reset); }
  void set_powered(bool on) override { ask(on ? Ask::power_on : Ask::power_off); }

 private:
  void ask(Ask what) {
    const Request request{what, 0, 0};
    process_.send_all(&request, sizeof request);
    receive();
  }

  void receive() {
    process_.receive_all(&state_, sizeof state_);
    assert(state_.sent_count <= state_.sent.size());
  }

  Process process_;
  Reply state_{};
};

}  // namespace

std::unique_ptr<Board> make_avr_board(const std::string& program) {
  return std::make_unique<AvrBoard>(program);
}

}  // namespace verisim::firmware

#include "engine/geometry/cad_client.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/own_file.hpp"
#include "engine/base/text.hpp"

extern char** environ;

namespace verisim {
namespace cad_process {

/// A descriptor that is closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void reset(int fd = -1) {
    if (fd_ >= 0) close(fd_);
    fd_ = fd;
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

enum class Heard { answer, errors_too };  ///< of a process: its stdout, or its stderr with it

/// The running program. Its stdin and stdout are one socket pair each: unlike a pipe, a socket whose reader died can be
/// written to without a SIGPIPE.
class Process {
 public:
  explicit Process(const std::string& program, Heard heard = Heard::answer, const char* argument = nullptr) {
    Descriptor child_in;
    Descriptor child_out;
    connect(to, child_in);
    connect(from, child_out);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, child_in.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, child_out.get(), STDOUT_FILENO);
    if (heard == Heard::errors_too) posix_spawn_file_actions_adddup2(&actions, child_out.get(), STDERR_FILENO);
    char* const arguments[] = {const_cast<char*>(program.c_str()), const_cast<char*>(argument), nullptr};
    const int failure = posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) {
      pid_ = -1;
      if (failure == ENOMEM)
        fail(ErrorKind::input, "{}: cannot be started: out of memory; give this program more", program);
      fail(ErrorKind::io, "{}: cannot be started ({}); build or install verisim-cad beside this program", program,
           std::generic_category().message(failure));
    }
  }
  ~Process() {
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    static_cast<void>(wait());
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits for its end; the status as waitpid gives it.
  [[nodiscard]] int wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
    pid_ = -1;
    return status;
  }

  Descriptor to;
  Descriptor from;

 private:
  static void connect(Descriptor& ours, Descriptor& theirs) {
    int pair[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) {
      fail(ErrorKind::io, "verisim-cad cannot be reached: {}", std::generic_category().message(errno));
    }
    ours.reset(pair[0]);
    theirs.reset(pair[1]);
    fcntl(pair[0], F_SETFL, O_NONBLOCK);
  }

  pid_t pid_ = -1;
};

}  // namespace cad_process

namespace {

using cad_process::Heard;
using cad_process::Process;

enum class Last { yes, no };  ///< of a process's requests

/// Sends and receives at once, so that neither side can wait for the other for ever.
class Exchange {
 public:
  Exchange(Process& process, std::string_view request, Last last = Last::yes)
      : process_(process), unsent_(request), last_(last) {}

  /// Everything that the process answers until it closes its end, or until it has answered a request that is not the
  /// last; nothing if the limit passes first.
  std::optional<std::string> run(double time_limit_s) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_limit_s);
    while (!closed_ && (last_ == Last::yes || !after_length(answer_))) {
      const std::chrono::duration<double, std::milli> left = end - std::chrono::steady_clock::now();
      if (left.count() <= 0) return std::nullopt;
      pollfd ready[2] = {{process_.from.get(), POLLIN, 0}, {unsent_.empty() ? -1 : process_.to.get(), POLLOUT, 0}};
      if (poll(ready, 2, static_cast<int>(left.count()) + 1) < 0 && errno != EINTR) {
        fail(ErrorKind::io, "verisim-cad cannot be waited for: {}", std::generic_category().message(errno));
      }
      if (ready[1].revents != 0) send_some();
      if (ready[0].revents != 0) receive_some();
    }
    return std::move(answer_);
  }

 private:
  void send_some() {
    const ssize_t n = send(process_.to.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL);
    if (n > 0) unsent_.remove_prefix(static_cast<std::size_t>(n));
    // A process that no longer reads has ended or is about to: its exit status tells why.
    if (n < 0 && errno != EAGAIN && errno != EINTR) unsent_ = {};
    if (unsent_.empty() && last_ == Last::yes) shutdown(process_.to.get(), SHUT_WR);
  }

  void receive_some() {
    char buffer[1 << 16];
    const ssize_t n = recv(process_.from.get(), buffer, sizeof buffer, 0);
    if (n > 0) answer_.append(buffer, static_cast<std::size_t>(n));
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) closed_ = true;
  }

  Process& process_;
  std::string_view unsent_;
  Last last_;
  std::string answer_;
  bool closed_ = false;
};

constexpr int kNotLoaded = 127;  // exit code of the dynamic loader, as of shells

/// Why it cannot be loaded, in the words of the dynamic loader: "libassimp.so.5: cannot open shared object file: …".
/// It is started once more, for nothing, to hear them. Empty if it can be loaded now, or says nothing.
std::string words_of_loader(const std::string& program) {
  constexpr double kTimeLimit = 10;  // s
  constexpr std::string_view kBefore = "error while loading shared libraries: ";
  Process process(program, Heard::errors_too);
  process.to.reset();  // it ends where it would read the request
  std::string said = Exchange(process, {}).run(kTimeLimit).value_or("");
  const int status = process.wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != kNotLoaded) return {};
  if (const std::size_t at = said.find(kBefore); at != std::string::npos) said.erase(0, at + kBefore.size());
  return shown(said.substr(0, said.find('\n')));
}

/// What brings a library of the CAD kernel or the mesh reader; its own file's name has a version that changes.
std::string advice_on(const std::string& library) {
  if (library.starts_with("libTK")) return "apt install libocct-data-exchange-dev";
  if (library.starts_with("libassimp")) return "apt install libassimp-dev";
  return "install the package that has it (packages.txt)";
}

/// A library that is not there is no fault of the input: the same command works when it is. What lacks memory may be
/// asking for too much.
[[noreturn]] void fail_not_loaded(const std::string& subject) {
  const std::string words = words_of_loader(cad_program());
  const auto says = [&](std::string_view text) { return words.find(text) != std::string::npos; };
  if (words.empty() || says("failed to map segment") || says("annot allocate"))
    fail(ErrorKind::input, "{}: verisim-cad cannot be loaded: out of memory; give it more", subject);
  if (!says("cannot open shared object file: No such file"))
    fail(ErrorKind::io, "{}: verisim-cad cannot be loaded ({}); build or install it again", subject, words);
  const std::string library = words.substr(0, words.find(':'));
  fail(ErrorKind::io, "{}: verisim-cad cannot be loaded: the library {} is not installed; {}", subject, library,
       advice_on(library));
}

[[noreturn]] void fail_crashed(const std::string& subject, int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotLoaded) fail_not_loaded(subject);
  const std::string how = WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                                              : fmt::format("exit code {}", WEXITSTATUS(status));
  fail(ErrorKind::input,
       "{}: the CAD kernel or mesh reader crashed while reading ({}); the file is damaged or beyond it; open it in a "
       "CAD program and "
       "export "
       "it again",
       subject, how);
}

}  // namespace

struct CadSession::Running {
  Process process{cad_program(), Heard::answer, kManyRequests};
};

CadSession::CadSession() = default;
CadSession::~CadSession() = default;

std::optional<Message> CadSession::ask(const Message& request) {
  constexpr double kTimeLimit = 20;  // s; what takes longer is worth a process, and a limit, of its own
  try {
    if (!running_) running_ = std::make_unique<Running>();
    const std::string bytes = with_length(encode(request));
    const std::string answer = Exchange(running_->process, bytes, Last::no).run(kTimeLimit).value_or("");
    if (const auto whole = after_length(answer)) {
      Message message = decode(*whole);
      if (!message.empty() && message.front().name != "error") return message;
    }
  } catch (const Error&) {  // no such program, no answer that makes sense: ask_cad() says so
  }
  running_.reset();
  return std::nullopt;
}

std::string cad_program() {
  if (const char* named = std::getenv("VERISIM_CAD"); named != nullptr && *named != '\0') return named;
  if (std::string program = own_program("verisim-cad"); !program.empty()) return program;
  fail(ErrorKind::io,
       "verisim-cad is not beside this program (in '{}'); build or install it there, or name it in VERISIM_CAD",
       std::filesystem::path(own_file()).parent_path().string());
}

Message ask_cad(const Message& request, const std::string& subject, double time_limit_s) {
  VERISIM_ASSERT(time_limit_s > 0);
  const std::string bytes = encode(request);
  Process process(cad_program());
  const std::optional<std::string> answer = Exchange(process, bytes).run(time_limit_s);
  if (!answer) {
    fail(ErrorKind::input,
         "{}: the CAD kernel or mesh reader did not finish within {} s and was stopped; the file is damaged or beyond "
         "it; simplify it "
         "or "
         "export it again",
         subject, time_limit_s);
  }
  const int status = process.wait();
  if (!WIFEXITED(status) || answer->empty()) fail_crashed(subject, status);
  Message message = decode(*answer);
  if (WEXITSTATUS(status) != 0) {
    if (message.size() != 1 || message.front().name != "error") fail_crashed(subject, status);
    throw Error(static_cast<ErrorKind>(WEXITSTATUS(status)), text_of(message.front(), "text"));
  }
  return message;
}

}  // namespace verisim

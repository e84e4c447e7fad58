#include "engine/batch/workers.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <stdexcept>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::batch {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLastWords = 2000;                   // bytes of stderr that are kept
constexpr std::size_t kAnswerMax = std::size_t{64} << 20;  // bytes: who says more is out of order
constexpr int kFailed = 1;                                 // exit code of a worker whose work threw
constexpr int kNoMemory = 99;                              // likewise, for want of memory: no ErrorKind's

double seconds_of(const timeval& t) {
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
}

/// What came through a pipe. False once it is closed at the other side.
bool drain(int descriptor, std::string& text) {
  char buffer[1 << 16];
  const ssize_t n = ::read(descriptor, buffer, sizeof buffer);
  if (n > 0) text.append(buffer, static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && (errno == EINTR || errno == EAGAIN));
}

void write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(descriptor, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // nobody reads any more
    done += static_cast<std::size_t>(n);
  }
}

[[noreturn]] void refuse_process(const char* call) {
  fail(ErrorKind::io, "no process for a run can be made ({}: {}); use fewer --jobs, the same command then goes on",
       call, std::strerror(errno));
}

}  // namespace

struct Workers::Worker {
  std::uint64_t run = 0;
  pid_t pid = -1;
  int answer = -1, words = -1;
  Clock::time_point begin = Clock::now();
  bool timed_out = false;
  std::string said, answered;

  Worker() = default;
  ~Worker() {
    if (answer >= 0) ::close(answer);
    if (words >= 0) ::close(words);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
};

Workers::Workers(unsigned jobs, WorkerLimits limits, std::function<std::string(std::uint64_t run)> work)
    : jobs_(jobs), limits_(limits), work_(std::move(work)) {
  VERISIM_ASSERT(jobs > 0);
}

Workers::~Workers() {
  for (const auto& worker : busy_) {
    ::kill(worker->pid, SIGKILL);
    while (::waitpid(worker->pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

bool Workers::is_free() const {
  return busy_.size() < jobs_;
}
bool Workers::are_idle() const {
  return busy_.empty();
}

void Workers::be_worker(std::uint64_t run, int answer, int words, int parent) const {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kFailed);  // it died before that
  ::setpgid(0, 0);                              // Ctrl-C is the batch's; it ends its workers
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nowhere, STDIN_FILENO);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(words, STDERR_FILENO);
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
#ifndef VERISIM_SANITIZED  // whose shadow memory takes terabytes of address space
  if (limits_.memory_bytes > 0) {
    const rlimit memory{limits_.memory_bytes, limits_.memory_bytes};
    ::setrlimit(RLIMIT_AS, &memory);
  }
#endif
  try {
    write_all(answer, work_(run));
    ::_exit(0);  // nothing of the batch's is to be flushed or closed here
  } catch (const Error& error) {
    write_all(STDERR_FILENO, error.what());
    ::_exit(error.exit_code());
  } catch (const std::bad_alloc&) {
    ::_exit(kNoMemory);
  } catch (const std::length_error&) {  // more than any memory could hold
    ::_exit(kNoMemory);
  } catch (const std::exception& error) {
    write_all(STDERR_FILENO, error.what());
  } catch (...) {
    write_all(STDERR_FILENO, "an exception of no known kind");
  }
  ::_exit(kFailed);
}

void Workers::begin(std::uint64_t run) {
  VERISIM_ASSERT(is_free());
  int answer[2], words[2];
  if (::pipe2(answer, O_CLOEXEC) != 0) refuse_process("pipe");
  if (::pipe2(words, O_CLOEXEC) != 0) {
    ::close(answer[0]);
    ::close(answer[1]);
    refuse_process("pipe");
  }
  auto worker = std::make_unique<Worker>();
  worker->run = run;
  worker->answer = answer[0];
  worker->words = words[0];
  const int parent = ::getpid();
  worker->pid = ::fork();
  if (worker->pid == 0) be_worker(run, answer[1], words[1], parent);
  const int cause = errno;
  ::close(answer[1]);
  ::close(words[1]);
  errno = cause;
  if (worker->pid < 0) refuse_process("fork");
  busy_.push_back(std::move(worker));
}

WorkerEnd Workers::reap(Worker& worker) const {
  WorkerEnd end;
  end.run = worker.run;
  int status = 0;
  rusage used{};
  while (::wait4(worker.pid, &status, 0, &used) < 0 && errno == EINTR) {
  }
  while (worker.words >= 0 && drain(worker.words, worker.said)) {  // closed at the other side: ends
  }
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.out_of_memory = end.exit_code == kNoMemory;
  end.answer = std::move(worker.answered);
  end.timed_out = worker.timed_out;
  end.last_words = std::move(worker.said);
  end.wall_s = std::chrono::duration<double>(Clock::now() - worker.begin).count();
  end.user_s = seconds_of(used.ru_utime);
  end.system_s = seconds_of(used.ru_stime);
  constexpr std::uint64_t kKibibyte = 1024;
  end.memory_bytes = static_cast<std::uint64_t>(used.ru_maxrss) * kKibibyte;
  return end;
}

std::vector<WorkerEnd> Workers::wait(double wait_s) {
  std::vector<pollfd> watched;
  double next_s = wait_s;
  const Clock::time_point now = Clock::now();
  for (const auto& worker : busy_) {
    watched.push_back({worker->answer, POLLIN, 0});
    watched.push_back({worker->words, POLLIN, 0});  // below 0: not watched
    if (limits_.time_s <= 0) continue;
    const double left = limits_.time_s - std::chrono::duration<double>(now - worker->begin).count();
    if (left <= 0 && !worker->timed_out) {
      worker->timed_out = true;
      ::kill(worker->pid, SIGKILL);
    }
    if (!worker->timed_out) next_s = std::min(next_s, left);
  }
  const int wait_ms = static_cast<int>(std::clamp(next_s * 1e3 + 1, 0.0, 1e6));
  if (::poll(watched.data(), watched.size(), wait_ms) <= 0) return {};
  std::vector<WorkerEnd> ended;
  for (std::size_t i = busy_.size(); i-- > 0;) {
    Worker& worker = *busy_[i];
    if (watched[2 * i + 1].revents != 0) {
      if (!drain(worker.words, worker.said)) {  // it closed its stderr: nothing more to watch
        ::close(worker.words);
        worker.words = -1;
      }
      if (worker.said.size() > 2 * kLastWords) worker.said.erase(0, worker.said.size() - kLastWords);
    }
    if (watched[2 * i].revents == 0) continue;
    if (drain(worker.answer, worker.answered)) {
      if (worker.answered.size() > kAnswerMax) ::kill(worker.pid, SIGKILL);
      continue;
    }
    ended.push_back(reap(worker));
    busy_.erase(busy_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  std::reverse(ended.begin(), ended.end());
  return ended;
}

std::string signal_name(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name == nullptr ? fmt::format("signal {}", signal) : fmt::format("SIG{}", name);
}

std::string why_no_answer(const WorkerEnd& end, const WorkerLimits& limits) {
  VERISIM_ASSERT(end.exit_code != 0);
  const std::string words = end.last_words.empty() ? "" : ": " + shown(end.last_words);
  constexpr double kMebibyte = 1 << 20;
  if (end.timed_out) return fmt::format("no answer within {:g} s (--time-limit)", limits.time_s);
  if (end.out_of_memory && limits.memory_bytes == 0) return "out of memory" + words;
  if (end.out_of_memory)
    return fmt::format("out of memory: wanted more than {:.0f} MiB (--memory-limit){}",
                       static_cast<double>(limits.memory_bytes) / kMebibyte, words);
  if (end.signal == SIGKILL) return "ended by SIGKILL, by hand or by the system for want of memory" + words;
  if (end.signal != 0) return "ended by " + signal_name(end.signal) + words;
  return fmt::format("ended with exit code {}{}", end.exit_code, words);
}

unsigned cores() {
  cpu_set_t set;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return static_cast<unsigned>(std::max(1, CPU_COUNT(&set)));
}

std::uint64_t physical_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && bytes > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(bytes) : 0;
}

}  // namespace verisim::batch

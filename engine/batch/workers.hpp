// Runs in processes of their own: a crash, a hang or a memory bomb ends one of them and nothing else.
//
// A worker is a fork of the batch, not a program of its own: what the batch has loaded is there, and the start costs a
// millisecond instead of the 20 to 40 of loading all libraries anew. It works with limits on memory (RLIMIT_AS) and
// time (a steady clock here, SIGKILL there), says its answer through a pipe, and dies with the batch
// (PR_SET_PDEATHSIG).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace verisim::batch {

struct WorkerLimits {
  double time_s = 0;               ///< wall clock of a run; 0: none
  std::uint64_t memory_bytes = 0;  ///< of address space; 0: none
};

/// How a worker ended.
struct WorkerEnd {
  std::uint64_t run = 0;
  std::string answer;  ///< all that it wrote; not whole unless exit_code is 0
  int exit_code = -1;  ///< -1: a signal ended it
  int signal = 0;
  bool timed_out = false;
  bool out_of_memory = false;  ///< it wanted more than it may have
  std::string last_words;      ///< the end of what it said on stderr
  double wall_s = 0, user_s = 0, system_s = 0;
  std::uint64_t memory_bytes = 0;  ///< the most that it had resident
};

class Workers {
 public:
  /// @param work computes a run and returns its answer; called in the worker, whose stdout is nowhere. What it throws
  ///        ends the worker with exit code 1, an Error's its own, and its text as last words; what there is no
  ///        memory for, with `out_of_memory`. @pre jobs > 0; this process has one thread
  Workers(unsigned jobs, WorkerLimits limits, std::function<std::string(std::uint64_t run)> work);
  ~Workers();  ///< kills those that work
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  [[nodiscard]] bool is_free() const;  ///< one more can begin
  [[nodiscard]] bool are_idle() const;
  /// Error(io): no process can be made. @pre is_free()
  void begin(std::uint64_t run);
  /// Waits until a worker ends, a signal comes or `wait_s` are over; returns those that ended.
  [[nodiscard]] std::vector<WorkerEnd> wait(double wait_s);

 private:
  struct Worker;
  [[nodiscard]] WorkerEnd reap(Worker& worker) const;
  [[noreturn]] void be_worker(std::uint64_t run, int answer, int words, int parent) const;

  unsigned jobs_;
  WorkerLimits limits_;
  std::function<std::string(std::uint64_t)> work_;
  std::vector<std::unique_ptr<Worker>> busy_;
};

/// "SIGSEGV", "signal 42".
[[nodiscard]] std::string signal_name(int signal);

/// Why a worker gave no answer: "no answer within 60 s (--time-limit)", "out of memory: …", "ended by SIGSEGV: …", else
/// `ended with exit code 3: …`. @pre its exit code is not 0
[[nodiscard]] std::string why_no_answer(const WorkerEnd& end, const WorkerLimits& limits);

/// Cores that this process may use.
[[nodiscard]] unsigned cores();
/// Bytes of the machine's memory.
[[nodiscard]] std::uint64_t physical_memory();

}  // namespace verisim::batch

// Real-time priority of the calling thread, for a loop that waits for the wall clock 1000 times a second.
//
// Without it a system with other work to do may start a frame milliseconds late. Linux: SCHED_FIFO at its lowest
// priority, so that every thread of the system's own that asks for more still comes first; needs CAP_SYS_NICE or an
// rtprio limit of 1 or more (`ulimit -r`). Threads started meanwhile inherit it: start those that need none before.
#pragma once

namespace verisim::cli {

class RealtimePriority {
 public:
  /// Asks for it if `wanted`; the system may refuse.
  explicit RealtimePriority(bool wanted);
  /// The thread is scheduled as it was before.
  ~RealtimePriority();
  RealtimePriority(const RealtimePriority&) = delete;
  RealtimePriority& operator=(const RealtimePriority&) = delete;

  [[nodiscard]] bool granted() const { return granted_; }

 private:
  bool granted_ = false;
  int policy_before_ = 0, priority_before_ = 0;
};

}  // namespace verisim::cli

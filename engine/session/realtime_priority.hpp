// Real-time priority of the calling thread, for a loop that waits for the wall clock 1000 times a second.
//
// Without it a busy system may start a frame milliseconds late. Linux: SCHED_FIFO at its lowest priority, so real-time
// threads of the system itself come first. Needs CAP_SYS_NICE or an rtprio limit of 1 or more (`ulimit -r`). Threads
// started meanwhile inherit it; start others before.
#pragma once

namespace verisim {

class RealtimePriority {
 public:
  /// Requests it if `wanted`; the system may refuse.
  explicit RealtimePriority(bool wanted);
  /// Restores the former scheduling.
  ~RealtimePriority();
  RealtimePriority(const RealtimePriority&) = delete;
  RealtimePriority& operator=(const RealtimePriority&) = delete;

  [[nodiscard]] bool granted() const { return granted_; }

 private:
  bool granted_ = false;
  int policy_before_ = 0, priority_before_ = 0;
};

}  // namespace verisim

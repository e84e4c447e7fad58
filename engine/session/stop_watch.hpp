// How long something takes, for whoever waits for it.
#pragma once

#include <chrono>

namespace verisim {

/// Counts seconds from its making, whatever happens to the calendar.
class StopWatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace verisim

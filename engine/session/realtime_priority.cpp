#include "engine/session/realtime_priority.hpp"

#include <pthread.h>
#include <sched.h>

namespace verisim {

RealtimePriority::RealtimePriority(bool wanted) {
  if (!wanted) return;
  sched_param parameters{};
  if (pthread_getschedparam(pthread_self(), &policy_before_, &parameters) != 0) return;
  priority_before_ = parameters.sched_priority;
  parameters.sched_priority = sched_get_priority_min(SCHED_FIFO);
  granted_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

RealtimePriority::~RealtimePriority() {
  if (!granted_) return;
  sched_param parameters{};
  parameters.sched_priority = priority_before_;
  pthread_setschedparam(pthread_self(), policy_before_, &parameters);
}

}  // namespace verisim

// A program whose slowness is known: slowed FRACTION PROGRAM ARGS... runs the program and then computes, to no end, for
// FRACTION of the processor time that it took. Ends with the program's exit code.
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace {

double seconds_of(const rusage& used) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double own_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return seconds_of(used);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  pid_t child = -1;
  if (posix_spawn(&child, argv[2], nullptr, nullptr, argv + 2, environ) != 0) return 3;
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) < 0) return 3;
  const double until = own_seconds() + std::atof(argv[1]) * seconds_of(used);
  volatile unsigned long work = 0;
  while (own_seconds() < until)
    for (int i = 0; i < 10000; ++i) work = work + 1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

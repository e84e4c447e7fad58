// DESIGN rule 3: the loop allocates nothing after the first frame, takes no lock and reads no clock except to time its
// stages. Proven by standing in for malloc, pthread_mutex_lock and clock_gettime and counting.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <time.h>

#include <atomic>
#include <cstdlib>

#include "tests/simulation/scenes.hpp"

namespace {

std::atomic<bool> counting = false;
std::atomic<std::uint64_t> allocations = 0, locks = 0, clock_reads = 0;

void note(std::atomic<std::uint64_t>& counter) {
  if (counting) ++counter;
}

template <typename Function>
Function* next_of(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void* operator new(std::size_t size) {
  note(allocations);
  void* p = std::malloc(size != 0 ? size : 1);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static auto* const real = next_of<int(pthread_mutex_t*)>("pthread_mutex_lock");
  note(locks);
  return real(mutex);
}

extern "C" int clock_gettime(clockid_t id, timespec* t) {
  static auto* const real = next_of<int(clockid_t, timespec*)>("clock_gettime");
  note(clock_reads);
  return real(id, t);
}

namespace verisim {
namespace {

struct Quiet {
  std::uint64_t allocations, locks, clock_reads, frames, contacts;
};

Quiet run_counted(Simulation& simulation) {
  simulation.step();  // the first frame may
  simulation.clear_events();
  allocations = locks = clock_reads = 0;
  Quiet quiet{};
  while (simulation.frame() < simulation.frames_planned()) {
    counting = true;
    simulation.step();
    counting = false;
    simulation.clear_events();
    ++quiet.frames;
    quiet.contacts += simulation.cost().contacts;
  }
  quiet.allocations = allocations;
  quiet.locks = locks;
  quiet.clock_reads = clock_reads;
  return quiet;
}

TEST(StepIsQuiet, WhileAPinIsPushedIntoAHole) {
  Simulation simulation(scenes::pin_in_hole(), {});
  const Quiet quiet = run_counted(simulation);
  ASSERT_GT(quiet.contacts, 0U) << "the pin never met the hole: this test would prove nothing";
  EXPECT_EQ(quiet.allocations, 0U);
  EXPECT_EQ(quiet.locks, 0U);
  EXPECT_EQ(quiet.clock_reads, quiet.frames * (kStageNames.size() + 1));  // the start and the end of each stage
}

TEST(StepIsQuiet, WhileBoxesFallOnEachOther) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Simulation simulation(scenes::falling_boxes(3, integrator), {});
    const Quiet quiet = run_counted(simulation);
    ASSERT_GT(quiet.contacts, 0U);
    EXPECT_EQ(quiet.allocations, 0U);
    EXPECT_EQ(quiet.locks, 0U);
  }
}

// The alarm itself works.
TEST(StepIsQuiet, NoticesAnAllocationALockAndAClock) {
  allocations = locks = clock_reads = 0;
  counting = true;
  delete new int(1);
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&mutex);
  pthread_mutex_unlock(&mutex);
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  counting = false;
  EXPECT_EQ(allocations, 1U);
  EXPECT_EQ(locks, 1U);
  EXPECT_EQ(clock_reads, 1U);
}

}  // namespace
}  // namespace verisim

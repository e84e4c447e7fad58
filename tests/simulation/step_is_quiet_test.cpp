// DESIGN rule 3: the loop allocates nothing after the first frame, takes no lock and reads no clock except to time its
// stages. Proven by standing in for malloc, pthread_mutex_lock and clock_gettime and counting.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <time.h>

#include <atomic>
#include <cstdlib>

#include "engine/device/bubble.hpp"
#include "engine/device/bump.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/passivity_filter.hpp"
#include "engine/wii/head.hpp"
#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/simulation/tray_scene.hpp"

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

// glibc's own entry points: everything that allocates, operator new and shared libraries included, comes through these.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

#ifndef VERISIM_SANITIZED  // the sanitizer stands there itself
void* malloc(std::size_t size) {
  note(allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note(allocations);
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  note(allocations);
  return __libc_realloc(p, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}
#endif
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

namespace verisim::step_is_quiet_test {
namespace {

std::vector<int> kept;  // outlives its test, so that no compiler may leave the allocation out

struct Quiet {
  std::uint64_t allocations, locks, clock_reads, frames, contacts, events;
};

Quiet run_counted(Simulation& simulation) {
  simulation.step();  // the first frame may
  simulation.clear_events();
  allocations = locks = clock_reads = 0;
  Quiet quiet{};
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.prepare();  // what has come near is made between frames
    counting = true;
    simulation.step();
    counting = false;
    quiet.events += simulation.events().size();  // whose texts are made here, between frames
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

// Recognition, memo, restoration, the comparator's solver and the exact response: all that they need is there before
// the first frame.
TEST(StepIsQuiet, UnderEveryHybridMethod) {
  for (const Hybrid hybrid : {hybrid::off, hybrid::restore, hybrid::blend, hybrid::exact}) {
    SCOPED_TRACE(hybrid->name());
    Simulation simulation(scenes::brep_pin_in_hole(hybrid), {});
    const Quiet quiet = run_counted(simulation);
    ASSERT_GT(quiet.contacts, 0U) << "the pin never met the hole: this test would prove nothing";
    EXPECT_EQ(quiet.allocations, 0U);
    EXPECT_EQ(quiet.locks, 0U);
    EXPECT_EQ(quiet.clock_reads, quiet.frames * (kStageNames.size() + 1));
  }
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

// More bodies in an island than one dense matrix takes, and blows.
TEST(StepIsQuiet, WhileManyBoxesFallIntoATray) {
  Scene scene = tray::scene_of(16, 0.12, 1, 0.01);
  scene.parameters.duration = 0.3;
  scene.parameters.restitution = 0.3;
  Simulation simulation(std::move(scene), {});
  const Quiet quiet = run_counted(simulation);
  ASSERT_GT(quiet.contacts, 0U);
  EXPECT_EQ(quiet.allocations, 0U);
  EXPECT_EQ(quiet.locks, 0U);
}

TEST(StepIsQuiet, WhileItHasSomethingToSay) {
  Scene scene = scenes::pin_in_hole();
  scene.grasps.clear();
  HapticSamples samples;  // in the pin; the button goes down and up
  for (int i = 0; i < 40; ++i) {
    samples.t.push_back(0.01 * i);
    samples.pose.push_back({{0.002, 0, 0.15}, Quaterniond::Identity()});
    samples.button.push_back(i % 4 < 2 ? 0 : 1);
  }
  scene.devices = {make_replay("a stylus with a name that no text holds without memory", samples)};
  Simulation simulation(std::move(scene), {});
  const Quiet quiet = run_counted(simulation);
  EXPECT_GE(quiet.events, 15U) << "nothing was said: this test would prove nothing";
  EXPECT_EQ(quiet.allocations, 0U);
}

// All that hardware models and filters do, with what they have to say.
TEST(StepIsQuiet, WhileADeviceGoesThroughEveryFilter) {
  Scene scene = scenes::pin_in_hole();
  HardwareDescription omni = phantom_omni("omni");
  omni.stops = true;
  omni.rate = 500;
  omni.delay = 0.002;
  omni.load = {0.05, 0.1};
  BubbleDescription bubble;
  bubble.radius = 0.02;
  bubble.stops_in_collision = true;
  const auto filtered = make_bubble(make_passivity_filter(make_hardware(omni, scene.devices[0]), {}), bubble);
  scene.devices[0] =
      make_bump(make_rotate(make_scale(filtered, 1.5), Quaterniond::Identity()), {.force = 2, .duration = 0.02});
  Simulation simulation(std::move(scene), {});
  const Quiet quiet = run_counted(simulation);
  EXPECT_GE(quiet.events, 5U) << "nothing was said: this test would prove nothing";
  EXPECT_EQ(quiet.allocations, 0U);
  EXPECT_EQ(quiet.locks, 0U);
}

// What an operator sees, plans and says, with a peg that it has to search a hole for.
TEST(StepIsQuiet, WhileAHandSeeksItsGoals) {
  Scene scene = scenes::pin_in_hole();
  scene.parameters.duration = 4;
  HandDescription hand;
  hand.start.position = {0.002, 0, 0.1};
  hand.arm = ArmKind::drawn;
  hand.watched = Watched::body;
  HandGoal insert;
  insert.kind = GoalKind::insert;
  insert.strategy = PegStrategy::spiral;
  insert.from = Vector3d(0.02, 0, 0.1);
  insert.to.position = {0.02, 0, -0.1};
  insert.give_up = 2.5;
  HandGoal wander;
  wander.kind = GoalKind::wander;
  wander.box_min = {-0.05, -0.05, 0.1};
  wander.box_max = {0.05, 0.05, 0.15};
  hand.goals = {insert, wander};
  scene.devices[0] = make_hand(hand);
  Simulation simulation(std::move(scene), {});
  const Quiet quiet = run_counted(simulation);
  ASSERT_GT(quiet.contacts, 0U);
  EXPECT_GE(quiet.events, 2U) << "no goal was begun: this test would prove nothing";
  EXPECT_EQ(quiet.allocations, 0U);
  EXPECT_EQ(quiet.locks, 0U);
}

TEST(StepIsQuiet, WhileHeadsAreTracked) {
  Scene scene = scenes::pin_in_hole();
  for (const char* tracker : {"geometric", "scaat", "vrpn-compatible"})
    scene.companions.push_back(
        std::make_shared<wii::Head>(tracker, wii::make_virtual_source({.name = tracker}), tracker, Pose{}));
  Simulation simulation(std::move(scene), {});
  const Quiet quiet = run_counted(simulation);
  EXPECT_EQ(quiet.allocations, 0U);
  EXPECT_EQ(quiet.locks, 0U);
}

// The alarm itself works.
TEST(StepIsQuiet, NoticesAnAllocationALockAndAClock) {
#ifdef VERISIM_SANITIZED
  GTEST_SKIP() << "the sanitizer stands where this test counts allocations";
#endif
  allocations = locks = clock_reads = 0;
  counting = true;
  std::vector<int>(1000).swap(kept);
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
}  // namespace verisim::step_is_quiet_test

// The rows of extremes: what they find of scenes whose end is known.
#include "engine/stability/extremes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/stability/resting.hpp"

namespace verisim::stability::extremes_test {
namespace {

const Task& task_of(const std::vector<Task>& tasks, const std::string& what) {
  return *std::find_if(tasks.begin(), tasks.end(), [&](const Task& task) { return task.what == what; });
}

// Weight beyond what contacts can bear is a failure with a name.
TEST(Extremes, ABoxTooHeavyForItsContactsIsToldToSink) {
  for (const Hybrid hybrid : {hybrid::off, hybrid::exact}) {
    Resting r;
    r.mass = 1e9;
    r.hybrid = hybrid;
    const Row row = rest("heavy", r);
    EXPECT_EQ(row.outcome, Outcome::diverged) << hybrid->name();
    EXPECT_FALSE(row.holds);
    EXPECT_NE(row.why.find("sinking"), std::string::npos) << hybrid->name() << ": " << row.why;
  }
}

// What the event tells to do heals, and where it tells the step, no stiffness would.
TEST(Extremes, WhatSinksRestsWhenItIsDoneAsTheEventSays) {
  for (const Hybrid hybrid : {hybrid::off, hybrid::restore, hybrid::exact}) {
    Resting heavy;
    heavy.mass = 1e9;
    heavy.hybrid = hybrid;
    const std::string name = hybrid == hybrid::exact ? "exactStiffness" : "contactStiffness";
    const Row before = rest("heavy", heavy);
    EXPECT_NE(before.why.find("raise " + name), std::string::npos) << before.why;
    heavy.contact_stiffness = 1e11;
    heavy.exact_stiffness = 1e17;
    const Row after = rest("heavy", heavy);
    EXPECT_TRUE(after.holds) << hybrid->name() << ": " << *after.figure("sinks") << " " << after.why;
  }
  Resting small;
  small.hybrid = hybrid::off;
  small.size = 1e-4;
  const Row before = rest("small", small);
  EXPECT_NE(before.why.find("use a timestep below 0.0005 s"), std::string::npos) << before.why;
  small.step = 0.0005;
  EXPECT_TRUE(rest("small", small).holds);
}

TEST(Extremes, TowersOfUnequalBoxesStandWhenItIsDoneAsTheEventSays) {
  Resting heavy;
  heavy.boxes = 3;
  heavy.mass_ratio = 1e3;
  EXPECT_NE(rest("heavy above", heavy).why.find("raise exactStiffness"), std::string::npos);
  heavy.exact_stiffness = 1e15;
  EXPECT_TRUE(rest("heavy above", heavy).holds);
  Resting light;
  light.boxes = 3;
  light.mass_ratio = 1e-3;
  EXPECT_TRUE(rest("light above", light).holds);
  for (const double ratio : {1e-6, 1e-8, 1e-10}) {
    Resting lighter = light;
    lighter.mass_ratio = ratio;
    const Row pushed = rest("lighter above", lighter);
    EXPECT_FALSE(pushed.holds) << ratio;
    EXPECT_NE(pushed.why.find(ratio == 1e-10 ? "rounding: 'box2'" : "rounding: 'box"), std::string::npos) << pushed.why;
  }
  Resting softer = light;
  softer.exact_stiffness = 1e9;
  EXPECT_TRUE(rest("softer", softer).holds);
  Resting slower = light;
  slower.step = 1e-4;
  EXPECT_TRUE(rest("smaller steps", slower).holds);
}

TEST(Extremes, AVoxelThatDoesNotFitIsRefusedWithTheReason) {
  Resting r;
  r.size = 1e-300;
  const Row row = rest("nothing", r);
  EXPECT_EQ(row.outcome, Outcome::refused);
  EXPECT_FALSE(row.holds);
  EXPECT_FALSE(row.why.empty());
}

// 10^4 rad/s are ten radians in a step.
TEST(Extremes, AFreeSpinKeepsItsEnergyAtAnySpeed) {
  const std::vector<Task> tasks = extreme_tasks();
  for (const char* what : {"spin of 100 rad/s", "spin of 10000 rad/s"}) {
    const Row row = task_of(tasks, what).compute();
    EXPECT_TRUE(row.holds) << what << " energy off by " << *row.figure("energy_error");
  }
}

}  // namespace
}  // namespace verisim::stability::extremes_test

// Every figure of a run is declared once and reads its own value.
#include "engine/base/run_figures.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "engine/base/error.hpp"

namespace verisim::run_figures_test {
namespace {

/// Every field another value; what a figure of that name must be.
RunFigures distinct() {
  RunFigures run;
  run.scenario = "s";
  run.run_file = "r";
  run.outcome = "o";
  run.end = "e";
  run.state_hash = "h";
  run.penetration_source = "p";
  std::uint64_t n = 100;
  for (std::uint64_t* count :
       {&run.frames, &run.collision_frames, &run.overruns, &run.collisions, &run.cache_hits, &run.cache_misses,
        &run.null_misses, &run.by_voxels, &run.exact_frames, &run.exact_frames_by_voxels})
    *count = n++;
  double x = 0.5;
  for (double* value : {&run.simulated_s, &run.wall_s, &run.load_s, &run.force_max, &run.penetration_max}) *value = ++x;
  run.realtime_priority = true;
  run.frame_ns = {1, 2, 3};
  run.collision_frame_ns = {4, 5, 6};
  run.measures = {{"depth", 0.25, "m"}};
  return run;
}

std::string text_of(const RunFigure::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  if (const auto* x = std::get_if<double>(&value)) return std::to_string(*x);
  if (const auto* yes = std::get_if<bool>(&value)) return *yes ? "yes" : "no";
  const auto& t = std::get<RunFigures::Times>(value);
  return std::to_string(t.p50) + "/" + std::to_string(t.p99) + "/" + std::to_string(t.max);
}

TEST(RunFigures, EachHasAValueOfItsOwn) {
  const RunFigures run = distinct();
  std::set<std::string> names, values;
  for (const RunFigure& figure : run_figures()) {
    EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
    EXPECT_TRUE(values.insert(text_of(figure.value(run))).second) << figure.name;
    EXPECT_NE(std::string(figure.meaning), "") << figure.name;
  }
  EXPECT_EQ(values.size(), 25U) << "24 fields and the real-time factor";
}

// The names are a promise to users (INTERFACES section 1); two that were swapped would pass the test above.
TEST(RunFigures, BelongToTheirNames) {
  const RunFigures run = distinct();
  std::map<std::string, std::string> said;
  for (const RunFigure& figure : run_figures()) said[figure.name] = text_of(figure.value(run));
  EXPECT_EQ(said["cache_hits"], std::to_string(run.cache_hits));
  EXPECT_EQ(said["cache_misses"], std::to_string(run.cache_misses));
  EXPECT_EQ(said["null_misses"], std::to_string(run.null_misses));
  EXPECT_EQ(said["by_voxels"], std::to_string(run.by_voxels));
  EXPECT_EQ(said["exact_frames"], std::to_string(run.exact_frames));
  EXPECT_EQ(said["exact_frames_by_voxels"], std::to_string(run.exact_frames_by_voxels));
  EXPECT_EQ(said["collision_frames"], std::to_string(run.collision_frames));
  EXPECT_EQ(said["collisions"], std::to_string(run.collisions));
  EXPECT_EQ(said["frames"], std::to_string(run.frames));
  EXPECT_EQ(said["overruns"], std::to_string(run.overruns));
  EXPECT_EQ(said["max_force_N"], std::to_string(run.force_max));
  EXPECT_EQ(said["max_penetration_m"], std::to_string(run.penetration_max));
  EXPECT_EQ(said["penetration_source"], "p");
  EXPECT_EQ(said["wall_s"], std::to_string(run.wall_s));
  EXPECT_EQ(said["load_s"], std::to_string(run.load_s));
  EXPECT_EQ(said["simulated_s"], std::to_string(run.simulated_s));
  EXPECT_EQ(said["frame_ns"], "1/2/3");
  EXPECT_EQ(said["outcome"], "o");
  EXPECT_EQ(said["end"], "e");
}

TEST(RunFigures, TellAMeasureByName) {
  const RunFigures run = distinct();
  EXPECT_EQ(run.measure("depth"), 0.25);
  EXPECT_THROW((void)run.measure("width"), Error);
}

}  // namespace
}  // namespace verisim::run_figures_test

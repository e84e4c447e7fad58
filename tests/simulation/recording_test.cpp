// What a row says under a name is what the simulation says of that: facts that were swapped would be found here.
#include <gtest/gtest.h>

#include <cstring>

#include "engine/simulation/stages/left_out.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::recording_test {
namespace {

class Rows {
 public:
  explicit Rows(const Simulation& simulation) : simulation_(simulation) {
    simulation.describe(schema_);
    row_.resize(schema_.row_bytes());
  }
  void take() { simulation_.write_row(row_.data()); }
  /// Of the frame's one link; 0 if its bodies are not near.
  template <typename T>
  [[nodiscard]] T of_link(const std::string& fact) const {
    T value{};
    for (const Column& column : schema_.table()) {
      if (column.path != "/state/links/" + fact || simulation_.table_rows().empty()) continue;
      EXPECT_EQ(simulation_.table_rows().size(), schema_.table_row_bytes());
      std::memcpy(&value, simulation_.table_rows().data() + column.offset, sizeof value);
    }
    return value;
  }
  template <typename T>
  [[nodiscard]] T value(const std::string& path, std::size_t i = 0) const {
    for (const Column& column : schema_.columns()) {
      if (column.path != path) continue;
      EXPECT_EQ(column.bytes() / column.width, sizeof(T)) << path;
      T value;
      std::memcpy(&value, row_.data() + column.offset + i * sizeof value, sizeof value);
      return value;
    }
    ADD_FAILURE() << "no column " << path;
    return {};
  }

 private:
  const Simulation& simulation_;
  Schema schema_;
  std::vector<std::byte> row_;
};

TEST(Recording, OfWorkIsWhatTheFrameCost) {
  for (const Hybrid method : {hybrid::restore, hybrid::exact}) {
    Simulation simulation(scenes::brep_pin_in_hole(method), {});
    Rows rows(simulation);
    FrameCost most;
    while (simulation.frame() < simulation.frames_planned()) {
      simulation.step();
      rows.take();
      for (const CostCounter& counter : kCostCounters) {
        const std::uint64_t count = simulation.cost().*counter.count;
        ASSERT_EQ(rows.value<std::uint32_t>(std::string("/cost/") + counter.name), count) << counter.name;
        most.*counter.count = std::max(most.*counter.count, count);
      }
    }
    EXPECT_GT(method == hybrid::exact ? most.solver_steps : most.lookups, 0U) << method->name();
  }
}

TEST(Recording, OfALinkAddsUpToTheTotals) {
  Simulation simulation(scenes::brep_pin_in_hole(hybrid::restore), {});
  Rows rows(simulation);
  std::uint64_t hits = 0, misses = 0, contacts = 0;
  double deepest = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    rows.take();
    hits += rows.of_link<std::uint32_t>("cache_hits");
    misses += rows.of_link<std::uint32_t>("cache_misses");
    contacts += rows.of_link<std::uint32_t>("contacts");
    deepest = std::max(deepest, rows.of_link<double>("max_penetration"));
    ASSERT_EQ(rows.value<double>("/state/body/pin/pose", 2), simulation.body_pose(1).position.z());
    ASSERT_EQ(rows.value<double>("/state/body/pin/twist", 3), simulation.body_twist(1).angular.x());
    ASSERT_EQ(rows.value<double>("/state/body/pin/force", 4), simulation.body_force(1).torque.y());
  }
  EXPECT_GT(hits, 10 * misses) << "they are of different size, so that a swap is seen";
  EXPECT_GT(misses, 0U);
  EXPECT_EQ(hits, simulation.totals().cache_hits);
  EXPECT_EQ(misses, simulation.totals().cache_misses);
  EXPECT_EQ(contacts, simulation.totals().contacts);
  EXPECT_EQ(deepest, simulation.totals().penetration_max);
}

// Each counter of something cut has its event, once, that names it.
TEST(LeftOut, IsToldOnceWithItsCounterAndARemedy) {
  for (const auto count : {&FrameCost::rows_left_out, &FrameCost::memo_overflows, &FrameCost::contacts_left_out,
                           &FrameCost::solver_unfinished}) {
    const auto* counter = std::find_if(kCostCounters.begin(), kCostCounters.end(),
                                       [&](const CostCounter& c) { return c.count == count; });
    LeftOut left_out;
    Notes notes;
    std::vector<Event> none;
    const World nowhere = make_world(Scene(), none);
    std::vector<Event> events;
    FrameCost cost;
    left_out.tell(cost, 0.001, notes);
    notes.tell(nowhere, events);
    EXPECT_TRUE(events.empty()) << "nothing was cut";
    cost.*count = 3;
    for (const double t : {0.002, 0.003}) left_out.tell(cost, t, notes);
    notes.tell(nowhere, events);
    ASSERT_EQ(events.size(), 1U) << counter->name;
    EXPECT_EQ(events[0].time, 0.002);
    EXPECT_NE(events[0].text.find(std::string("/cost/") + counter->name), std::string::npos);
    EXPECT_LE(events[0].text.size(), 223U) << "a run file keeps no more of it";
  }
}

}  // namespace
}  // namespace verisim::recording_test

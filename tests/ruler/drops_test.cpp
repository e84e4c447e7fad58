// What `exact` records beside the true overlap, over random drops and presses of 14 bodies on 14 seats: 200 of them (47
// s of one core); 2,000 with VERISIM_LONG_TESTS=1. It prints how they differ, by kind, and every scene beyond the goal:
// within 5 um or 10 %, no overlap above 50 um, no more energy than there was. Asserted is what holds for the 200: two
// of the three goals, and that hardly any record differs by more. Of the 2,000 it only tells.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "engine/ruler/ruler.hpp"
#include "tests/length.hpp"
#include "tests/ruler/drop_scenes.hpp"

namespace verisim::drops_test {
namespace {

constexpr std::size_t kFrames = 160;
constexpr double kAgrees = 5e-6, kAgreesOf = 0.1;  // m; of the overlap: the goal
constexpr double kDeep = 50e-6;                    // m: the goal at speeds up to 1 m/s

struct Outcome {
  std::string body, seat;
  std::uint64_t seed = 0;
  bool pressed = false;
  double difference = 0;  ///< m, the largest of its frames; below 0: the record says too much
  std::size_t frame = 0;
  double recorded = 0, overlap = 0, bound = 0;  ///< m, in that frame
  double deepest = 0;                           ///< m
  bool meets = false;
  double bound_max = 0;    ///< m, of any frame
  double energy_gain = 0;  ///< of the initial kinetic energy and m g times the height
  [[nodiscard]] bool agrees() const { return std::abs(difference) <= std::max(kAgrees, kAgreesOf * overlap); }
};

double recorded_depth(const Simulation& simulation, const Schema& schema) {
  double depth = 0;
  for (const Column& column : schema.table())
    if (column.path == "/state/links/max_penetration")
      for (std::size_t at = column.offset; at < simulation.table_rows().size(); at += schema.table_row_bytes()) {
        double value = 0;
        std::memcpy(&value, simulation.table_rows().data() + at, sizeof value);
        depth = std::max(depth, value);
      }
  return depth;
}

Outcome outcome_of(const drops::Loaded& body, const drops::Loaded& seat, std::uint64_t seed) {
  drops::DropScene drop = drops::drop(body, seat, seed);
  Outcome result{body.name, seat.name, seed, drop.pressed};
  Simulation simulation(std::move(drop.scene), {});
  Schema schema;
  simulation.describe(schema);
  const ruler::Shape above({{body.name, body.part.solid, {}}}), below({{seat.name, seat.part.solid, {}}});
  const ruler::Accuracy accuracy{.absolute = 1e-6, .relative = 0.02, .pieces_max = 2000};
  const auto mechanical = [&] { return simulation.energy().kinetic + simulation.energy().gravity; };
  const double before = mechanical();
  const double height = simulation.body_pose(1).position.z();
  const double scale = simulation.energy().kinetic + simulation.mass(1) * 9.81 * height;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const ruler::Overlap found =
        ruler::overlap(above, simulation.body_pose(1), below, simulation.body_pose(0), accuracy);
    simulation.prepare();
    simulation.step();
    simulation.clear_events();
    // The record is of the poses with which the step began.
    const double recorded = recorded_depth(simulation, schema);
    const double difference =
        recorded < found.depth ? found.depth - recorded : std::min(0.0, found.depth + found.bound - recorded);
    if (std::abs(difference) > std::abs(result.difference)) {
      result.difference = difference;
      result.frame = i;
      result.recorded = recorded;
      result.overlap = found.depth;
      result.bound = found.bound;
    }
    result.meets = result.meets || simulation.body_force(1).force.norm() > 0;
    result.deepest = std::max(result.deepest, found.depth);
    result.bound_max = std::max(result.bound_max, found.bound);
    if (!drop.pressed) result.energy_gain = std::max(result.energy_gain, (mechanical() - before) / scale);
  }
  return result;
}

void print_rows(const char* what, const std::vector<Outcome>& outcomes, std::string Outcome::*kind) {
  std::map<std::string, std::vector<Outcome>> by_kind;
  for (const Outcome& outcome : outcomes) by_kind[outcome.*kind].push_back(outcome);
  std::printf("%-12s %5s %6s %10s %10s %10s %8s %7s %7s %12s\n", what, "runs", "meet", "median um", "95 % um", "max um",
              "outside", ">50 um", "energy", "+ at most um");
  for (auto& [name, rows] : by_kind) {
    std::sort(rows.begin(), rows.end(),
              [](const Outcome& a, const Outcome& b) { return std::abs(a.difference) < std::abs(b.difference); });
    const auto at = [&](double q) {
      return std::abs(rows[static_cast<std::size_t>(q * static_cast<double>(rows.size() - 1))].difference) * 1e6;
    };
    const auto count = [&](auto is) { return static_cast<int>(std::count_if(rows.begin(), rows.end(), is)); };
    std::vector<double> bounds;
    for (const Outcome& o : rows) bounds.push_back(o.bound_max);
    std::sort(bounds.begin(), bounds.end());
    std::printf("%-12s %5zu %6d %10.3f %10.3f %10.3f %8d %7d %7d %12.2f\n", name.c_str(), rows.size(),
                count([](const Outcome& o) { return o.meets; }), at(0.5), at(0.95), at(1),
                count([](const Outcome& o) { return !o.agrees(); }),
                count([](const Outcome& o) { return o.deepest > kDeep; }),
                count([](const Outcome& o) { return o.energy_gain > 0.01; }), bounds[bounds.size() / 2] * 1e6);
  }
}

TEST(RandomDrops, AreRecordedAsDeepAsTheyAre) {
  const std::vector<drops::Loaded> bodies = drops::loaded(drops::body_kinds());
  const std::vector<drops::Loaded> seats = drops::loaded(drops::seat_kinds());
  const auto count = test::by_length<std::uint64_t>(12, 200, 2000);
  std::vector<Outcome> outcomes;
  for (std::uint64_t seed = 0; seed < count; ++seed)
    outcomes.push_back(
        outcome_of(bodies[seed % bodies.size()], seats[(seed + seed / bodies.size()) % seats.size()], seed));
  print_rows("body", outcomes, &Outcome::body);
  print_rows("seat", outcomes, &Outcome::seat);
  std::size_t touched = 0;
  for (const Outcome& o : outcomes) {
    touched += o.meets;
    if (o.agrees() && o.deepest <= kDeep && o.energy_gain <= 0.01) continue;
    std::printf(
        "%-10s on %-12s seed %4llu %-7s frame %3zu: recorded %9.2f um, true %9.2f (+ %.2f) um; deepest %9.2f um; "
        "energy %+.2f %%\n",
        o.body.c_str(), o.seat.c_str(), static_cast<unsigned long long>(o.seed), o.pressed ? "pressed" : "dropped",
        o.frame, o.recorded * 1e6, o.overlap * 1e6, o.bound * 1e6, o.deepest * 1e6, o.energy_gain * 100);
  }
  const auto wrong = std::count_if(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return !o.agrees(); });
  std::printf("%zu scenes, %zu with contact: %d recorded otherwise than true\n", outcomes.size(), touched,
              static_cast<int>(wrong));
  EXPECT_GE(touched, outcomes.size() / 2) << "most bodies met nothing: this would prove nothing";
  if (test::is_long()) return;
  EXPECT_LE(wrong, 2) << "one is known: a disc's rim on a blunt spike, seed 142, is lost for some frames";
  for (const Outcome& o : outcomes) {
    SCOPED_TRACE(o.body + " on " + o.seat + ", seed " + std::to_string(o.seed));
    EXPECT_LE(o.deepest, kDeep);
    EXPECT_LE(o.energy_gain, 0.01);
  }
}

}  // namespace
}  // namespace verisim::drops_test

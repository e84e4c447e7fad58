// The recipe of engine/simulation/README.md, "To add a companion", followed to the letter: this file and its line in
// CMakeLists.txt are all that a companion takes.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/simulation/scenes.hpp"

namespace verisim::add_a_companion_test {
namespace {

/// A lamp that blinks at a rate of its own.
class Lamp final : public Companion {
 public:
  explicit Lamp(double period) : period_(period) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  void advance(double t) override {
    due_ = 0;
    for (; static_cast<double>(blinks_ + 1) * period_ <= t + 1e-9; ++blinks_) ++due_;
  }
  [[nodiscard]] double duration() const override { return 0.25; }
  void declare(Columns& columns) const override {
    columns.add(
        "/state/lamp/blinks", "1", "blinks since the start", [this] { return blinks_; }, {}, "/cost/lamp/due");
    columns.add("/cost/lamp/due", "1", "blinks in this frame", [this] { return due_; });
  }

 private:
  std::string name_ = "lamp";
  double period_;
  std::uint32_t blinks_ = 0, due_ = 0;
};

Scene scene_with_a_lamp() {
  Scene scene = scenes::pin_in_hole();
  scene.devices.clear();
  scene.grasps.clear();
  scene.parameters.duration.reset();
  scene.companions.push_back(std::make_shared<Lamp>(0.1));
  return scene;
}

const Column& column_of(const Schema& schema, const std::string& path) {
  const auto found = std::find_if(schema.columns().begin(), schema.columns().end(),
                                  [&](const Column& column) { return column.path == path; });
  if (found == schema.columns().end()) throw Error(ErrorKind::usage, "no column " + path);
  return *found;
}

TEST(ACompanion, RunsOnItsOwnClockAndSaysHowLong) {
  Simulation simulation(scene_with_a_lamp(), {});
  ASSERT_EQ(simulation.frames_planned(), 250U);
  Schema schema;
  simulation.describe(schema);
  std::vector<std::byte> row(schema.row_bytes());
  const Column& blinks = column_of(schema, "/state/lamp/blinks");
  EXPECT_EQ(blinks.due, "/cost/lamp/due");
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    simulation.write_row(row.data());
    std::uint32_t value = 0;
    std::memcpy(&value, row.data() + blinks.offset, sizeof value);
    ASSERT_EQ(value, simulation.frame() / 100) << "frame " << simulation.frame();
  }
}

TEST(ACompanion, IsPartOfTheStateThatIsHashed) {
  Scene other = scene_with_a_lamp();
  other.companions = {std::make_shared<Lamp>(0.2)};
  Simulation a(scene_with_a_lamp(), {});
  Simulation b(other, {});
  while (a.frame() < 99) a.step(), b.step();
  EXPECT_EQ(a.state_hash(), b.state_hash()) << "neither has blinked yet";
  a.step(), b.step();
  EXPECT_NE(a.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace verisim::add_a_companion_test

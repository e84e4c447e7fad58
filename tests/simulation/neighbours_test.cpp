// Who is near whom, by a ruler of its own: boxes from recorded poses, every pair against every pair. And what is made
// when two bodies meet depends on nothing but the scene.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "engine/base/random.hpp"
#include "tests/simulation/scenes.hpp"

namespace verisim::neighbours_test {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

constexpr double kVoxel = 0.006;

/// Boxes of many shapes that fly through each other's ways, some of them fixed.
Scene swarm(std::uint64_t seed, std::size_t count) {
  const RandomStream random(seed, "swarm");
  std::uint64_t n = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(n++); };
  const auto anywhere = [&](double half) {
    return Vector3d(between(-half, half), between(-half, half), between(-half, half));
  };
  Scene scene;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.hybrid = hybrid::off;
  scene.parameters.duration = 0.15;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d size = Vector3d::Constant(0.02) + 0.5 * (anywhere(0.03) + Vector3d::Constant(0.03));
    BodyDescription body = scenes::body_of("b" + std::to_string(i), scenes::centred_box(size), kVoxel);
    body.X_WB = {anywhere(0.2), Quaterniond(between(-1, 1), between(-1, 1), between(-1, 1), 1).normalized()};
    body.twist = {anywhere(1.5), anywhere(10)};
    body.fixed = i % 3 == 0;
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

/// Pairs of the frame's rows in the table.
Pairs recorded(const Simulation& simulation) {
  Schema schema;
  simulation.describe(schema);
  Pairs pairs;
  for (const Column& column : schema.table()) {
    if (column.path != "/state/links/pair") continue;
    for (std::size_t at = 0; at < simulation.table_rows().size(); at += schema.table_row_bytes()) {
      std::uint32_t number = 0;
      std::memcpy(&number, simulation.table_rows().data() + at + column.offset, sizeof number);
      const BodyPair pair = simulation.pairs().at(number);
      EXPECT_TRUE(pairs.emplace(pair.first, pair.second).second) << "twice in a frame";
    }
  }
  return pairs;
}

/// Pairs whose boxes along the world's axes, grown by two voxels, are closer than `margin` [m] on every axis.
Pairs closer_than(double margin, const Scene& scene, const std::vector<Pose>& poses) {
  std::vector<Bounds> boxes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Bounds grown;
    for (const Vector3d& v : scene.bodies[i].parts[0].mesh.vertices) grown.include(v + 2 * kVoxel * v.cwiseSign());
    Bounds box;
    for (int corner = 0; corner < 8; ++corner)
      box.include(poses[i] * Vector3d((corner & 1) != 0 ? grown.max.x() : grown.min.x(),
                                      (corner & 2) != 0 ? grown.max.y() : grown.min.y(),
                                      (corner & 4) != 0 ? grown.max.z() : grown.min.z()));
    boxes.push_back(box);
  }
  Pairs pairs;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      const Vector3d gap = (boxes[i].min - boxes[j].max).cwiseMax(boxes[j].min - boxes[i].max);
      if ((!scene.bodies[i].fixed || !scene.bodies[j].fixed) && gap.maxCoeff() < margin) pairs.emplace(i, j);
    }
  return pairs;
}

bool contains(const Pairs& all, const Pairs& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

TEST(Neighbours, AreThoseWhoseBoxesMeetAndNoOthers) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = swarm(seed, 24);
    Simulation simulation(scene, {});
    std::size_t rows = 0;
    while (simulation.frame() < simulation.frames_planned()) {
      std::vector<Pose> poses;  // at the start of the frame: where contact is looked for
      for (std::size_t i = 0; i < scene.bodies.size(); ++i) poses.push_back(simulation.body_pose(i));
      simulation.step();
      const Pairs near = recorded(simulation);
      ASSERT_TRUE(contains(near, closer_than(-1e-12, scene, poses)))
          << "seed " << seed << " frame " << simulation.frame();
      ASSERT_TRUE(contains(closer_than(1e-12, scene, poses), near))
          << "seed " << seed << " frame " << simulation.frame();
      rows += near.size();
    }
    EXPECT_GT(rows, 100U) << "nobody met: this would prove nothing";
  }
}

TEST(Neighbours, MeetInTheSameOrderWithTheSameBitsWhenAllIsMadeBefore) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Simulation as_they_meet(swarm(seed, 20), {});
    Simulation before(swarm(seed, 20), {});
    before.prepare_all();
    while (before.frame() < before.frames_planned()) {
      as_they_meet.step();
      before.step();
      ASSERT_EQ(before.state_hash(), as_they_meet.state_hash());
      ASSERT_EQ(before.cost().pairs_met, as_they_meet.cost().pairs_met);
    }
    ASSERT_EQ(before.events().size(), as_they_meet.events().size());
    for (std::size_t i = 0; i < before.events().size(); ++i) {
      EXPECT_EQ(before.events()[i].text, as_they_meet.events()[i].text);
      EXPECT_EQ(before.events()[i].time, as_they_meet.events()[i].time);
    }
  }
}

TEST(Neighbours, AreToldOnceEachInTheFrameInWhichTheyMeet) {
  Simulation simulation(swarm(3, 24), {});
  std::size_t met = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.prepare();
    const std::size_t events = simulation.events().size();
    simulation.step();
    EXPECT_EQ(simulation.cost().pairs_met, events) << "an event each, before the frame";
    EXPECT_EQ(simulation.pairs().size(), met + events);
    met += events;
    simulation.clear_events();
  }
  EXPECT_GT(met, 20U);
}

// The devices' travel says what can meet; a script may put a body anywhere.
TEST(Neighbours, AreFoundWhereAScriptPutsABody) {
  Scene scene = scenes::pin_in_hole();
  BodyDescription far = scenes::body_of("far", scenes::centred_box({0.2, 0.2, 0.2}), 0.0045);
  far.fixed = true;
  far.X_WB.position = {100, 0, 0};
  scene.bodies.push_back(far);
  Simulation simulation(std::move(scene), {});
  simulation.step();
  EXPECT_EQ(simulation.body_contacts(2), 0U);
  simulation.set_body_pose(1, Pose{{100, 0, 0.08}, Quaterniond::Identity()});
  simulation.step();
  EXPECT_GT(simulation.body_contacts(2), 0U);
}

}  // namespace
}  // namespace verisim::neighbours_test

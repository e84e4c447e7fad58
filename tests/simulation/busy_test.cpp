// A frame looks only at bodies that move, or are near one that does; what it records of all others is still true.
// Boxes near each other, taken, let go and put elsewhere at random; after every frame each row is held against the
// bodies themselves, the pairs against the boxes around them, and the state hash against the whole row.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <set>

#include "engine/base/hash.hpp"
#include "engine/base/random.hpp"
#include "tests/simulation/scenes.hpp"

namespace verisim::busy_test {
namespace {

constexpr double kSide = 0.05, kVoxel = 0.005;
constexpr std::size_t kHands = 2;
using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

Scene boxes_side_by_side() {
  Scene scene;
  for (int i = 0; i < 27; ++i) {
    BodyDescription box =
        scenes::body_of("box" + std::to_string(i), scenes::centred_box(Vector3d::Constant(kSide)), kVoxel);
    box.X_WB.position = Vector3d(i % 3, i / 3 % 3, i / 9) * 0.055;
    box.fixed = i % 9 == 4;
    scene.bodies.push_back(std::move(box));
  }
  for (std::size_t h = 0; h < kHands; ++h) {
    HandDescription hand;
    hand.name = "hand" + std::to_string(h);
    for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(0.06, 0.02, 0.03), Vector3d(-0.03, 0.05, -0.02)})
      hand.path.push_back({Pose{p, Quaterniond::Identity()}, 0.2, 0.05});
    scene.devices.push_back(make_hand(hand));
  }
  return scene;
}

class Rows {
 public:
  explicit Rows(const Simulation& simulation) : simulation_(simulation) { simulation.describe(schema_); }

  /// Numbers of a column of the row.
  std::vector<double> of(const std::string& path) {
    row_.resize(schema_.row_bytes());
    simulation_.write_row(row_.data());
    for (const Column& column : schema_.columns()) {
      if (column.path != path) continue;
      std::vector<double> numbers(column.width);
      std::memcpy(numbers.data(), row_.data() + column.offset, column.bytes());
      return numbers;
    }
    ADD_FAILURE() << "no column " << path;
    return {};
  }
  /// As the description of /state/hash says it, from all bytes of the row.
  std::uint64_t hash(std::uint64_t before) {
    row_.resize(schema_.row_bytes());
    simulation_.write_row(row_.data());
    std::string run;  // of datasets that follow each other
    std::map<std::string, std::string> of_body;
    std::uint64_t hash = before;
    const auto end_run = [&] {
      if (!run.empty()) hash = hash_bytes(run.data(), run.size(), hash);
      run.clear();
    };
    for (const Column& column : schema_.columns()) {
      if (!column.path.starts_with("/state/") || column.path == "/state/hash") break;
      const std::string bytes(reinterpret_cast<const char*>(&row_[column.offset]), column.bytes());
      if (column.path.starts_with("/state/body/")) {
        of_body[column.path.substr(0, column.path.rfind('/'))] += bytes;
        end_run();
      } else {
        run += bytes;
      }
    }
    end_run();
    std::vector<std::uint64_t> hashes;
    for (std::size_t i = 0; i < simulation_.body_count(); ++i) {
      const std::string& bytes = of_body.at("/state/body/box" + std::to_string(i));
      hashes.push_back(hash_bytes(bytes.data(), bytes.size(), 0));
    }
    hash = hash_bytes(hashes.data(), 8 * hashes.size(), hash);
    return hash_bytes(simulation_.table_rows().data(), simulation_.table_rows().size(), hash);
  }
  /// The row as a recorder has it: of what is not awake it knows what that says at rest. Returns how many are awake.
  std::size_t expect_that_a_recorder_has_all_of_it() {
    row_.resize(schema_.row_bytes());
    simulation_.write_row(row_.data());
    std::vector<std::byte> recorded(row_.size());
    for (const Column& column : schema_.columns())
      std::copy(column.rest.begin(), column.rest.end(), recorded.begin() + static_cast<std::ptrdiff_t>(column.offset));
    simulation_.write_awake(recorded.data());
    EXPECT_TRUE(recorded == row_);
    return simulation_.awake().size();
  }
  /// Of the table's rows of this frame.
  [[nodiscard]] Pairs pairs() const {
    Pairs pairs;
    const auto table = simulation_.table_rows();
    for (std::size_t at = 0; at < table.size(); at += schema_.table_row_bytes())
      for (const Column& column : schema_.table()) {
        if (column.path != "/state/links/pair") continue;
        std::uint32_t pair = 0;
        std::memcpy(&pair, table.data() + at + column.offset, sizeof pair);
        pairs.emplace(simulation_.pairs()[pair].first, simulation_.pairs()[pair].second);
      }
    return pairs;
  }

 private:
  const Simulation& simulation_;
  Schema schema_;
  std::vector<std::byte> row_;
};

/// Half sides of the box along the world's axes around a box that is grown by so much.
Vector3d half_of(const Pose& X, double grown) {
  return X.rotation.toRotationMatrix().cwiseAbs() * Vector3d::Constant(kSide / 2 + grown);
}

/// Pairs with one that can move whose boxes, each grown by this much, meet.
Pairs pairs_near(const Scene& scene, const std::vector<Pose>& poses, double grown) {
  Pairs pairs;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      if (scene.bodies[i].fixed && scene.bodies[j].fixed) continue;
      const Vector3d between = (poses[i].position - poses[j].position).cwiseAbs();
      if ((between - half_of(poses[i], grown) - half_of(poses[j], grown)).maxCoeff() < 0) pairs.emplace(i, j);
    }
  return pairs;
}

std::vector<double> numbers(const Vector3d& a, const Vector3d& b) {
  return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
}

void expect_true_rows(const Simulation& simulation, Rows& rows, const Pairs& pairs, const std::set<std::size_t>& held) {
  std::set<std::size_t> near;
  for (const auto& [i, j] : pairs) near.insert({i, j});
  for (std::size_t i = 0; i < simulation.body_count(); ++i) {
    const std::string path = "/state/body/box" + std::to_string(i);
    const Pose X = simulation.body_pose(i);
    const Twist v = simulation.body_twist(i);
    const Wrench f = simulation.body_force(i);
    const Quaterniond& q = X.rotation;
    ASSERT_EQ(rows.of(path + "/pose"),
              (std::vector<double>{X.position.x(), X.position.y(), X.position.z(), q.x(), q.y(), q.z(), q.w()}));
    ASSERT_EQ(rows.of(path + "/twist"), numbers(v.linear, v.angular)) << i;
    ASSERT_EQ(rows.of(path + "/force"), numbers(f.force, f.torque)) << i;
    if (near.contains(i) || held.contains(i)) continue;
    ASSERT_EQ(f.force.norm() + f.torque.norm(), 0) << i << " is near nothing";
  }
}

/// One thing that a script may do: take, let go, put elsewhere.
class Script {
 public:
  Script(Simulation& simulation, const Scene& scene) : simulation_(simulation), scene_(scene) {}
  void act() {
    const std::size_t hand = pick(kHands), body = pick(scene_.bodies.size());
    if (scene_.bodies[body].fixed) return;
    switch (pick(3)) {
      case 0:
        simulation_.grasp(hand, body);
        for (auto& [other, holds] : held_) holds = holds == body ? kNobody : holds;
        held_[hand] = body;
        break;
      case 1:
        simulation_.release(hand);
        held_[hand] = kNobody;
        break;
      default: {
        const Vector3d p = Vector3d(uniform(), uniform(), uniform()) * 0.2 - Vector3d::Constant(0.04);
        simulation_.set_body_pose(body, {p, rotation_from_vector(Vector3d(uniform(), uniform(), uniform()))});
      }
    }
  }
  [[nodiscard]] std::set<std::size_t> held() const {
    std::set<std::size_t> bodies;
    for (const auto& [hand, body] : held_) bodies.insert(body);
    return bodies;
  }

 private:
  static constexpr std::size_t kNobody = 1000;
  double uniform() { return random_.uniform(drawn_++); }
  std::size_t pick(std::size_t count) { return static_cast<std::size_t>(random_.bits(drawn_++) % count); }
  Simulation& simulation_;
  const Scene& scene_;
  RandomStream random_{5, "script"};
  std::uint64_t drawn_ = 0;
  std::map<std::size_t, std::size_t> held_;
};

TEST(Busy, BodiesAreRecordedAsTheyAreAndPairsWhereTheyMeet) {
  const Scene scene = boxes_side_by_side();
  Simulation simulation(boxes_side_by_side(), {});
  Script script(simulation, scene);
  Rows rows(simulation);
  std::size_t met = 0, touched = 0, awake = 0, asleep = 0;
  for (int frame = 0; frame < 1500; ++frame) {
    if (frame % 20 == 10) script.act();
    simulation.prepare();
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) poses.push_back(simulation.body_pose(i));
    const std::uint64_t before = simulation.state_hash();
    simulation.step();
    ASSERT_EQ(simulation.state_hash(), rows.hash(before)) << "frame " << frame;
    const Pairs found = rows.pairs();
    for (const auto& pair : pairs_near(scene, poses, 0))
      ASSERT_TRUE(found.contains(pair)) << pair.first << " " << pair.second << " in frame " << frame;
    const Pairs possible = pairs_near(scene, poses, 2.01 * kVoxel);
    for (const auto& pair : found)
      ASSERT_TRUE(possible.contains(pair)) << pair.first << " " << pair.second << " in frame " << frame;
    met += found.size();
    touched += simulation.cost().contacts > 0 ? 1 : 0;
    ++(rows.expect_that_a_recorder_has_all_of_it() > 0 ? awake : asleep);
    ASSERT_NO_FATAL_FAILURE(expect_true_rows(simulation, rows, found, script.held())) << "frame " << frame;
  }
  EXPECT_GT(met, 1500U);
  EXPECT_GT(touched, 500U);
  EXPECT_GT(awake, 50U);
  EXPECT_GT(asleep, 50U);
}

}  // namespace
}  // namespace verisim::busy_test

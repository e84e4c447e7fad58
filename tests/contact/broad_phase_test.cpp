// What is found is held against every box with every box, while bodies creep, jump, turn, rush and stop: all that meet
// are there, and few that are far apart.
#include "engine/contact/broad_phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/random.hpp"

namespace verisim::broad_phase_test {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr std::size_t kBodies = 60;
constexpr double kAhead = 0.01;

class Crowd {
 public:
  Crowd() {
    for (std::size_t i = 0; i < kBodies; ++i)
      bodies_.push_back({Vector3d::Constant(0.01), Vector3d::Constant(0.02 + 0.08 * uniform()), i % 4 != 0});
    for (std::size_t i = 0; i < kBodies; ++i) poses_.push_back({in_room(), rotation_from_vector(anyhow())});
    ahead_.assign(kBodies, kAhead);
  }
  [[nodiscard]] const std::vector<BroadPhaseBody>& bodies() const { return bodies_; }
  void place(BroadPhase& in, std::size_t i) const { in.set_pose(i, poses_[i], ahead_[i]); }
  /// Puts a body elsewhere: a little in most frames, somewhere else in some; now and then it looks far ahead.
  void move(std::size_t i) {
    const double kind = uniform();
    Pose& X = poses_[i];
    X.position = kind < 0.05 ? in_room() : Vector3d(X.position + 0.001 * anyhow());
    X.rotation = (rotation_from_vector(0.01 * anyhow()) * X.rotation).normalized();
    ahead_[i] = kind > 0.98 ? 100 : kAhead;
  }
  /// Pairs whose boxes along the world's axes are nearer to each other than this on every axis.
  [[nodiscard]] Pairs nearer_than(double far) const {
    Pairs pairs;
    for (std::uint32_t i = 0; i < kBodies; ++i)
      for (std::uint32_t j = i + 1; j < kBodies; ++j) {
        const Vector3d between = (poses_[i] * bodies_[i].center_B - poses_[j] * bodies_[j].center_B).cwiseAbs();
        const bool meet = ((between - half_of(i) - half_of(j)).array() < far).all();
        if (meet && (bodies_[i].can_move || bodies_[j].can_move)) pairs.emplace_back(i, j);
      }
    return pairs;
  }
  double uniform() { return random_.uniform(drawn_++); }

 private:
  [[nodiscard]] Vector3d half_of(std::size_t i) const {
    return poses_[i].rotation.toRotationMatrix().cwiseAbs() * bodies_[i].half_B + Vector3d::Constant(ahead_[i]);
  }
  double normal() { return random_.normal(drawn_++); }
  Vector3d in_room() { return {uniform(), uniform(), uniform()}; }
  Vector3d anyhow() { return {normal(), normal(), normal()}; }

  RandomStream random_{7, "broad phase"};
  std::uint64_t drawn_ = 0;
  std::vector<BroadPhaseBody> bodies_;
  std::vector<Pose> poses_;
  std::vector<double> ahead_;
};

bool holds(const Pairs& all, const Pairs& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

TEST(BroadPhase, FindsAllThatMeetAndFewOthers) {
  Crowd crowd;
  BroadPhase broad_phase(crowd.bodies());
  for (std::size_t i = 0; i < kBodies; ++i) crowd.place(broad_phase, i);
  std::size_t met = 0, found = 0;
  for (int round = 0; round < 600; ++round) {
    const double share = round % 3 == 0 ? 1 : crowd.uniform();
    for (std::size_t i = 0; i < kBodies; ++i) {
      if (!crowd.bodies()[i].can_move || crowd.uniform() >= share) continue;
      crowd.move(i);
      crowd.place(broad_phase, i);
    }
    Pairs pairs = broad_phase.find();
    while (broad_phase.left_out() > 0) {
      broad_phase.make_room();
      pairs = broad_phase.find();
    }
    ASSERT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
    ASSERT_EQ(std::adjacent_find(pairs.begin(), pairs.end()), pairs.end()) << "twice, in round " << round;
    ASSERT_TRUE(holds(pairs, crowd.nearer_than(-1e-12))) << "round " << round;
    met += crowd.nearer_than(0).size();
    found += pairs.size();
    if (broad_phase.find() != pairs) FAIL() << "of what did not move something else is found in round " << round;
  }
  EXPECT_GT(met, 50000U);
  EXPECT_LT(found, 8 * met) << "boxes are those of spheres, 5 times as large, and a little larger than they need to be";
}

TEST(BroadPhase, CountsPairsWithoutRoomAndFindsThemAfterwards) {
  // All meet: 1,225 pairs are more than there is room for at first.
  BroadPhase broad_phase(std::vector<BroadPhaseBody>(50, {Vector3d::Zero(), Vector3d::Ones(), true}));
  for (std::size_t i = 0; i < 50; ++i) broad_phase.set_pose(i, Pose(), 0);
  const std::size_t found = broad_phase.find().size();
  EXPECT_EQ(found + broad_phase.left_out(), 1225U);
  EXPECT_GT(broad_phase.left_out(), 0U);
  EXPECT_GE(broad_phase.make_room(), 2450U);
  EXPECT_EQ(broad_phase.find().size(), 1225U);
  EXPECT_EQ(broad_phase.left_out(), 0U);
}

}  // namespace
}  // namespace verisim::broad_phase_test

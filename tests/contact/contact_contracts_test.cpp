// The doors of engine/contact: what broad phase, queries and the penalty law do not take.
#include <gtest/gtest.h>

#include <limits>

#include "engine/contact/broad_phase.hpp"
#include "engine/contact/collision_link.hpp"
#include "engine/contact/query_simd.hpp"
#include "tests/contact/naive_voxels.hpp"
#include "tests/support/broken.hpp"

namespace verisim::contact_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep = 1e-3;
const Pose kStretched{{0, 0, 0}, Quaterniond(2, 0, 0, 0)};

const VoxelBody& cube() {
  static const VoxelBody body = naive::voxelize(naive::box({0.02, 0.02, 0.02}), 0.005);
  return body;
}

TEST(BroadPhaseDeathTest, KeepsBoxesThatAreSomewhere) {
  const auto with = [](const Vector3d& center, const Vector3d& half) { return BroadPhase({{center, half, true}}); };
  EXPECT_BROKEN(with({kNaN, 0, 0}, {1, 1, 1}), "is_finite(bodies[i].center_B)");
  EXPECT_BROKEN(with({0, 0, 0}, {1, kInfinity, 1}), "is_finite(bodies[i].half_B)");
  EXPECT_BROKEN(with({0, 0, 0}, {1, -1, 1}), "bodies[i].half_B.minCoeff() >= 0");
  BroadPhase one({{Vector3d::Zero(), Vector3d::Ones(), true}});
  EXPECT_BROKEN(one.set_pose(1, Pose(), 0), "body < implementation_->boxes.size()");
  EXPECT_BROKEN(one.set_pose(0, kStretched, 0), "is_placement(X_WB)");
  EXPECT_BROKEN(one.set_pose(0, Pose(), -1), "is_not_negative(ahead)");
  EXPECT_BROKEN(one.set_pose(0, {{kNaN, 0, 0}, Quaterniond::Identity()}, 0), "is_placement(X_WB)");
  BroadPhase fixed({{Vector3d::Zero(), Vector3d::Ones(), false}});
  static_cast<void>(fixed.find());
  EXPECT_BROKEN(fixed.set_pose(0, Pose(), 0), "box.can_move || !self.fixed_ready");
}

/// Both ways to ask, the fast and the plain one, have the same door.
class QueryDeathTest : public ::testing::TestWithParam<void (*)(const Voxmap&, const Pointshell&, const Pose&,
                                                                ContactList&, QueryCost&)> {
 protected:
  void take(const Pose& X_AB = {}) {
    QueryCost cost;
    GetParam()(a_, b_, X_AB, contacts_, cost);
  }
  Voxmap a_ = cube().voxmap;
  Pointshell b_ = cube().shell;
  ContactList contacts_{cube().shell.size()};
};

TEST_P(QueryDeathTest, ReadsAMapWhoseTablesFitTogether) {
  a_.voxel_size = 0;
  EXPECT_BROKEN(take(), "is_positive(a.voxel_size)");
  a_ = cube().voxmap;
  a_.brick_clearance.pop_back();
  EXPECT_BROKEN(take(), "a.brick_clearance.size() == a.brick_block.size()");
  a_ = cube().voxmap;
  ++a_.bricks.x();
  EXPECT_BROKEN(take(), "a.brick_block.size() == static_cast<std::size_t>(a.bricks.cast<std::int64_t>().prod())");
}
TEST_P(QueryDeathTest, HasRoomForAllPointsAndClustersOfAllPoints) {
  contacts_ = ContactList(b_.size() - 1);
  EXPECT_BROKEN(take(), "contacts.capacity() >= b.size()");
  contacts_ = ContactList(b_.size());
  b_.clusters.pop_back();
  EXPECT_BROKEN(take(), "b.size() == 0 || (!b.clusters.empty() && b.clusters.back().end == b.size())");
}
TEST_P(QueryDeathTest, TurnsByARotation) {
  EXPECT_BROKEN(take(kStretched), "is_unit(X_AB.rotation) || !X_AB.rotation.coeffs().allFinite()");
  Pose nowhere;
  nowhere.rotation.coeffs().setConstant(kNaN);
  take(nowhere);
  EXPECT_EQ(contacts_.size, 0U);
}
INSTANTIATE_TEST_SUITE_P(Fast, QueryDeathTest,
                         ::testing::Values([](const Voxmap& a, const Pointshell& b, const Pose& X_AB,
                                              ContactList& contacts,
                                              QueryCost& cost) { query(a, b, X_AB, contacts, cost); }));

TEST(AppendContactsDeathTest, GoesThroughTheShellInOrderWithRoomForAllOfIt) {
  const Pointshell& shell = cube().shell;
  const QueryConstants constants = make_query_constants(cube().voxmap, shell, Pose());
  PlacedCluster cluster{};
  cluster.end = 1;
  const auto append = [&](ContactList contacts) { return append_contacts(constants, shell, {&cluster, 1}, contacts); };
  EXPECT_BROKEN(append(ContactList(shell.size() - 1)), "shell.size() <= contacts.capacity()");
  ContactList contacts(shell.size());
  contacts.size = 1;
  EXPECT_BROKEN(append(contacts), "contacts.size <= clusters.front().begin");
  cluster.end = static_cast<std::uint32_t>(shell.size() + 1);
  EXPECT_BROKEN(append(ContactList(shell.size())), "clusters.back().end <= shell.size()");
}

TEST(PenaltyDeathTest, ReadsWithinItsColumnsAndPushes) {
  ContactList contacts(8);
  const Vector3d o = Vector3d::Zero();
  EXPECT_BROKEN(apply_penalty(contacts, o, {}, -1, 0), "stiffness >= 0");
  EXPECT_BROKEN(apply_penalty(contacts, o, {}, 1, kNaN), "damping >= 0");
  EXPECT_BROKEN(pushing(contacts, o, {}, kNaN, 0), "stiffness >= 0");
  EXPECT_BROKEN(pushing(contacts, o, {}, 1, -1), "damping >= 0");
  contacts.size = 9;
  EXPECT_BROKEN(contact_matrix(contacts, o), "contacts.size <= contacts.capacity()");
  EXPECT_BROKEN(apply_penalty(contacts, o, {}, 1, 0), "contacts.size <= contacts.capacity()");
  EXPECT_BROKEN(sum(contacts, o), "contacts.size <= contacts.capacity()");
  EXPECT_BROKEN(pushing(contacts, o, {}, 1, 0), "contacts.size <= contacts.capacity()");
}

TEST(CollisionLinkDeathTest, RespondsWithAStepAndALaw) {
  EXPECT_BROKEN(CollisionLink(VoxelBody(), cube()), "is_positive(first.voxmap.voxel_size)");
  EXPECT_BROKEN(CollisionLink(cube(), VoxelBody()), "is_positive(second.voxmap.voxel_size)");
  VoxelBody shuffled = cube();
  ASSERT_GT(shuffled.shell.clusters.size(), 1U);
  std::swap(shuffled.shell.clusters[0], shuffled.shell.clusters[1]);
  EXPECT_BROKEN(CollisionLink(cube(), shuffled), "are_covered(*shell_)");

  CollisionLink link(cube(), cube());
  LinkBody first{Pose(), Vector3d::Zero(), {}, Matrix6d::Zero(), 4};
  LinkBody second = first;
  second.X_WB.position.z() = second.p_WC.z() = 0.038;
  second.inverse_mass = Matrix6d::Identity();
  QueryCost cost;
  link.query(first.X_WB, second.X_WB, cost);
  ASSERT_GT(link.contacts().size, 0U) << "without a contact nothing is asked";
  EXPECT_BROKEN(link.respond(first, second, {}, 0), "is_positive(dt)");
  EXPECT_BROKEN(link.respond(first, second, {kInfinity, 0.5, true}, kStep),
                "is_not_negative(parameters.stiffness_max)");
  LinkSides sides;
  EXPECT_BROKEN(link.respond_at_once(first, second, {1, -0.5, true}, kStep, sides),
                "is_not_negative(parameters.damping_ratio)");
  LinkBody lopsided = second;
  lopsided.inverse_mass(0, 5) = 1e-3;
  EXPECT_BROKEN(link.respond(first, lopsided, {}, kStep), "is_symmetric(second.inverse_mass)");
  EXPECT_BROKEN(link.respond(lopsided, second, {}, kStep), "is_symmetric(first.inverse_mass)");
  LinkBody spent = second;  // its coupling would have used more than there is
  spent.budget = -10;
  EXPECT_BROKEN(link.respond(first, spent, {}, kStep), "budget > 0");
}

TEST(MeshTreeDeathTest, HoldsTrianglesOfFiniteCorners) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
  TriangleMesh broken = mesh;
  broken.vertices[1].y() = kNaN;
  EXPECT_BROKEN(MeshTree{broken}, "is_finite(v)");
  broken = mesh;
  broken.triangles[0][2] = 3;
  EXPECT_BROKEN(MeshTree{broken}, "std::max({a, b, c}) < mesh.vertices.size()");
  const MeshTree tree(mesh);
  ContactList contacts(8);
  QueryCost cost;
  EXPECT_BROKEN(query(tree, tree, kStretched, Vector3d::Zero(), contacts, cost), "is_unit(X_AB.rotation)");
  EXPECT_BROKEN(query(tree, tree, Pose(), Vector3d::Constant(kNaN), contacts, cost), "is_finite(origin_A)");
}

}  // namespace
}  // namespace verisim::contact_contracts_test

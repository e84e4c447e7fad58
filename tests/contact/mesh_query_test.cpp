// FCL's triangles as contacts: closed forms of boxes, and what of its raw answer must not come through.
#include "engine/contact/mesh_query.hpp"

#include <gtest/gtest.h>

#include "tests/voxel/shapes.hpp"

namespace verisim::mesh_query_test {
namespace {

ContactList contacts_of(const TriangleMesh& a, const TriangleMesh& b, const Pose& X_AB,
                        const Vector3d& origin = Vector3d::Zero(), std::size_t capacity = 1000) {
  ContactList contacts(capacity);
  QueryCost cost;
  query(MeshTree(a), MeshTree(b), X_AB, origin, contacts, cost);
  EXPECT_TRUE(cost.left_out == 0 || contacts.size == capacity) << "left out while there was room";
  return contacts;
}

Pose shifted(double x, double y, double z) {
  return {{x, y, z}, Quaterniond::Identity()};
}

const TriangleMesh kPlate = shapes::box({-0.2, -0.2, -0.05}, {0.2, 0.2, 0});
const TriangleMesh kBox = shapes::box({-0.03, -0.02, 0}, {0.03, 0.02, 0.04});

TEST(MeshQuery, FindsTheFourCornersOfABoxInAPlate) {
  const ContactList c = contacts_of(kPlate, kBox, shifted(0.01, 0.02, -0.001));
  ASSERT_EQ(c.size, 4U);
  for (std::uint32_t i = 0; i < c.size; ++i) {
    EXPECT_NEAR(c.depth[i], 0.001, 1e-9);
    EXPECT_EQ(Eigen::Vector3f(c.nx[i], c.ny[i], c.nz[i]), Eigen::Vector3f::UnitZ());
    EXPECT_NEAR(std::abs(c.x[i] - 0.01F), 0.03, 1e-7);
    EXPECT_NEAR(std::abs(c.y[i] - 0.02F), 0.02, 1e-7);
    EXPECT_NEAR(c.z[i], -0.001, 1e-9);
  }
}

TEST(MeshQuery, TakesNoSidewaysDepthWhereTheBoxHangsOverTheEdge) {
  const ContactList c = contacts_of(kPlate, kBox, shifted(0.19, 0.02, -0.001));  // raw FCL: up to 40 mm sideways
  ASSERT_GT(c.size, 0U);
  for (std::uint32_t i = 0; i < c.size; ++i) {
    EXPECT_NEAR(c.depth[i], 0.001, 1e-9);
    EXPECT_EQ(c.nz[i], 1.0F);
  }
}

TEST(MeshQuery, FindsBarsThatCrossEachOther) {
  const TriangleMesh bar = shapes::box({-0.1, -0.01, 0}, {0.1, 0.01, 0.02});
  const Quaterniond quarter(Eigen::AngleAxisd(1.5707963267948966, Vector3d::UnitZ()));
  const ContactList c = contacts_of(bar, bar, {{0, 0, 0.0195}, quarter});  // no corner of one is inside the other
  ASSERT_GT(c.size, 0U);
  for (std::uint32_t i = 0; i < c.size; ++i) {
    EXPECT_NEAR(c.depth[i], 0.0005, 1e-9);
    EXPECT_EQ(c.nz[i], 1.0F);
  }
}

TEST(MeshQuery, IsTurnedRoundWhenTheBodiesAre) {
  const Pose X_AB = {{0.01, 0.02, -0.001}, rotation_from_vector({0.02, -0.01, 0.3})};
  const ContactList there = contacts_of(kPlate, kBox, X_AB);
  const ContactList back = contacts_of(kBox, kPlate, X_AB.inverse());
  ASSERT_EQ(there.size, back.size);
  ASSERT_GT(there.size, 0U);
  const auto pull = [](const ContactList& c) {
    Vector3d sum = Vector3d::Zero();
    for (std::uint32_t i = 0; i < c.size; ++i)
      sum += double{c.depth[i]} * Eigen::Vector3f(c.nx[i], c.ny[i], c.nz[i]).cast<double>();
    return sum;
  };
  EXPECT_LT((pull(there) + X_AB.rotation * pull(back)).norm(), 1e-8);
}

TEST(MeshQuery, GivesPointsRelativeToTheOriginAskedFor) {
  const Pose X_AB = shifted(0.01, 0.02, -0.001);
  const Vector3d origin(1, 2, 3);
  const ContactList here = contacts_of(kPlate, kBox, X_AB);
  const ContactList there = contacts_of(kPlate, kBox, X_AB, origin);
  ASSERT_EQ(here.size, there.size);
  for (std::uint32_t i = 0; i < here.size; ++i) EXPECT_NEAR(here.x[i] - there.x[i], 1, 1e-6);
}

TEST(MeshQuery, FindsNothingApartAndNothingAtAPoseThatIsNotFinite) {
  EXPECT_EQ(contacts_of(kPlate, kBox, shifted(0, 0, 0.001)).size, 0U);
  EXPECT_EQ(contacts_of(kPlate, kBox, shifted(0, 0, std::nan(""))).size, 0U);
}

TEST(MeshQuery, KeepsToTheListsCapacityAndCountsTheRest) {
  ContactList contacts(3);
  QueryCost cost;
  query(MeshTree(kPlate), MeshTree(kBox), shifted(0.01, 0.02, -0.001), Vector3d::Zero(), contacts, cost);
  EXPECT_EQ(contacts.size, 3U);
  EXPECT_EQ(cost.left_out, 1U) << "a box has four corners";
}

TEST(MeshQuery, LeavesOutTrianglesWithoutArea) {
  TriangleMesh box = kBox;
  box.triangles.push_back({0, 0, 1});
  box.triangles.push_back({2, 2, 2});
  EXPECT_EQ(contacts_of(kPlate, box, shifted(0.01, 0.02, -0.001)).size, 4U);
}

}  // namespace
}  // namespace verisim::mesh_query_test

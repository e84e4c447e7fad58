// What finds no room in one step is counted, and finds it in the next.
#include <gtest/gtest.h>

#include "engine/exact/convex_step.hpp"
#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::room_test {
namespace {

TEST(Room, OfAPairGrowsToWhatWasLeftOut) {
  const Solid box = make(Solid::Kind::box, {0.03, 0.03, 0.03});
  const auto rows_of = [&](ExactLink& link) {
    link.find({}, {{{0, 0, 0.03}, Quaterniond::Identity()}, {0, 0, 0.03}, {}}, 0.001, 1e-4);
    return link.rows().rows().size();
  };
  ExactLink roomy(body_of(box, 0.003), body_of(box, 0.003));
  const std::size_t all = rows_of(roomy);
  ASSERT_GT(all, 8U);
  ExactLink narrow(body_of(box, 0.003), body_of(box, 0.003), 3);
  EXPECT_EQ(rows_of(narrow), 3U);
  EXPECT_EQ(narrow.rows().left_out(), all - 3);
  narrow.make_room();
  EXPECT_EQ(rows_of(narrow), all);
  EXPECT_EQ(narrow.rows().left_out(), 0U);
}

TEST(Room, OfTheSolverGrowsWithoutLosingWhatItHolds) {
  const ContactRow row{Vector3d::UnitZ(), Vector3d::Zero(), -1e-6, 1e8, 0};
  ConvexStep step(2, 1);
  const Matrix6d M = Matrix6d::Identity();
  const Vector6d u = Vector6d::Zero();
  const std::vector<ContactRow> rows(5, row);
  step.add_rows(rows, kFixed, step.add_body(Vector3d::Zero(), M, u, u));
  EXPECT_EQ(step.left_out(), 3U);
  EXPECT_EQ(step.row_count(), 2U);
  step.clear();
  step.reserve(5, 20);
  for (int i = 0; i < 20; ++i) step.add_body(Vector3d::Zero(), M, u, u);
  step.add_rows(rows, kFixed, 19);
  EXPECT_EQ(step.left_out(), 0U);
  step.solve(0.001);
  EXPECT_GT(step.force(4), 0);
}

}  // namespace
}  // namespace verisim::exact::test::room_test

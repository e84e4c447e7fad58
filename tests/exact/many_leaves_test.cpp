// A body with many faces and edges is searched by trees, one with few without. What is far away changes nothing: two
// boxes, one of them with a dozen more a long way off, have the same contacts as without these.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "tests/exact/scenes.hpp"
#include "tests/length.hpp"

namespace verisim::exact::test::many_leaves_test {
namespace {

constexpr double kDt = 0.001, kMargin = 0.001;

std::shared_ptr<const ExactBody> box_and(int others) {
  std::vector<Part> parts;
  for (int i = 0; i <= others; ++i)
    parts.push_back(load_solid(
        placed(make(Solid::Kind::box, {0.03, 0.04, 0.02}), {{0, 0, 10.0 * i}, Quaterniond::Identity()}), {}));
  BodyOptions options;
  options.spacing = 0.01;
  return std::make_shared<ExactBody>(parts, options);
}

using Row = std::tuple<double, double, double, double, double>;
std::vector<Row> sorted_rows(const ExactLink& link) {
  std::vector<Row> rows;
  for (const ContactRow& row : link.rows().rows())
    rows.emplace_back(row.gap, row.point.x(), row.point.y(), row.point.z(), row.stiffness);
  std::sort(rows.begin(), rows.end());
  return rows;
}

TEST(ManyLeaves, GiveTheRowsOfFew) {
  const auto few = box_and(0), many = box_and(12);
  ASSERT_GT(many->edge_tree.leaves.size(), 100U);
  ASSERT_LE(few->edge_tree.leaves.size(), 12U);
  const auto other = body_of(make(Solid::Kind::box, {0.03, 0.024, 0.036}), 0.01);
  ExactLink of_few(few, other), of_many(many, other);
  const auto trials = verisim::test::by_length<std::uint64_t>(200, 5000, 100000);
  std::size_t rows = 0;
  for (std::uint64_t seed = 0; seed < trials; ++seed) {
    Draw draw(seed);
    const Pose X{draw.in_box({0.035, 0.035, 0.035}), draw.rotation()};
    const Twist twist{draw.in_box({0.2, 0.2, 0.2}), draw.in_box({3, 3, 3})};
    of_few.find({}, {X, X.position, twist, twist}, kDt, kMargin);
    of_many.find({}, {X, X.position, twist, twist}, kDt, kMargin);
    ASSERT_EQ(sorted_rows(of_few), sorted_rows(of_many)) << "seed " << seed;
    rows += of_few.rows().rows().size();
  }
  EXPECT_GT(rows, 3 * trials);
}

}  // namespace
}  // namespace verisim::exact::test::many_leaves_test

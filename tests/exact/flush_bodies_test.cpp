// Bodies that lie flat on each other, to rounding or to micrometres: where they are held.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::flush_bodies_test {
namespace {

constexpr double kDt = 0.001, kMargin = 0.001;

/// What comes down onto a body of the same outline stands on it, though every edge is over an edge, to rounding.
void expect_flush_bodies_meet(const Solid& solid, double height, double radius) {
  Pair pair(solid, solid, 0.004);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Draw draw(seed);
    const auto off = [&] { return draw.between(-1, 1) * std::pow(10, draw.between(-14, -8)); };
    const double gap = draw.between(-1e-5, 3e-4);
    const Pose X{{off(), off(), height + gap}, rotation_from_vector({off(), off(), off()})};
    const Twist down{{off(), off(), -(std::max(gap, 0.0) + 1e-5) / kDt}, Vector3d::Zero()};
    pair.link.find({}, {X, X.position, down, down}, kDt, kMargin);
    Eigen::AlignedBox3d held;
    for (const ContactRow& row : pair.link.rows().rows()) {
      if (row.normal.z() < 0.999) continue;
      EXPECT_NEAR(row.gap, gap, 1e-7);
      held.extend(row.point);
    }
    ASSERT_FALSE(held.isEmpty()) << "seed " << seed;
    EXPECT_GE(held.sizes().head<2>().minCoeff(), radius) << "seed " << seed << ": it would tip";
  }
}

TEST(FlushBodies, OfOneSizeStandOnEachOther) {
  expect_flush_bodies_meet(make(Solid::Kind::box, {0.03, 0.03, 0.03}), 0.03, 0.02);
  expect_flush_bodies_meet(make(Solid::Kind::cylinder, {0.015, 0.03}), 0.03, 0.015);
  expect_flush_bodies_meet(make(Solid::Kind::tube, {0.02, 0.012, 0.03}), 0.03, 0.02);
}

/// The least and the most stiffness that a quarter of a flat contact has [N/m].
std::pair<double, double> stiffness_of_quarters(const std::vector<ContactRow>& rows) {
  std::array<double, 4> stiffness{};
  for (const ContactRow& row : rows)
    if (row.normal.z() > 0.999) stiffness[(row.point.x() > 0 ? 1 : 0) + (row.point.y() > 0 ? 2 : 0)] += row.stiffness;
  const auto [least, most] = std::minmax_element(stiffness.begin(), stiffness.end());
  return {*least, *most};
}

// Boxes in a heap fall together: without contact neither moves against the other, and any quarter may be pressed next.
// The ends of groups share what lies between them, so quarters differ by an end that hangs over and by where edges
// cross, not by whose closest place lies where.
TEST(FlushBodies, ThatDoNotMoveAgainstEachOtherAreHeldInEveryQuarter) {
  constexpr double kSide = 0.03;
  Pair pair(make(Solid::Kind::box, {kSide, kSide, kSide}), make(Solid::Kind::box, {kSide, kSide, kSide}), 0.01);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Draw draw(seed);
    const auto turn = [&](double most) { return draw.in_box({most, most, most}); };
    const Vector3d off = draw.in_box({3e-7, 3e-7, 0});
    const Pose X{{off.x(), off.y(), kSide}, rotation_from_vector(turn(3e-9))};
    const Twist slow{Vector3d::Zero(), turn(1e-6)};
    pair.link.find({}, {X, X.position, slow, slow}, kDt, kMargin, 1e-10);
    const auto [least, most] = stiffness_of_quarters(pair.link.rows().rows());
    ASSERT_GT(least, 0.65 * most) << "seed " << seed;
  }
}

// A hand slides the box flat over a groove. Held on this side, its lower edge comes to the far one: whichever way it
// leans by less than anybody can make it, there is nothing to stumble over.
TEST(FlushBodies, DoNotStumbleOverTheFarSideOfAGroove) {
  constexpr double kThick = 0.02, kSide = 0.05, kGroove = 0.0005;
  const Solid plate = combine(
      Solid::Kind::difference, make(Solid::Kind::box, {0.32, 0.12, kThick}),
      placed(make(Solid::Kind::box, {kGroove, 0.2, 0.01}), Pose{{0, 0, 0.5 * kThick}, Quaterniond::Identity()}));
  Pair pair(plate, make(Solid::Kind::box, {kSide, kSide, kSide}), 0.01);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Draw draw(seed);
    const double before = std::pow(10, draw.between(-6, -4.1));
    const Vector3d lean = draw.in_box({1e-10, 1e-10, 0});
    const Pose X{{0.5 * (kGroove - kSide) - before, draw.between(-0.01, 0.01), 0.5 * (kThick + kSide) - 1e-11},
                 rotation_from_vector(lean)};
    const Twist pressed{{0.1, 0, -0.006}, Vector3d::Zero()};
    const Twist slides{{0.1, 0, 0}, Vector3d::Zero()};
    pair.link.find({}, {X, X.position, pressed, slides}, kDt, kMargin, 1e-11);
    for (const ContactRow& row : pair.link.rows().rows())
      ASSERT_FALSE(row.normal.x() < -0.5 && row.gap + kDt * row.normal.dot(pressed.linear) < 0)
          << "seed " << seed << ", " << before << " m before it, at " << row.point.transpose();
  }
}

// Heavy bodies are pressed into each other by micrometres, farther than they stand beside each other. From 32 um to
// 0.1 mm 91 of 1,000 such draws have a quarter that is softer than these bounds.
TEST(FlushBodies, ThatArePressedInAreHeldInEveryQuarter) {
  constexpr double kSide = 0.05;
  Pair pair(make(Solid::Kind::box, {kSide, kSide, kSide}), make(Solid::Kind::box, {kSide, kSide, kSide}), 0.0025);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Draw draw(seed);
    const double depth = std::pow(10, draw.between(-8, -4.5));
    const double aside = std::pow(10, draw.between(-10, -5));
    const Vector3d off = draw.in_box({aside, aside, 0});
    const double tilt = 0.1 * depth / kSide;
    const Pose X{{off.x(), off.y(), kSide - depth}, rotation_from_vector(draw.in_box({tilt, tilt, aside / kSide}))};
    const Twist sinks{{0, 0, -draw.between(0, 0.7) * depth / kDt}, Vector3d::Zero()};
    pair.link.find({}, {X, X.position, sinks, sinks}, kDt, kMargin, 1.1 * (depth + kDt * sinks.linear.z()));
    const auto [least, most] = stiffness_of_quarters(pair.link.rows().rows());
    ASSERT_GT(least, 0.4 * most) << "seed " << seed;
    ASSERT_GT(least, 5e9) << "seed " << seed;
  }
}

using Polygon = std::vector<Eigen::Vector2d>;

/// What of a polygon lies where x <= half, seen along `axis`.
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& axis, double half) {
  Polygon left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double a = axis.dot(from) - half, b = axis.dot(to) - half;
    if (a <= 0) left.push_back(from);
    if ((a <= 0) != (b <= 0)) left.push_back(from + a / (a - b) * (to - from));
  }
  return left;
}

/// The overlap of the squares |x|, |y| <= half, the second one turned and moved.
Polygon overlap_of_squares(double half, double turn, const Eigen::Vector2d& off) {
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(turn).toRotationMatrix();
  Polygon square;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1), Eigen::Vector2d(1, 1), Eigen::Vector2d(-1, 1)})
    square.emplace_back(R * (half * corner) + off);
  for (const Eigen::Vector2d& axis :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, -1)})
    square = clipped(square, axis, half);
  return square;
}

/// How far the flat contact nearest to a place is from it [m].
double nearest_row(const std::vector<ContactRow>& rows, const Eigen::Vector2d& place) {
  double least = 1;
  for (const ContactRow& row : rows)
    if (row.normal.z() > 0.999) least = std::min(least, (row.point.head<2>() - place).norm());
  return least;
}

// What lies flat on another body, to rounding or to micrometres, is turned over any corner of the area that both share
// when something hits it: each is held. A corner is one of either body, or a place where their edges cross, and there
// neither edge may be the deeper one.
TEST(FlushBodies, AreHeldAtEveryCornerOfTheAreaTheyShare) {
  constexpr double kSide = 0.03, kNear = 1e-4;
  for (const double spacing : {0.002, 0.01, 0.05}) {
    Pair pair(make(Solid::Kind::box, {kSide, kSide, kSide}), make(Solid::Kind::box, {kSide, kSide, kSide}), spacing);
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
      Draw draw(seed);
      const Vector3d off = draw.in_box({0.025, 0.025, 0});
      const double turn = draw.between(-3, 3);
      const Vector3d lean = draw.in_box({1, 1, 0}) * std::pow(10, draw.between(-14, -5));
      const Pose X{{off.x(), off.y(), kSide}, rotation_from_vector(lean) * rotation_from_vector({0, 0, turn})};
      const auto& rows = pair.rows_at(X, kMargin);
      for (const Eigen::Vector2d& corner : overlap_of_squares(0.5 * kSide, turn, off.head<2>()))
        ASSERT_LT(nearest_row(rows, corner), kNear)
            << "spacing " << spacing << " seed " << seed << " at " << corner.transpose() << " of turn " << turn
            << " off " << off.transpose() << " lean " << lean.transpose();
    }
  }
}

// Likewise of what is round and hangs over an edge.
TEST(FlushBodies, ThatAreRoundAreHeldWhereTheyHangOver) {
  constexpr double kSide = 0.08, kRadius = 0.015, kHeight = 0.02, kNear = 1e-4;
  Pair pair(make(Solid::Kind::box, {kSide, kSide, kSide}), make(Solid::Kind::cylinder, {kRadius, kHeight}), 0.004);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Draw draw(seed);
    const double over = draw.between(-0.9, 0.9) * kRadius;
    const Vector3d off(0.5 * kSide - over, draw.between(-0.02, 0.02), 0.5 * (kSide + kHeight));
    const Vector3d lean = draw.in_box({1, 1, 0}) * std::pow(10, draw.between(-14, -5));
    const Pose X{off, rotation_from_vector(lean) * rotation_from_vector({0, 0, draw.between(-3, 3)})};
    const auto& rows = pair.rows_at(X, kMargin);
    const double half = std::sqrt(kRadius * kRadius - over * over);
    for (const double side : {-1, 1})
      ASSERT_LT(nearest_row(rows, {0.5 * kSide, off.y() + side * half}), kNear)
          << "seed " << seed << " over " << over << " lean " << lean.transpose() << " side " << side;
  }
}

// Flush to a third of a micrometre: the corner of either may be off the other's face, and where the edges cross holds
// it.
TEST(FlushBodies, OfWhichACornerIsDeepAreHeldThere) {
  constexpr double kSide = 0.03;
  Pair pair(make(Solid::Kind::box, {kSide, kSide, kSide}), make(Solid::Kind::box, {kSide, kSide, kSide}), 0.01);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Draw draw(seed);
    const double depth = std::pow(10, draw.between(-6, -5));
    const Vector3d lean = draw.in_box({1, 1, 0}).normalized() * (depth / kSide);
    const Vector3d off = draw.in_box({3e-7, 3e-7, 0});
    const Pose X{{off.x(), off.y(), kSide}, rotation_from_vector(lean)};  // one corner is as deep as the other is high
    const double corner = 0.5 * kSide * (std::abs(lean.x()) + std::abs(lean.y()));
    double found = 0;
    for (const ContactRow& row : pair.rows_at(X, kMargin))
      if (row.normal.z() > 0.999) found = std::max(found, -row.gap);
    ASSERT_GT(found, 0.9 * corner) << "seed " << seed;
  }
}

}  // namespace
}  // namespace verisim::exact::test::flush_bodies_test

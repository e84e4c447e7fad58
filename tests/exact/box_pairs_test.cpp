// Two boxes at random poses that just touch: corners on faces and edges on edges, near their ends too. The ruler is the
// theorem of separating axes, from poses alone. And bodies of one size, one flush on the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/exact/scenes.hpp"
#include "tests/length.hpp"

namespace verisim::exact::test::box_pairs_test {
namespace {

constexpr double kDt = 0.001, kMargin = 0.001;

/// The least over 15 directions of how far the boxes would have to be moved apart [m]; < 0: they are apart.
double overlap(const Vector3d& half_a, const Vector3d& half_b, const Pose& X_AB) {
  const Matrix3d R = X_AB.rotation.toRotationMatrix();
  double least = 1;
  const auto look = [&](const Vector3d& direction) {
    const double length = direction.norm();
    if (length < 1e-3) return;
    const Vector3d n = direction / length;
    const double reach = n.cwiseAbs().dot(half_a) + (R.transpose() * n).cwiseAbs().dot(half_b);
    least = std::min(least, reach - std::abs(n.dot(X_AB.position)));
  };
  for (int i = 0; i < 3; ++i) {
    look(Vector3d::Unit(i));
    look(R.col(i));
    for (int j = 0; j < 3; ++j) look(Vector3d::Unit(i).cross(R.col(j)));
  }
  return least;
}

/// The second box, moved along some line until it overlaps the first by `depth`.
Pose touching(Draw& draw, const Vector3d& half_a, const Vector3d& half_b, double depth) {
  Pose X{draw.in_box(half_a), draw.rotation()};
  const Vector3d from = X.position, way = draw.in_box({1, 1, 1}).normalized();
  double in = 0, out = 0.2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (in + out);
    X.position = from + middle * way;
    (overlap(half_a, half_b, X) > depth ? in : out) = middle;
  }
  return X;
}

TEST(BoxPairs, OverlapAsTheirSeparatingAxesSay) {
  const Vector3d half_a(0.015, 0.02, 0.01), half_b(0.015, 0.012, 0.018);
  const auto count = verisim::test::by_length<std::uint64_t>(1000, 10000, 400000);
  std::uint64_t deep = 0;
  for (const double spacing : {0.002, 0.01, 0.05}) {  // segments far shorter than the edges, and longer
    Pair pair(make(Solid::Kind::box, {0.03, 0.04, 0.02}), make(Solid::Kind::box, {0.03, 0.024, 0.036}), spacing);
    for (std::uint64_t seed = 0; seed < count; ++seed) {
      Draw draw(seed);
      const Pose X = touching(draw, half_a, half_b, std::pow(10, draw.between(-6, -4)));
      const double wanted = overlap(half_a, half_b, X);
      const Twist twist{draw.in_box({0.2, 0.2, 0.2}), draw.in_box({3, 3, 3})};
      pair.link.find({}, {X, X.position, twist, twist}, kDt, kMargin);
      const double found = pair.link.depth_max();
      // Of two edges the depth is the distance to the nearer face, not the way out.
      ASSERT_GE(found, 0.9 * std::sqrt(0.5) * wanted) << "spacing " << spacing << " seed " << seed;
      ASSERT_LE(found, 1.6 * wanted + 1e-6) << "spacing " << spacing << " seed " << seed;
      const Twist closing{-0.2 * X.position.normalized(), Vector3d::Zero()};
      pair.link.find({}, {X, X.position, closing, closing}, kDt, kMargin);
      double way = 0;
      for (const ContactRow& row : pair.link.rows().rows()) way = std::max(way, -row.gap);
      ASSERT_GE(way, 0.9 * wanted) << "spacing " << spacing << " seed " << seed;
      deep += found > 1.1 * wanted + 1e-6 ? 1 : 0;
    }
  }
  // Near a corner a face can be deeper than the shortest way out.
  EXPECT_LE(static_cast<double>(deep), 0.001 * static_cast<double>(3 * count));
}

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
    std::array<double, 4> stiffness{};
    for (const ContactRow& row : pair.link.rows().rows()) {
      if (row.normal.z() > 0.999) stiffness[(row.point.x() > 0 ? 1 : 0) + (row.point.y() > 0 ? 2 : 0)] += row.stiffness;
    }
    const auto [least, most] = std::minmax_element(stiffness.begin(), stiffness.end());
    ASSERT_GT(*least, 0.65 * *most) << "seed " << seed;
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
}  // namespace verisim::exact::test::box_pairs_test

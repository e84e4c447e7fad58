// Two boxes at random poses that just touch: corners on faces and edges on edges, near their ends too. The ruler is the
// theorem of separating axes, from poses alone.
#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace verisim::exact::test::box_pairs_test

// Boxes that are certainly apart, against two of their points whose distance is known.
#include "engine/exact/oriented_box.hpp"

#include <gtest/gtest.h>

#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::oriented_box_test {
namespace {

/// Turned against each other by anything from nothing to any angle: bodies that stand on one floor are parallel to
/// 1e-10 rad.
std::pair<OrientedBox, OrientedBox> drawn(Draw& draw) {
  const auto size = [&] {
    return Vector3d(draw.between(0.001, 0.1), draw.between(0.001, 0.1), draw.between(0.001, 0.1));
  };
  OrientedBox a, b;
  a.half = size();
  b.half = size();
  const Quaterniond R = draw.rotation();
  const Vector3d turn = std::pow(10, draw.between(-17, 0.5)) * draw.in_box({1, 1, 1}).normalized();
  // About one of its own axes half of them turn: those then stay parallel.
  const Vector3d about = draw.between(0, 1) < 0.5 ? turn : Vector3d(0, 0, draw.between(-3, 3) + 1e-10 * turn.x());
  a.R = R.toRotationMatrix();
  b.R = (R * rotation_from_vector(about + 1e-10 * draw.in_box({1, 1, 1}))).toRotationMatrix();
  return {a, b};
}

/// A point of the box, from its centre, that is farthest along n; any of them where several are, to a millionth.
Vector3d farthest(Draw& draw, const OrientedBox& box, const Vector3d& n) {
  Vector3d p;
  for (int i = 0; i < 3; ++i) {
    const double along = box.R.col(i).dot(n);
    p[i] = std::abs(along) < 1e-6 ? draw.between(-1, 1) * box.half[i] : std::copysign(box.half[i], along);
  }
  return box.R * p;
}

// A box of 30 mm that stood on the floor of a tray was culled 0.2 mm before another one that stood there: the length of
// the direction across both, 3e-10, was the root of a difference from 1, and came out as 0.
TEST(OrientedBoxes, WithPointsWithinTheMarginAreNotApart) {
  for (std::uint64_t seed = 0; seed < 100000; ++seed) {
    Draw draw(seed);
    auto [a, b] = drawn(draw);
    const double margin = std::pow(10, draw.between(-6, -2));
    const Vector3d n = draw.between(0, 1) < 0.5 ? Vector3d(a.R.col(0)) : draw.in_box({1, 1, 1}).normalized();
    b.center = farthest(draw, a, n) + 0.99 * margin * n - farthest(draw, b, -n);
    ASSERT_FALSE(are_apart(a, b, margin)) << "seed " << seed;
  }
}

TEST(OrientedBoxes, BeyondTheMarginFromAFaceAreApart) {
  for (std::uint64_t seed = 0; seed < 100000; ++seed) {
    Draw draw(seed);
    auto [a, b] = drawn(draw);
    const double margin = std::pow(10, draw.between(-6, -2));
    const Vector3d n = a.R.col(0);
    b.center = farthest(draw, a, n) + (1.01 * margin + 5e-7) * n - farthest(draw, b, -n);
    ASSERT_TRUE(are_apart(a, b, margin)) << "seed " << seed;
    ASSERT_TRUE(are_apart(b, a, margin)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace verisim::exact::test::oriented_box_test

#include "engine/exact/exact_link.hpp"

#include <gtest/gtest.h>

#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::exact_link_test {
namespace {

using Kind = Solid::Kind;
using Eigen::Vector2d;

constexpr double kMargin = 0.001;
constexpr double kRounding =
    2e-10;  // m: entities are rounded to 1.5e-11 m, and a slide stops when 1e-10 m are left to win

const Vector3d kBox(0.04, 0.03, 0.02);

Solid box(const Vector3d& size) {
  return make(Kind::box, {size.x(), size.y(), size.z()});
}

/// Distance of a point outside to a box around the origin.
double distance_to_box(const Vector3d& p, const Vector3d& half) {
  return (p.cwiseAbs() - half).cwiseMax(0).norm();
}

// The closed form holds at faces, edges and corners alike: a ball's middle is as far from the box as it is.
TEST(BallAndBox, AreAsFarApartAsTheClosedFormSays) {
  constexpr double kRadius = 0.007;
  Pair pair(box(kBox), make(Kind::sphere, {kRadius}));
  int near = 0;
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    Draw draw(seed);
    const Vector3d p = draw.in_box(0.5 * kBox + Vector3d::Constant(kRadius + kMargin));
    const double gap = distance_to_box(p, 0.5 * kBox) - kRadius;
    if (gap < -0.0019) continue;  // deeper than a sample's spacing is not looked for
    const double found = pair.gap_at({p, draw.rotation()}, kMargin);
    ASSERT_NEAR(found, std::min(gap, kMargin), kRounding) << "seed " << seed << " at " << p.transpose();
    near += gap < kMargin ? 1 : 0;
  }
  EXPECT_GT(near, 3000);
}

// Inside, above, beside and at the rims of a tube alike: in the plane through its axis the tube is a rectangle.
TEST(BallAndTube, AreAsFarApartAsTheClosedFormSays) {
  constexpr double kOuter = 0.045;
  constexpr double kInner = 0.03;
  constexpr double kHalf = 0.06;
  for (const double radius : {0.029, 0.008}) {
    Pair pair(make(Kind::tube, {kOuter, kInner, 2 * kHalf}), make(Kind::sphere, {radius}));
    int near = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
      Draw draw(seed);
      Vector3d p = draw.in_box({kOuter + radius, kOuter + radius, kHalf + radius});
      if (seed % 2 == 0) p.head<2>() *= (kInner - radius) / kOuter;  // where the bore leaves it room
      const Vector2d across(p.head<2>().norm() - 0.5 * (kOuter + kInner), p.z());
      const double gap = (across.cwiseAbs() - Vector2d(0.5 * (kOuter - kInner), kHalf)).cwiseMax(0).norm() - radius;
      if (gap < -0.0019) continue;
      ASSERT_NEAR(pair.gap_at({p, draw.rotation()}, kMargin), std::min(gap, kMargin), kRounding)
          << "seed " << seed << " at " << p.transpose();
      near += gap < kMargin ? 1 : 0;
    }
    EXPECT_GT(near, 500);
  }
}

// Two pins across each other: the distance of their axes less both radii.
TEST(CrossedPins, AreAsFarApartAsTheirAxesLessTheirRadii) {
  constexpr double kFirst = 0.01;
  constexpr double kSecond = 0.006;
  Pair pair(make(Kind::cylinder, {kFirst, 0.1}), make(Kind::cylinder, {kSecond, 0.1}));
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Draw draw(seed);
    const double gap = draw.between(-0.0005, 0.0005);
    const double turn = draw.between(-3, 3);
    const Vector3d across(std::cos(turn), std::sin(turn), 0);
    const Vector3d along = Vector3d::UnitZ().cross(across);
    const double lean = draw.between(0.4, 2.7);
    const Vector3d axis = std::cos(lean) * Vector3d::UnitZ() + std::sin(lean) * along;
    const Vector3d p = (kFirst + kSecond + gap) * across + draw.between(-0.03, 0.03) * Vector3d::UnitZ() +
                       draw.between(-0.03, 0.03) * axis;
    const Quaterniond rotation = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
    ASSERT_NEAR(pair.gap_at({p, rotation}, kMargin), gap, kRounding) << "seed " << seed;
  }
}

// Edge across edge, both leaning: where they overlap the normal is across both and the gap is that of the two lines.
// Before they do, a gap may be the smaller one to the planes of the two faces; it never is larger.
TEST(CrossedEdges, AreAsFarApartAsTheirLines) {
  Pair pair(box({0.05, 0.05, 0.05}), box({0.05, 0.05, 0.05}));
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Draw draw(seed);
    const double gap = draw.between(-0.0003, 0.0003);
    // The first's edge x = z = 0.025 along y, the second's edge x = z = -0.025 along its y, turned about the bisector.
    const Vector3d bisector = Vector3d(1, 0, 1).normalized();
    const Quaterniond turn(Eigen::AngleAxisd(draw.between(0.3, 1.3) * (seed % 2 == 0 ? 1 : -1), bisector));
    const Vector3d here(0.025, draw.between(-0.02, 0.02), 0.025);
    const Vector3d there(-0.025, draw.between(-0.02, 0.02), -0.025);
    const Pose X{here + gap * bisector - turn * there, turn};
    const double found = pair.gap_at(X, kMargin);
    if (gap > 0) {
      ASSERT_LE(found, gap + kRounding) << "seed " << seed;
      ASSERT_GE(found, 0.5 * gap) << "seed " << seed;
      continue;
    }
    ASSERT_NEAR(found, gap, kRounding) << "seed " << seed;
    const auto& rows = pair.link.rows().rows();
    const auto deepest =
        std::min_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
    ASSERT_GT(deepest->normal.dot(bisector), 1 - 1e-9);
  }
}

// A corner above a plane: the gap is the corner's height, whatever the box's orientation.
TEST(CornerOverAPlane, IsAsFarAwayAsItsHeight) {
  Pair pair(box({0.2, 0.2, 0.02}), box(kBox));
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Draw draw(seed);
    const Quaterniond rotation = draw.rotation();
    const Matrix3d R = rotation.toRotationMatrix();
    const double lowest = R.row(2).cwiseAbs().dot(0.5 * kBox);
    const double gap = draw.between(-0.0005, 0.0005);
    const Vector3d p(draw.between(-0.06, 0.06), draw.between(-0.06, 0.06), 0.01 + lowest + gap);
    ASSERT_NEAR(pair.gap_at({p, rotation}, kMargin), gap, kRounding) << "seed " << seed;
  }
}

/// A solid of two boxes: where they meet edges are concave, and at their ends two convex edges meet a concave one or
/// two concave ones a convex one.
struct TwoBoxes {
  Vector3d first, second;  ///< m, sizes
  Vector3d at;             ///< m, the second's middle
  [[nodiscard]] Solid solid() const {
    return combine(Kind::sum, box(first), placed(box(second), {at, Quaterniond::Identity()}));
  }
  [[nodiscard]] double distance(const Vector3d& p) const {
    return std::min(distance_to_box(p, 0.5 * first), distance_to_box(p - at, 0.5 * second));
  }
};
const TwoBoxes kCross{{0.08, 0.02, 0.016}, {0.02, 0.06, 0.016}, {0, 0, 0}};
const TwoBoxes kBossOnAPlate{{0.08, 0.06, 0.016}, {0.03, 0.02, 0.02}, {0.01, 0.005, 0.018}};

// Outside of two boxes the nearer one's distance is that of both, also beside the ends of concave edges, where a face's
// plane goes on above, below and beside the face.
TEST(BallAndTwoBoxes, AreAsFarApartAsTheClosedFormSays) {
  constexpr double kRadius = 0.007;
  for (const TwoBoxes& base : {kCross, kBossOnAPlate}) {
    Pair pair(base.solid(), make(Kind::sphere, {kRadius}));
    int near = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
      Draw draw(seed);
      const Vector3d p = draw.in_box(Vector3d(0.05, 0.045, 0.04));
      const double gap = base.distance(p) - kRadius;
      if (gap < -0.0019) continue;
      ASSERT_NEAR(pair.gap_at({p, draw.rotation()}, kMargin), std::min(gap, kMargin), kRounding)
          << "seed " << seed << " at " << p.transpose();
      near += gap < kMargin ? 1 : 0;
    }
    EXPECT_GT(near, 1000);
  }
}

// A slider that lies on a plate beside a boss, or on a cross, pressed in by a micrometre: its edges run past the
// planes of all other faces, and none of those faces owns them.
TEST(SliderOnTwoBoxes, OverlapsByWhatItIsPressedInAndNoMore) {
  constexpr double kPressed = 1e-6;
  const Vector3d slider(0.02, 0.016, 0.01);
  for (const TwoBoxes& base : {kCross, kBossOnAPlate}) {
    Pair pair(base.solid(), box(slider));
    const bool has_boss = base.at.z() > 0;
    int beside = 0;
    for (std::uint64_t seed = 0; seed < 5000; ++seed) {
      Draw draw(seed);
      Vector3d p = draw.in_box(Vector3d(0.045, 0.035, 0));
      p.z() = 0.5 * (base.first.z() + slider.z()) - kPressed;
      const Vector3d off = (p - base.at).cwiseAbs() - 0.5 * (base.second + slider);
      if (has_boss && std::max(off.x(), off.y()) < 0) continue;
      ASSERT_GE(pair.gap_at({p, Quaterniond::Identity()}, 1e-4), -kPressed - kRounding)
          << "seed " << seed << " at " << p.transpose();
      beside += std::max(off.x(), off.y()) < 0.001 ? 1 : 0;
    }
    EXPECT_GT(beside, 100);
  }
}

// A plate on a ball's pole touches it where the chart of the ball is degenerate: all turns are one place, and the last
// cells end.
TEST(PlateOnABall, RestsOnThePole) {
  constexpr double kRadius = 0.03;
  constexpr double kGap = 1e-5;
  const Vector3d size(0.04, 0.04, 0.01);
  for (const double spacing : {0.0015, 0.002, 0.0031, 0.008, 0.011}) {
    Pair pair(make(Kind::sphere, {kRadius}), box(size), spacing);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      Draw draw(seed);
      const double side = seed % 2 == 0 ? 1 : -1;
      const Vector3d p(draw.between(-0.015, 0.015), draw.between(-0.015, 0.015),
                       side * (kRadius + 0.5 * size.z() + kGap));
      const Quaterniond rotation(Eigen::AngleAxisd(draw.between(-3, 3), Vector3d::UnitZ()));
      ASSERT_NEAR(pair.gap_at({p, rotation}, kMargin), kGap, kRounding) << "spacing " << spacing << " seed " << seed;
    }
  }
}

// A box lies on a plate with a hollow; bottom and plate all but coincide. Where the box's edges cross the hollow's rim,
// at whatever angle, it overlaps no more than elsewhere.
TEST(BoxOverAHollow, OverlapsByWhatItIsPressedInWhereItsEdgesCrossTheRim) {
  constexpr double kLean = 1e-6;  // rad
  const Vector3d plate(0.1, 0.1, 0.02);
  const Vector3d above(0.04, 0.04, 0.01);
  const Pose top{{0, 0, 0.5 * plate.z()}, Quaterniond::Identity()};
  for (const double radius : {0.016, 0.02, 0.026}) {
    Pair pair(combine(Kind::difference, box(plate), placed(make(Kind::sphere, {radius}), top)), box(above), 0.01);
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
      Draw draw(seed);
      const Vector3d lean(draw.between(-kLean, kLean), draw.between(-kLean, kLean), 0);
      const double deepest = 0.5 * (above.x() * std::abs(lean.y()) + above.y() * std::abs(lean.x())) + 1e-9;
      Vector3d p = draw.in_box(Vector3d(0.02, 0.02, 0));
      p.z() = 0.5 * (plate.z() + above.z()) - 1e-9;
      ASSERT_GE(pair.gap_at({p, rotation_from_vector(lean)}, 1e-4), -deepest - kRounding)
          << "radius " << radius << " seed " << seed << " at " << p.transpose();
    }
  }
}

Solid ring_shape(double outer, double inner, double height) {
  return combine(Kind::difference, make(Kind::cylinder, {outer, height}), make(Kind::cylinder, {inner, 2 * height}));
}

// A bearing's outer ring with a groove inside, 9 um of clearance in its housing. Where the ring is as high as here, the
// groove's upper side is level with the housing's top, 3.7 mm away on the other side of a wall of 2.7 mm: samples that
// are farther apart than the wall is thick must not take the one for the other.
TEST(GrooveInARing, IsNotReachedThroughTheRing) {
  const Solid groove = make(Kind::cylinder, {0.020766, 0.0091});
  const Solid ring = combine(Kind::difference, ring_shape(0.02349725, 0.01925, 0.014), groove);
  const Solid lead =
      placed(make(Kind::cone, {0.02350625, 0.02450625, 0.001}), {{0, 0, 0.0065}, Quaterniond::Identity()});
  const Solid housing = combine(Kind::difference, ring_shape(0.032, 0.02350625, 0.014), lead);
  for (const double spacing : {0.001, 0.002, 0.003, 0.005}) {
    SCOPED_TRACE(spacing);
    Pair pair(housing, ring, spacing);
    EXPECT_NEAR(pair.gap_at({{0, 0, 0.00245 - 1e-5}, Quaterniond::Identity()}, kMargin), 9e-6, kRounding);
  }
}

}  // namespace
}  // namespace verisim::exact::test::exact_link_test

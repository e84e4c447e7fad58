#include "engine/voxel/overlap.hpp"

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/exact.hpp"

namespace verisim::overlap_test {
namespace {

/// Draws whole numbers and fractions one after the other.
class Dice {
 public:
  explicit Dice(std::string_view name) : stream_(1, name) {}
  int whole(int low, int high) {
    return low + static_cast<int>(stream_.bits(counter_++) % static_cast<std::uint64_t>(high - low + 1));
  }
  double real(double low, double high) { return low + (high - low) * stream_.uniform(counter_++); }
  Eigen::Vector3i whole_vector(int low, int high) {
    const int x = whole(low, high), y = whole(low, high), z = whole(low, high);
    return {x, y, z};
  }
  Vector3d real_vector(double low, double high) {
    const double x = real(low, high), y = real(low, high), z = real(low, high);
    return {x, y, z};
  }

 private:
  RandomStream stream_;
  std::uint64_t counter_ = 0;
};

// Whole numbers up to 8 make exact touches, shared walls and degenerate triangles common. Disjoint shapes of such
// numbers are farther apart than 1/600 of the box, so that the tolerance of 2^-20 cannot excuse a wrong yes either.
TEST(TriangleTouchesBox, AgreesWithExactArithmetic) {
  Dice dice("exact");
  int touching = 0, degenerate = 0;
  constexpr int kCases = 100000;
  for (int i = 0; i < kCases; ++i) {
    std::vector<Eigen::Vector3i> t = {dice.whole_vector(-8, 8), dice.whole_vector(-8, 8), dice.whole_vector(-8, 8)};
    if (i % 16 == 0) t[2] = t[0] + 2 * (t[1] - t[0]).array().sign().matrix();  // often a segment
    if (i % 64 == 1) t[2] = t[1];
    const Eigen::Vector3i center = dice.whole_vector(-3, 3);
    const int half = dice.whole(1, 4);
    const bool expected = exact::touches(t, center, half);
    touching += expected ? 1 : 0;
    degenerate += (t[1] - t[0]).cross(t[2] - t[0]).isZero() ? 1 : 0;
    ASSERT_EQ(triangle_touches_box(t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>(), center.cast<double>(),
                                   half),
              expected)
        << "case " << i;
  }
  EXPECT_GT(touching, kCases / 10);
  EXPECT_LT(touching, 9 * kCases / 10);
  EXPECT_GT(degenerate, kCases / 100);
}

/// A triangle that touches the box [-1,1]^3 from outside, and the way on which it leaves the box grown by one tolerance
/// of the half side is one unit of distance on the separating axis.
struct Touch {
  const char* name;
  Vector3d a, b, c;
  Vector3d away;
};

std::vector<Touch> touches() {
  return {
      {"face on face", {1, -3, -3}, {1, 3, -3}, {1, 0, 3}, {1, 0, 0}},
      {"corner on face", {1, 0.2, 0.3}, {2, 1, 0}, {2, -1, 0.5}, {1, 0, 0}},
      {"face on corner", {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {1, 1, 1}},
      {"edge on edge", {2, 0, -5}, {0, 2, 5}, {3, 3, 0.5}, {1, 1, 0}},
      {"corner on corner", {1, 1, 1}, {2, 3, 4}, {4, 3, 2}, {1, 1, 1}},
      {"segment on edge", {1, 1, -3}, {1, 1, 3}, {1, 1, 0}, {1, 1, 0}},
      {"point on face", {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
  };
}

TEST(TriangleTouchesBox, IsExactToTwoTolerancesAtEveryKindOfTouch) {
  for (const Touch& touch : touches()) {
    SCOPED_TRACE(touch.name);
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const auto touched_at = [&](double tolerances) {
        const Vector3d shift = tolerances * kTouchTolerance * touch.away;
        return triangle_touches_box(scale * (touch.a + shift), scale * (touch.b + shift), scale * (touch.c + shift),
                                    Vector3d::Zero(), scale);
      };
      EXPECT_TRUE(touched_at(-1));
      EXPECT_TRUE(touched_at(0));
      EXPECT_TRUE(touched_at(0.9));
      EXPECT_FALSE(touched_at(2));
    }
  }
}

// A sliver's normal is nothing but rounding; it must not separate what touches.
TEST(TriangleTouchesBox, NeverLosesASliver) {
  Dice dice("sliver");
  for (int i = 0; i < 20000; ++i) {
    const Vector3d inside = dice.real_vector(-0.5, 0.5);  // on the segment, by construction
    const Vector3d direction = dice.real_vector(-1, 1);
    const double before = dice.real(0, 1000), after = dice.real(0, 1000);
    const Vector3d a = inside - before * direction, b = inside + after * direction;
    const Vector3d c = a + dice.real(0, 1) * (b - a);
    ASSERT_TRUE(triangle_touches_box(a, b, c, Vector3d::Zero(), 0.5)) << "case " << i;
    const BrickMask mask = TriangleOverlap(a, b, c).touched(
        {.corner = Vector3d::Constant(-3.5), .side = 1, .half_side = 0.5 * (1 + kTouchTolerance)});
    ASSERT_TRUE(contains(mask, 3, 3, 3)) << "case " << i;
  }
}

void expect_the_same(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& corner, double side) {
  const BrickMask mask = TriangleOverlap(a, b, c).touched(
      {.corner = corner, .side = side, .half_side = 0.5 * side * (1 + kTouchTolerance)});
  for (int i = 0; i < kBrickCells; ++i) {
    const Eigen::Vector3i cell(i & 7, i >> 3 & 7, i >> 6);
    const Vector3d center = corner + side * (cell.cast<double>() + Vector3d::Constant(0.5));
    ASSERT_EQ(contains(mask, cell.x(), cell.y(), cell.z()), triangle_touches_box(a, b, c, center, 0.5 * side))
        << "cell " << cell.transpose();
  }
}

TEST(TriangleOverlap, EqualsTheSingleBoxTestOnWholeAndHalfNumbers) {
  Dice dice("lattice");
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const Vector3d corner = 8 * dice.whole_vector(0, 100).cast<double>();
    const auto draw = [&] { return Vector3d(corner + 0.5 * dice.whole_vector(-4, 20).cast<double>()); };
    const Vector3d a = draw(), b = draw(), c = draw();
    expect_the_same(a, b, c, corner, 1);
    if (HasFatalFailure()) return;
  }
}

TEST(TriangleOverlap, EqualsTheSingleBoxTestForTrianglesOfAnySize) {
  Dice dice("sizes");
  for (int i = 0; i < 8000; ++i) {
    SCOPED_TRACE(i);
    const double side = 1 << (3 * dice.whole(0, 2)), size = side * std::pow(10.0, dice.whole(-2, 3));
    const Vector3d corner = 8 * side * dice.whole_vector(0, 20).cast<double>();
    const Vector3d near = corner + side * dice.real_vector(0, 8);
    const Vector3d a = near + size * dice.real_vector(-1, 1), b = near + size * dice.real_vector(-1, 1);
    expect_the_same(a, b, near, corner, side);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace verisim::overlap_test

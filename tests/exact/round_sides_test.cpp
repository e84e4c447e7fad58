// Round outsides against each other, away from all edges: pins and cones, whose common normal is known in closed form.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/exact/scenes.hpp"
#include "tests/length.hpp"

namespace verisim::exact::test::round_sides_test {
namespace {

using Kind = Solid::Kind;

constexpr double kMargin = 0.001;
constexpr double kRounding = 2e-10;  // m: entities are rounded to 1.5e-11 m, and a slide stops at 1e-10 m to win
constexpr double kAside = 4e-6;      // m, to which side that leaves a place: sqrt(2 x 1e-10 m x 0.08 m)
constexpr double kTurned = 1e-4;     // and the normal by as much over the least radius
constexpr double kHeight = 0.06;

/// A pin or cone around the z axis, its middle in the origin.
struct Round {
  const char* name;
  double bottom, top;  ///< m, radii

  friend void PrintTo(const Round& round, std::ostream* out) { *out << round.name; }
  [[nodiscard]] double taper() const { return (top - bottom) / kHeight; }
  [[nodiscard]] Solid solid() const {
    return top == bottom ? make(Kind::cylinder, {top, kHeight}) : make(Kind::cone, {bottom, top, kHeight});
  }
  /// In the plane of x and z.
  [[nodiscard]] Vector3d point(double z) const { return {0.5 * (bottom + top) + taper() * z, 0, z}; }
  [[nodiscard]] Vector3d normal() const { return Vector3d(1, 0, -taper()).normalized(); }
  [[nodiscard]] Vector3d generator() const { return Vector3d(taper(), 0, 1).normalized(); }
};

const Round kPin{"pin", 0.02, 0.02}, kCone{"cone", 0.015, 0.035}, kSlim{"slim cone", 0.02, 0.021},
    kFlat{"flat cone", 0.01, 0.12}, kPointed{"pointed cone", 0.02, 0};

/// The second's place and orientation if its point at height z2 lies `gap` over the first's at z1, their normals
/// opposite and their generators turned by `turn` against each other.
Pose beside(const Round& first, double z1, const Round& second, double z2, double gap, double turn) {
  const auto axes_of = [](const Vector3d& n, const Vector3d& t) {
    Matrix3d m;
    m << n, t, n.cross(t);
    return m;
  };
  const Vector3d t = std::cos(turn) * first.generator() + std::sin(turn) * first.normal().cross(first.generator());
  const Quaterniond rotation(
      Matrix3d(axes_of(-first.normal(), t) * axes_of(second.normal(), second.generator()).transpose()));
  return {first.point(z1) + gap * first.normal() - rotation * second.point(z2), rotation};
}

using Two = std::pair<Round, Round>;
class RoundSides : public ::testing::TestWithParam<Two> {};
INSTANTIATE_TEST_SUITE_P(Pairs, RoundSides,
                         ::testing::Values(Two{kCone, kCone}, Two{kCone, kPin}, Two{kPin, kCone}, Two{kSlim, kCone},
                                           Two{kFlat, kCone}, Two{kPin, kFlat}, Two{kPointed, kSlim}, Two{kPin, kPin}));

// Both are convex and the common tangent plane lies between them, so they are as far apart as their points there; and
// where they overlap the row at that place is as deep, along the common normal and between both points.
TEST_P(RoundSides, ThatCrossAreAsFarApartAsTheirNearestPoints) {
  const auto& [first, second] = GetParam();
  Pair pair(first.solid(), second.solid());
  for (std::uint64_t seed = 0; seed < verisim::test::by_length<std::uint64_t>(300, 4000, 40000); ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double gap = draw.between(-0.0003, 0.0003);
    const double z1 = draw.between(-0.02, 0.02);
    const double turn = draw.between(0.4, 2.7);
    const Pose X = beside(first, z1, second, draw.between(-0.02, 0.02), gap, turn);
    const Pose around{Vector3d::Zero(), Quaterniond(Eigen::AngleAxisd(draw.between(-3, 3), Vector3d::UnitZ()))};
    ASSERT_NEAR(pair.gap_at(around * X, kMargin), gap, kRounding);
    const auto& rows = pair.link.rows().rows();
    const auto deepest =
        std::min_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
    EXPECT_LE((deepest->normal - around.rotation * first.normal()).norm(), kTurned);
    EXPECT_LE((deepest->point - around * first.point(z1)).norm(), std::abs(gap) + kAside);
  }
}

// Side by side, their generators touch all along: no row overlaps more than the generators do, and those that do as
// much hold both ends of the common length.
TEST_P(RoundSides, ThatLieAlongEachOtherTouchAllAlong) {
  const auto& [first, second] = GetParam();
  Pair pair(first.solid(), second.solid());
  for (const double turn : {0.0, 3.14159265358979323846}) {
    for (const double gap : {-1e-5, 0.0, 1e-5}) {
      SCOPED_TRACE(gap);
      const Pose X = beside(first, 0, second, 0.005, gap, turn);
      ASSERT_NEAR(pair.gap_at(X, kMargin), gap, kRounding);
      double low = 1;
      double high = -1;
      for (const ContactRow& row : pair.link.rows().rows()) {
        if (row.gap > gap + kRounding) continue;
        EXPECT_LE((row.normal - first.normal()).norm(), kTurned);
        const double along = first.generator().dot(row.point - first.point(0));
        low = std::min(low, along);
        high = std::max(high, along);
      }
      EXPECT_LE(low, -0.02);
      EXPECT_GE(high, 0.02);
    }
  }
}

}  // namespace
}  // namespace verisim::exact::test::round_sides_test

// Every sort of surface against its parametrization, against brute force and against finite differences.
#include "engine/geometry/analytic_surface.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/surface_sorts.hpp"

namespace verisim::testing::analytic_surface_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vector3d kO = Vector3d::Zero(), kX = Vector3d::UnitX(), kZ = Vector3d::UnitZ();

class EverySurface : public ::testing::TestWithParam<SurfaceSort> {
 protected:
  using Inputs = test::Inputs;
  [[nodiscard]] static PlacedSort placed(std::uint64_t seed) { return {GetParam(), seed}; }
  /// Parameters of the stretch, and a height above it.
  struct Place {
    double u, v, height;
  };
  [[nodiscard]] static Place any_place(Inputs& inputs) {
    const SurfaceSort& sort = GetParam();
    const double u = inputs.between(sort.u[0], sort.u[1]), v = inputs.between(sort.v[0], sort.v[1]);
    return {u, v, inputs.between(-sort.depth, sort.depth)};
  }
};
INSTANTIATE_TEST_SUITE_P(Sorts, EverySurface, ::testing::ValuesIn(kSurfaceSorts),
                         [](const auto& instance) { return std::string(instance.param.name); });

// A point put a height above the surface along its normal is that height away, the normal leads back, and its foot is
// where it was put up.
TEST_P(EverySurface, TellsTheHeightNormalAndFootThatAPointWasGiven) {
  for (const std::uint64_t seed : test::seeds(1000)) {
    const PlacedSort sort = placed(seed);
    const AnalyticSurface surface = sort.surface();
    Inputs inputs(seed + 5000);
    const auto [u, v, height] = any_place(inputs);
    const Vector3d normal = sort.normal(u, v);
    const Vector3d p = sort.on(u, v) + height * normal;
    const SurfaceAt found = surface.at(p);
    ASSERT_NEAR(found.distance, height, 1e-9) << "seed " << seed;
    ASSERT_LE((found.normal - normal).norm(), 2e-8) << "seed " << seed;
    ASSERT_NEAR(found.normal.norm(), 1, 1e-14);
    ASSERT_LE((surface.foot(p) - sort.on(u, v)).norm(), 1e-9) << "seed " << seed;
  }
}

// No point of the surface is nearer than the distance, and of a fine grid of them one is as near, but for the grid.
TEST_P(EverySurface, IsAsFarAwayAsTheNearestOfManyOfItsPoints) {
  constexpr int kGrid = 300;
  const auto [u0, u1] = GetParam().u;
  const auto [v0, v1] = GetParam().v;
  for (const std::uint64_t seed : test::seeds(6)) {
    const PlacedSort sort = placed(seed);
    Inputs inputs(seed + 7000);
    const double u = inputs.between(0.7 * u0 + 0.3 * u1, 0.3 * u0 + 0.7 * u1);
    const double v = inputs.between(0.7 * v0 + 0.3 * v1, 0.3 * v0 + 0.7 * v1);
    const Vector3d p = sort.on(u, v) + inputs.between(-1, 1) * GetParam().depth * sort.normal(u, v);
    double nearest = kInfinity;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; j <= kGrid; ++j)
        nearest = std::min(nearest, (sort.on(u0 + (u1 - u0) * i / kGrid, v0 + (v1 - v0) * j / kGrid) - p).norm());
    }
    const double distance = std::abs(sort.surface().at(p).distance);
    EXPECT_LE(distance, nearest + 1e-12) << "seed " << seed;
    EXPECT_NEAR(distance, nearest, 1e-3) << "seed " << seed;  // half a cell of the grid to the side
  }
}

// Anywhere, also where the nearest place is an apex: the foot is on the surface, its own foot, never nearer than |d|,
// and no point of the surface that a walk from it meets is nearer.
TEST_P(EverySurface, HasAFootThatNoOtherPointOfItIsNearerThan) {
  for (const std::uint64_t seed : test::seeds(500)) {
    const PlacedSort sort = placed(seed);
    const AnalyticSurface surface = sort.surface();
    Inputs inputs(seed + 8000);
    const Vector3d p = sort.at() * Vector3d(inputs.vector(0.1));
    const Vector3d foot = surface.foot(p);
    const double way = (foot - p).norm();
    ASSERT_NEAR(surface.at(foot).distance, 0, 1e-12) << "seed " << seed;
    ASSERT_LE((surface.foot(foot) - foot).norm(), 1e-7) << "seed " << seed;
    ASSERT_GE(way, std::abs(surface.at(p).distance) - 1e-12) << "seed " << seed;
    for (int i = 0; i < 20; ++i) {
      const Vector3d other = surface.foot(foot + inputs.vector(0.03));
      ASSERT_GE((other - p).norm(), way - 1e-9) << "seed " << seed;
    }
  }
}

// Where the surface's parameters say that a point is: lengths as they are, angles as the share of a turn.
TEST_P(EverySurface, ChartsAPointByItsParameters) {
  const auto turn = [](double angle) { return turn_of(std::cos(angle), std::sin(angle)); };
  const auto wrapped = [](double angle) { return std::remainder(angle, kWholeTurn); };
  const bool is_lemon = std::string(GetParam().name) == "lemon";
  for (const std::uint64_t seed : test::seeds(200)) {
    const PlacedSort sort = placed(seed);
    const AnalyticSurface surface = sort.surface();
    Inputs inputs(seed + 9000);
    const Place place = any_place(inputs);
    const double u = place.u, v = place.v;
    const std::array<double, 2> parameters = surface.parameters(sort.on(u, v));
    const bool is_plane = surface.kind() == SurfaceKind::plane;
    const bool is_sphere = surface.kind() == SurfaceKind::sphere, is_torus = surface.kind() == SurfaceKind::torus;
    ASSERT_NEAR(is_plane ? parameters[0] - u : wrapped(parameters[0] - u), 0, 1e-12) << "seed " << seed;
    ASSERT_NEAR(is_torus ? wrapped(parameters[1] - v) : parameters[1] - v, 0, 1e-12) << "seed " << seed;
    std::array<double, 2> want{turn(u), v};
    if (is_plane) want = {u, v};
    if (is_sphere) want = {turn(u), std::sin(v)};
    if (is_torus) want = {turn(u), turn(v)};
    if (is_lemon) want = {turn(u + kWholeTurn / 2), turn(kWholeTurn / 2 - v)};  // seen across the axis
    const std::array<double, 2> found = surface.chart(sort.on(u, v));
    ASSERT_NEAR(found[0], want[0], 1e-10) << "seed " << seed;
    ASSERT_NEAR(found[1], want[1], 1e-10) << "seed " << seed;
  }
}

// Central differences over 1 um: off by the third derivative times 1e-12 / 6, below 1e-6 where no fold is within 1 mm.
TEST_P(EverySurface, HasTheGradientOfItsDistance) {
  constexpr double kStep = 1e-6;
  int compared = 0;
  for (const std::uint64_t seed : test::seeds(400)) {
    const AnalyticSurface surface = placed(seed).surface();
    Inputs inputs(seed + 11000);
    const Vector3d p = surface.point() + inputs.vector(0.1);
    if (!std::isfinite(surface.curvature_bound(p, 1e-3))) continue;
    ++compared;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep * Vector3d::Unit(axis);
      const double slope = (surface.at(p + step).distance - surface.at(p - step).distance) / (2 * kStep);
      ASSERT_NEAR(surface.at(p).normal[axis], slope, 1e-6) << "seed " << seed;
    }
  }
  EXPECT_GT(compared, 300);
}

// The distance never grows faster than the way: gradients are unit also where the function has folds.
TEST_P(EverySurface, IsNoSteeperThanOne) {
  for (const std::uint64_t seed : test::seeds(500)) {
    const AnalyticSurface surface = placed(seed).surface();
    Inputs inputs(seed + 13000);
    const Vector3d p = surface.point() + inputs.vector(0.1), q = surface.point() + inputs.vector(0.1);
    ASSERT_LE(std::abs(surface.at(p).distance - surface.at(q).distance), (p - q).norm() + 1e-15) << "seed " << seed;
    ASSERT_NEAR(surface.at(p).normal.norm(), 1, 1e-14);
  }
}

// Second differences in any direction, at places anywhere within reach. With no reach the bound is not only one: along
// some direction cylinder, cone and sphere bend so much.
TEST_P(EverySurface, BendsNoMoreThanItsBoundSays) {
  constexpr double kStep = 1e-5;
  const auto bend_along = [](const AnalyticSurface& s, const Vector3d& p, const Vector3d& step) {
    return (s.at(p + step).distance - 2 * s.at(p).distance + s.at(p - step).distance) / step.squaredNorm();
  };
  double tightest = 0;
  for (const std::uint64_t seed : test::seeds(300)) {
    const AnalyticSurface surface = placed(seed).surface();
    Inputs inputs(seed + 15000);
    const Vector3d p = surface.point() + inputs.vector(0.08);
    const double reach = inputs.between(0, 0.01);
    const double bound = surface.curvature_bound(p, reach + kStep);
    if (!(bound < 1000)) continue;  // 1/m: a fold is near, the differences would straddle it
    for (int i = 0; i < 20; ++i) {
      const Vector3d there = p + inputs.between(0, reach) * (inputs.rotation() * kX);
      const double bend = std::abs(bend_along(surface, there, kStep * (inputs.rotation() * kX)));
      ASSERT_LE(bend, bound * (1 + 1e-3) + 1e-4) << "seed " << seed;
      const double here = surface.curvature_bound(there, 0);
      if (here > 0) tightest = std::max(tightest, bend / here);
    }
  }
  EXPECT_NEAR(tightest, std::string(GetParam().name) == "plane" ? 0 : 1, 0.02);
}

// On the axis, in the centre, in the middle of the tube no direction is nearest: the answer is one of them, finite, and
// the curvature says so.
TEST_P(EverySurface, AnswersInItsFolds) {
  const PlacedSort sort = placed(1);
  const AnalyticSurface surface = sort.surface();
  const SurfaceKind kind = surface.kind();
  for (const Vector3d& own : {Vector3d(0, 0, -0.01), kO, Vector3d(0, 0, 0.01), Vector3d(kMajor, 0, 0)}) {
    const SurfaceAt found = surface.at(sort.at() * own);
    EXPECT_TRUE(std::isfinite(found.distance));
    EXPECT_NEAR(found.normal.norm(), 1, 1e-14);
    EXPECT_TRUE(surface.foot(sort.at() * own).allFinite());
  }
  const AnalyticSurface own = *AnalyticSurface::from(GetParam().make({}, false));
  const bool folds_on_axis = kind != SurfaceKind::plane && kind != SurfaceKind::sphere;
  EXPECT_EQ(own.curvature_bound({0, 0, 0.01}, 0) == kInfinity, folds_on_axis);
  EXPECT_EQ(own.curvature_bound(kO, 0) == kInfinity, kind != SurfaceKind::plane);
  EXPECT_EQ(own.curvature_bound({kMajor, 0, 0}, 0) == kInfinity, kind == SurfaceKind::torus);
}

TEST_P(EverySurface, IsTheSameInAGridButForTheUnit) {
  for (const std::uint64_t seed : test::seeds(100)) {
    const AnalyticSurface surface = placed(seed).surface();
    Inputs inputs(seed + 17000);
    const Vector3d origin = inputs.vector(1), p = inputs.vector(0.2);
    const double scale = inputs.between(0.5, 500);
    const AnalyticSurface grid = surface.in_grid(origin, scale);
    const SurfaceAt here = surface.at(p), there = grid.at(scale * (p - origin));
    ASSERT_NEAR(there.distance, scale * here.distance, 1e-12 * scale) << "seed " << seed;
    ASSERT_LE((there.normal - here.normal).norm(), 1e-9) << "seed " << seed;
  }
}

TEST(Turn, GrowsWithTheAngleFromZeroToFour) {
  double before = -1;
  for (int i = 0; i < 1000; ++i) {
    const double angle = kWholeTurn * i / 1000;
    const double turn = turn_of(3 * std::cos(angle), 3 * std::sin(angle));
    EXPECT_GT(turn, before);
    EXPECT_LT(turn, 4);
    before = turn;
  }
  EXPECT_EQ(turn_of(0, 2), 1);
  EXPECT_EQ(turn_of(-2, 0), 2);
  EXPECT_EQ(turn_of(0, -2), 3);
  EXPECT_EQ(turn_of(0, 0), 0);
}

// What is no surface is entity_check_test's; here: it is asked.
TEST(AnalyticSurface, IsNothingForWhatIsNoSurface) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(AnalyticSurface::from(OtherSurface{}));
  EXPECT_FALSE(AnalyticSurface::from(Cylinder{kO, kZ, kX, 0, false}));
  EXPECT_FALSE(AnalyticSurface::from(Sphere{kO, kZ, kX, -1, false}));
  EXPECT_FALSE(AnalyticSurface::from(Torus{kO, kZ, kX, 0.1, 0, false}));
  EXPECT_FALSE(AnalyticSurface::from(Cone{kO, kZ, kX, -0.01, 0.5, false}));
  EXPECT_FALSE(AnalyticSurface::from(Cone{kO, kZ, kX, 0.01, 0, false}));
  EXPECT_FALSE(AnalyticSurface::from(Plane{nan * kX, kZ, kX}));
  EXPECT_TRUE(AnalyticSurface::from(Cone{kO, kZ, kX, 0, 0.5, false})) << "a cone may begin at its tip";
}

// Worked by hand: a cone of 45 degrees with its tip at h = -1, a tube of 2 about a ring of 3.
TEST(Meridian, GivesTheWorkedNumbers) {
  const double half = std::sqrt(0.5);
  const Meridian cone{.kind = SurfaceKind::cone, .radius = 1, .cosine = half, .sine = half, .tangent = 1};
  EXPECT_NEAR(cone.distance(4, 1), 2 * half, 1e-15);
  EXPECT_EQ(cone.apex(), -1);
  EXPECT_NEAR(cone.curvature_bound(4, 1, 2), half / 2, 1e-15);
  const Meridian torus{.kind = SurfaceKind::torus, .radius = 2, .ring = 3};
  EXPECT_EQ(torus.distance(6, 4), 3);
  const MeridianAt at = torus.at(6, 4);
  EXPECT_EQ(at.out / at.length, 0.6);
  EXPECT_EQ(at.up / at.length, 0.8);
  EXPECT_EQ(torus.curvature_bound(6, 4, 1), 0.25);
  const Meridian spindle{.kind = SurfaceKind::torus, .radius = 5, .ring = 3};
  EXPECT_EQ(spindle.apex(), 4);
}

// As fits have them: a cone that narrows is one that widens the other way, a ring beyond the axis the inside of a tube.
TEST(Meridian, TakesTheSignsThatFitsHave) {
  test::Inputs inputs(3);
  for (int i = 0; i < 100; ++i) {
    const double rho = inputs.between(0, 2), h = inputs.between(-2, 2), a = inputs.between(0.1, 1.4);
    Meridian cone{.kind = SurfaceKind::cone, .radius = 1, .cosine = std::cos(a), .sine = std::sin(a)};
    cone.tangent = cone.sine / cone.cosine;
    Meridian narrowing = cone;
    narrowing.sine = -cone.sine, narrowing.tangent = -cone.tangent;
    EXPECT_EQ(narrowing.distance(rho, h), cone.distance(rho, -h));
    EXPECT_EQ(narrowing.at(rho, h).up, -cone.at(rho, -h).up);
    const Meridian inside{.kind = SurfaceKind::torus, .radius = 3, .ring = -1};
    EXPECT_NEAR(inside.distance(rho, h), std::hypot(rho + 1, h) - 3, 1e-15);
  }
}

}  // namespace
}  // namespace verisim::testing::analytic_surface_test

// Every kind of surface against its parametrization (engine/geometry/entity.hpp) and against brute force.
#include "engine/exact/precise_surface.hpp"

#include <gtest/gtest.h>

#include <ostream>

#include "engine/exact/meridian.hpp"
#include "tests/exact/scenes.hpp"

namespace verisim::exact::test::precise_surface_test {
namespace {

constexpr double kTwoPi = 2 * 3.14159265358979323846;

/// A surface in a random place, its parametrization, and the stretch of it that is compared.
struct Sort {
  const char* name;
  Surface (*make)(const Pose& at, bool hole);
  Vector3d (*point)(double u, double v);  ///< in the surface's own axes
  std::array<double, 2> u, v;             ///< range of either
  double depth;                           ///< m, points are tried up to this far from the surface

  friend void PrintTo(const Sort& sort, std::ostream* out) { *out << sort.name; }
};

Vector3d axis_of(const Pose& at, int i) {
  return at.rotation.toRotationMatrix().col(i);
}
Vector3d ring(double u) {
  return {std::cos(u), std::sin(u), 0};
}

constexpr double kRadius = 0.03, kAngle = 0.4, kMajor = 0.05, kMinor = 0.01;

const Sort kSorts[] = {
    {"plane",
     [](const Pose& at, bool) -> Surface {
       return Plane{at.position, axis_of(at, 2), axis_of(at, 0)};
     },
     [](double u, double v) { return Vector3d(u, v, 0); },
     {-0.05, 0.05},
     {-0.05, 0.05},
     0.02},
    {"cylinder",
     [](const Pose& at, bool hole) -> Surface {
       return Cylinder{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, hole};
     },
     [](double u, double v) { return Vector3d(kRadius * ring(u) + Vector3d(0, 0, v)); },
     {0, kTwoPi},
     {-0.05, 0.05},
     0.02},
    {"cone",
     [](const Pose& at, bool hole) -> Surface {
       return Cone{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, kAngle, hole};
     },
     [](double u, double v) { return Vector3d((kRadius + v * std::tan(kAngle)) * ring(u) + Vector3d(0, 0, v)); },
     {0, kTwoPi},
     {-0.02, 0.04},
     0.01},
    {"sphere",
     [](const Pose& at, bool hole) -> Surface {
       return Sphere{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, hole};
     },
     [](double u, double v) { return Vector3d(kRadius * (std::cos(v) * ring(u) + Vector3d(0, 0, std::sin(v)))); },
     {0, kTwoPi},
     {-1.5, 1.5},
     0.02},
    {"torus",
     [](const Pose& at, bool hole) -> Surface {
       return Torus{at.position, axis_of(at, 2), axis_of(at, 0), kMajor, kMinor, hole};
     },
     [](double u, double v) {
       return Vector3d((kMajor + kMinor * std::cos(v)) * ring(u) + Vector3d(0, 0, kMinor * std::sin(v)));
     },
     {0, kTwoPi},
     {0, kTwoPi},
     0.008}};

class EverySurface : public ::testing::TestWithParam<Sort> {
 protected:
  /// As its own entity has it, in a place of the seed.
  void place(std::uint64_t seed) {
    Draw draw(seed);
    at_ = {draw.in_box({0.1, 0.1, 0.1}), draw.rotation()};
    hole_ = seed % 2 == 1 && std::string(GetParam().name) != "plane";
    surface_ = *PreciseSurface::from(GetParam().make(at_, hole_));
  }
  [[nodiscard]] Vector3d on(double u, double v) const { return at_ * GetParam().point(u, v); }
  /// Away from the material or, in a hole, from its middle.
  [[nodiscard]] Vector3d away(double u, double v) const {
    constexpr double kStep = 1e-6;
    const Vector3d by_u = on(u + kStep, v) - on(u - kStep, v);
    const Vector3d by_v = on(u, v + kStep) - on(u, v - kStep);
    return by_u.cross(by_v).normalized() * (hole_ ? -1 : 1);
  }

  Pose at_;
  bool hole_ = false;
  PreciseSurface surface_ = *PreciseSurface::from(Plane{Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX()});
};
INSTANTIATE_TEST_SUITE_P(Sorts, EverySurface, ::testing::ValuesIn(kSorts),
                         [](const auto& instance) { return std::string(instance.param.name); });

// A point put a height above the surface along its normal is that height away, and the normal leads back.
TEST_P(EverySurface, TellsTheHeightAndTheNormalThatAPointWasGiven) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    place(seed);
    Draw draw(seed + 5000);
    const double u = draw.between(GetParam().u[0], GetParam().u[1]);
    const double v = draw.between(GetParam().v[0], GetParam().v[1]);
    const double height = draw.between(-GetParam().depth, GetParam().depth);
    const Vector3d normal = away(u, v);
    const SurfaceAt found = surface_.at(on(u, v) + height * normal);
    ASSERT_NEAR(found.distance, height, 1e-9) << "seed " << seed;
    ASSERT_LE((found.normal - normal).norm(), 2e-8) << "seed " << seed;
    ASSERT_NEAR(found.normal.norm(), 1, 1e-14);
  }
}

// No point of the surface is nearer than the distance, and of a fine grid of them one is as near, but for the grid.
TEST_P(EverySurface, IsAsFarAwayAsTheNearestOfManyOfItsPoints) {
  constexpr int kGrid = 300;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    place(seed);
    Draw draw(seed + 7000);
    const auto [u0, u1] = GetParam().u;
    const auto [v0, v1] = GetParam().v;
    const double u = draw.between(0.7 * u0 + 0.3 * u1, 0.3 * u0 + 0.7 * u1);
    const double v = draw.between(0.7 * v0 + 0.3 * v1, 0.3 * v0 + 0.7 * v1);
    const Vector3d p = on(u, v) + draw.between(-1, 1) * GetParam().depth * away(u, v);
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; j <= kGrid; ++j)
        nearest = std::min(nearest, (on(u0 + (u1 - u0) * i / kGrid, v0 + (v1 - v0) * j / kGrid) - p).norm());
    }
    const double distance = std::abs(surface_.at(p).distance);
    EXPECT_LE(distance, nearest + 1e-12) << "seed " << seed;
    EXPECT_NEAR(distance, nearest, 6e-4) << "seed " << seed;  // half a cell of the grid to the side
  }
}

// Where the surface's parameters say that a point is: lengths as they are, angles as the share of a turn.
TEST_P(EverySurface, ChartsAPointByItsParameters) {
  const auto turn = [](double angle) { return turn_of(std::cos(angle), std::sin(angle)); };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    place(seed);
    Draw draw(seed + 9000);
    const double u = draw.between(GetParam().u[0], GetParam().u[1]);
    const double v = draw.between(GetParam().v[0], GetParam().v[1]);
    std::array<double, 2> want{turn(u), v};
    if (surface_.kind() == PreciseSurface::Kind::plane) want = {u, v};
    if (surface_.kind() == PreciseSurface::Kind::sphere) want = {turn(u), std::sin(v)};
    if (surface_.kind() == PreciseSurface::Kind::torus) want = {turn(u), turn(v)};
    const std::array<double, 2> found = surface_.chart(on(u, v));
    ASSERT_NEAR(found[0], want[0], 1e-10) << "seed " << seed;
    ASSERT_NEAR(found[1], want[1], 1e-10) << "seed " << seed;
  }
}

/// Curves that pass at any angle: the search's short form of distance, slope, bend and change is that of the long form.
TEST_P(EverySurface, MeasuresACurveAsThePointsOnItTell) {
  constexpr double kStep = 1e-4;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    place(seed);
    Draw draw(seed + 11000);
    const bool is_arc = seed % 4 < 2;
    const Vector3d origin = at_ * Vector3d(draw.in_box({0.06, 0.06, 0.02}));
    const Vector3d x = is_arc ? draw.in_box({0.02, 0.02, 0.02}) : Vector3d(draw.rotation() * Vector3d::UnitX());
    const Vector3d y = is_arc ? draw.in_box({0.02, 0.02, 0.02}) : Vector3d(Vector3d::Zero());
    const double t = is_arc ? draw.between(-3, 3) : draw.between(-0.01, 0.01);
    const auto c = [&](double s) { return is_arc ? std::cos(s) : s; };
    const auto s = [&](double a) { return is_arc ? std::sin(a) : 0; };
    const auto distance = [&](double a) { return surface_.at(origin + c(a) * x + s(a) * y).distance; };
    const Vector3d shift = draw.in_box({0.1, 0.1, 0.1});
    const Vector3d turn = draw.in_box({1, 1, 1});
    Measure found{};
    with_measure(seen_from(surface_, origin, x, y, is_arc, shift, turn),
                 [&](auto&& measure_at) { found = measure_at(c(t), s(t)); });
    ASSERT_NEAR(found.distance, distance(t), 1e-14) << "seed " << seed;
    const double off_axis = (surface_.to_own_axes(origin + c(t) * x + s(t) * y - at_.position)).head<2>().norm();
    if (off_axis < 0.005 ||
        (surface_.kind() == PreciseSurface::Kind::torus && kMinor - std::abs(found.distance) < 0.003))
      continue;
    ASSERT_NEAR(found.slope, (distance(t + kStep) - distance(t - kStep)) / (2 * kStep), 1e-3 * (is_arc ? 0.02 : 1))
        << "seed " << seed;
    const double bend = (distance(t + kStep) - 2 * distance(t) + distance(t - kStep)) / (kStep * kStep);
    ASSERT_NEAR(found.bend, bend, 1e-3 * std::max(1.0, std::abs(bend))) << "seed " << seed;
    const Vector3d p = origin + c(t) * x + s(t) * y;
    ASSERT_NEAR(found.change, surface_.at(p).normal.dot(shift + turn.cross(p)), 1e-12) << "seed " << seed;
  }
}

// On the axis no direction is nearest; the answer is one of them and finite.
TEST_P(EverySurface, AnswersOnItsOwnAxis) {
  place(1);
  for (const double height : {-0.01, 0.0, 0.01}) {
    const SurfaceAt found = surface_.at(at_ * Vector3d(0, 0, height));
    EXPECT_TRUE(std::isfinite(found.distance));
    EXPECT_NEAR(found.normal.norm(), 1, 1e-14);
  }
}

TEST(Turn, GrowsWithTheAngleFromZeroToFour) {
  double before = -1;
  for (int i = 0; i < 1000; ++i) {
    const double angle = kTwoPi * i / 1000;
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

TEST(PreciseSurface, IsNothingWithoutExtent) {
  const Vector3d o = Vector3d::Zero();
  const Vector3d x = Vector3d::UnitX();
  const Vector3d z = Vector3d::UnitZ();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(PreciseSurface::from(OtherSurface{}));
  EXPECT_FALSE(PreciseSurface::from(Cylinder{o, z, x, 0, false}));
  EXPECT_FALSE(PreciseSurface::from(Sphere{o, z, x, 0, false}));
  EXPECT_FALSE(PreciseSurface::from(Torus{o, z, x, 0.1, 0, false}));
  EXPECT_FALSE(PreciseSurface::from(Cone{o, z, x, 0.01, 0, false}));
  EXPECT_FALSE(PreciseSurface::from(Plane{nan * x, z, x}));
  EXPECT_TRUE(PreciseSurface::from(Cone{o, z, x, 0, 0.5, false})) << "a cone may begin at its tip";
}

}  // namespace
}  // namespace verisim::exact::test::precise_surface_test

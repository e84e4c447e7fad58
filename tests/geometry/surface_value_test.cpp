// What a fit is told of a surface: that its derivatives are those of its distance, whatever the signs of its sizes.
#include "engine/geometry/recover/surface_value.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/surface_sorts.hpp"

namespace verisim::recover::surface_value_test {
namespace {

/// One of each kind, a cone that narrows and a tube beyond its axis.
SurfaceValue any_value(test::Inputs& inputs, int i) {
  const Vector3d point = inputs.vector(1), axis = inputs.rotation() * Vector3d::UnitZ();
  const double size = inputs.between(0.5, 1.5);
  switch (i % 7) {
    case 0:
      return {Kind::plane, point, axis};
    case 1:
      return {Kind::cylinder, point, axis, size};
    case 2:
      return {Kind::cone, point, axis, size, inputs.between(0.1, 2)};
    case 3:
      return {Kind::cone, point, axis, size, -inputs.between(0.1, 2)};
    case 4:
      return {Kind::sphere, point, axis, size};
    case 5:
      return {Kind::torus, point, axis, 2 * size, 0.5};
    default:
      return {Kind::torus, point, axis, -0.5, size};
  }
}

// Central differences over 1e-5: off by 1e-10 / 6 times a third derivative, below 1e-6 where no fold is within 0.1.
TEST(SurfaceValue, HasTheDerivativesThatAFitIsGiven) {
  constexpr double kStep = 1e-5;
  test::Inputs inputs(21);
  int compared = 0;
  for (int i = 0; i < 1400; ++i) {
    const SurfaceValue s = any_value(inputs, i);
    Vector3d p = s.point + inputs.vector(2);
    if (s.kind == Kind::cone) p -= s.distance(p) * s.gradient(p);  // a fit is told of points that are nearly on it
    const Vector3d x = s.axis.unitOrthogonal(), y = s.axis.cross(x);
    const Profile f = profile_of(p, s.point, s.axis);
    if (s.kind == Kind::cone && std::abs(s.distance(p)) > 1e-12) continue;  // beyond the apex
    if (!std::isfinite(s.meridian().curvature_bound(f.rho, f.height, 0.1))) continue;
    ++compared;
    SurfaceValue::Row row;
    ASSERT_EQ(s.row(p, x, y, row), s.distance(p)) << "case " << i;
    ASSERT_LE((row.head<3>() + s.gradient(p)).norm(), 1e-15) << "case " << i;
    for (int k = 0; k < 7; ++k) {
      const SurfaceValue::Row step = kStep * SurfaceValue::Row::Unit(k);
      const double slope = (s.moved(step, x, y).distance(p) - s.moved(-step, x, y).distance(p)) / (2 * kStep);
      ASSERT_NEAR(row[k], slope, 1e-6) << "case " << i << ", derivative " << k;
    }
  }
  EXPECT_GT(compared, 1000);
}

// There and back: what recovery makes of its fit is the surface that everybody else asks.
TEST(SurfaceValue, IsAsFarAwayAsTheSurfaceThatItBecomes) {
  test::Inputs inputs(22);
  for (int i = 0; i < 700; ++i) {
    const SurfaceValue s = any_value(inputs, i);
    if (s.kind == Kind::torus && s.a < 0) continue;  // a Surface has no sign for it; its face's v range has
    const AnalyticSurface made = *AnalyticSurface::from(s.surface());
    const SurfaceValue back = *SurfaceValue::of(s.surface());
    for (int k = 0; k < 5; ++k) {
      const Vector3d p = s.point + inputs.vector(2);
      EXPECT_NEAR(made.at(p).distance, s.distance(p), 1e-14) << "case " << i;
      EXPECT_NEAR(back.distance(p), s.distance(p), 1e-14) << "case " << i;
    }
  }
  EXPECT_FALSE(SurfaceValue::of(OtherSurface{}));
}

}  // namespace
}  // namespace verisim::recover::surface_value_test

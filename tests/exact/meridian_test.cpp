// The search's short form of a curve's distance from a surface, against the long form.
#include "engine/exact/meridian.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/surface_sorts.hpp"

namespace verisim::exact::test::meridian_test {
namespace {

class EverySurface : public ::testing::TestWithParam<testing::SurfaceSort> {};
INSTANTIATE_TEST_SUITE_P(Sorts, EverySurface, ::testing::ValuesIn(testing::kSurfaceSorts),
                         [](const auto& instance) { return std::string(instance.param.name); });

// Curves that pass at any angle: distance, slope, bend and change are those of the points on the curve.
TEST_P(EverySurface, MeasuresACurveAsThePointsOnItTell) {
  constexpr double kStep = 1e-4;
  int compared = 0;
  for (const std::uint64_t seed : verisim::test::seeds(400)) {
    const testing::PlacedSort sort(GetParam(), seed);
    const AnalyticSurface surface = sort.surface();
    verisim::test::Inputs inputs(seed + 11000);
    const bool is_arc = seed % 4 < 2;
    const Vector3d origin = sort.at() * Vector3d(inputs.vector(0.06));
    const Vector3d x = is_arc ? inputs.vector(0.02) : Vector3d(inputs.rotation() * Vector3d::UnitX());
    const Vector3d y = is_arc ? inputs.vector(0.02) : Vector3d(Vector3d::Zero());
    const double t = is_arc ? inputs.between(-3, 3) : inputs.between(-0.01, 0.01);
    const auto c = [&](double s) { return is_arc ? std::cos(s) : s; };
    const auto s = [&](double a) { return is_arc ? std::sin(a) : 0; };
    const auto distance = [&](double a) { return surface.at(origin + c(a) * x + s(a) * y).distance; };
    const Vector3d shift = inputs.vector(0.1);
    const Vector3d turn = inputs.vector(1);
    Measure found{};
    with_measure(seen_from(surface, origin, x, y, is_arc, shift, turn),
                 [&](auto&& measure_at) { found = measure_at(c(t), s(t)); });
    ASSERT_NEAR(found.distance, distance(t), 1e-14) << "seed " << seed;
    const Vector3d p = origin + c(t) * x + s(t) * y;
    if (surface.curvature_bound(p, 0) > 200) continue;  // 1/m: the differences would straddle a fold
    ++compared;
    ASSERT_NEAR(found.slope, (distance(t + kStep) - distance(t - kStep)) / (2 * kStep), 1e-3 * (is_arc ? 0.02 : 1))
        << "seed " << seed;
    const double bend = (distance(t + kStep) - 2 * distance(t) + distance(t - kStep)) / (kStep * kStep);
    ASSERT_NEAR(found.bend, bend, 1e-3 * std::max(1.0, std::abs(bend))) << "seed " << seed;
    ASSERT_NEAR(found.change, surface.at(p).normal.dot(shift + turn.cross(p)), 1e-12) << "seed " << seed;
  }
  EXPECT_GT(compared, 200);
}

}  // namespace
}  // namespace verisim::exact::test::meridian_test

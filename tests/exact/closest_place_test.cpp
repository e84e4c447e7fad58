// The place of a segment that is closest to a surface, against the surface's own distance at places beside it.
#include "engine/exact/closest_place.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/surface_sorts.hpp"

namespace verisim::exact::test::closest_place_test {
namespace {

class ClosestPlace : public ::testing::TestWithParam<testing::SurfaceSort> {};
INSTANTIATE_TEST_SUITE_P(Sorts, ClosestPlace, ::testing::ValuesIn(testing::kSurfaceSorts),
                         [](const auto& instance) { return std::string(instance.param.name); });

// Segments of lines and arcs that pass at any angle, at any distance from axes and apices: no place within a hundredth
// of the segment is closer. (Newton's method that had arrived at its fourth step was taken for one that had not: the
// place was moved by as much as a quarter of its segment, and a slot's edge sank by 30 um into a cone.)
TEST_P(ClosestPlace, HasNoCloserPlaceBesideTheClosest) {
  constexpr double kAccuracy = 3 * kClosestPlaceGain;
  for (const std::uint64_t seed : verisim::test::seeds(20000)) {
    const testing::PlacedSort sort(GetParam(), seed);
    const AnalyticSurface surface = sort.surface();
    verisim::test::Inputs inputs(seed + 12000);
    const bool is_arc = seed % 4 < 2;
    const Vector3d origin = sort.at() * Vector3d(inputs.vector(seed % 3 == 0 ? 0.06 : 0.005));
    const Vector3d x = is_arc ? inputs.vector(0.02) : Vector3d(inputs.rotation() * Vector3d::UnitX());
    const Vector3d y = is_arc ? inputs.vector(0.02) : Vector3d(Vector3d::Zero());
    const double middle = is_arc ? inputs.between(-3, 3) : inputs.between(-0.01, 0.01);
    const double half = is_arc ? inputs.between(0.02, 0.2) : inputs.between(0.0005, 0.004);
    const double c = is_arc ? std::cos(middle) : middle;
    const double s = is_arc ? std::sin(middle) : 0;
    const auto distance = [&](double t) {
      const Place at = place_at(is_arc, c, s, t);
      return surface.at(origin + at.c * x + at.s * y).distance;
    };
    const Place found = closest_place(seen_from(surface, origin, x, y, is_arc, {}, {}), c, s, half);
    ASSERT_LE(std::abs(found.t), half) << "seed " << seed;
    for (const double beside : {-1e-2, -1e-3, -1e-4, 1e-4, 1e-3, 1e-2}) {
      const double t = std::clamp(found.t + beside * half, -half, half);
      ASSERT_GE(distance(t), distance(found.t) - kAccuracy) << "seed " << seed << ", t " << found.t << " of " << half;
    }
  }
}

}  // namespace
}  // namespace verisim::exact::test::closest_place_test

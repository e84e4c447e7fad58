// The doors of engine/ruler: what shapes, trees, triangles and the search do not take.
#include <gtest/gtest.h>

#include <limits>

#include "engine/ruler/best_first.hpp"
#include "engine/ruler/lifted.hpp"
#include "engine/ruler/solid_depth.hpp"
#include "tests/ruler/shapes.hpp"
#include "tests/support/broken.hpp"

namespace verisim::ruler_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Pose kStretched{{0, 0, 0}, Quaterniond(2, 0, 0, 0)};
const Pose kNowhere{{0, kNaN, 0}, Quaterniond::Identity()};

struct AnyPiece {
  double limit = 0;
  std::uint32_t number = 0;
  bool operator<(const AnyPiece& other) const { return limit < other.limit; }
};

TEST(OverlapDeathTest, NeedsShapesWithAnInsideAndPlacements) {
  const ruler::Shape ball = ruler::test::shape("sphere(0.01)"), open(std::vector<ruler::PartData>{{"open", "", {}}});
  EXPECT_BROKEN(ruler::overlap(ball, Pose(), open, Pose()), "why_not(a, b).empty()");
  for (const Pose& X : {kStretched, kNowhere}) {
    EXPECT_BROKEN(ruler::overlap(ball, X, ball, Pose()), "is_placement(X_WA)");
    EXPECT_BROKEN(ruler::overlap(ball, Pose(), ball, X), "is_placement(X_WB)");
    EXPECT_BROKEN(ruler::largest_move(ball, X, Pose()), "is_placement(X_BA)");
    EXPECT_BROKEN(ruler::largest_move(ball, Pose(), X), "is_placement(Y_BA)");
  }
}

TEST(OverlapDeathTest, OfSurfacesNeedsSome) {
  const ruler::Shape ball = ruler::test::shape("sphere(0.01)");
  EXPECT_BROKEN(ruler::overlap_of_surfaces(ball, Pose(), ball, Pose()), "has_surfaces(a, b)");
}

TEST(OverlapDeathTest, IsSoughtToAnAccuracy) {
  const ruler::Csg ball("sphere(0.01)");
  for (const double bad : {-1e-9, kNaN, kInfinity}) {
    EXPECT_BROKEN(ruler::depth_in(ball, ball, {.absolute = bad}), "is_not_negative(accuracy.absolute)");
    EXPECT_BROKEN(ruler::BestFirst<AnyPiece>({.relative = bad}), "is_not_negative(accuracy.relative)");
  }
}

TEST(CsgDeathTest, NeedsAValueOrASideForEachDivider) {
  const ruler::Csg box("box(1,1,1)");
  const std::vector<double> values(5);
  const std::vector<std::int8_t> sides(7);
  EXPECT_BROKEN((void)box.value(values), "values.size() == dividers_.size()");
  EXPECT_BROKEN((void)box.side(sides), "sides.size() == dividers_.size()");
}

TEST(TrianglesDeathTest, HaveCornersThatThereAre) {
  EXPECT_BROKEN(ruler::Triangles({{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}), "index < vertices_.size()");
  EXPECT_BROKEN((void)ruler::Triangles({}, {}).nearest({0, 0, 0}), "!triangles_.empty()");
}

TEST(LiftedDeathTest, NeedsATolerancePerSideAndAFacePerTriangle) {
  const ruler::FacedTriangles good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {ruler::kNoFace}, {}};
  EXPECT_EQ(ruler::lifted(good, 1e-6).triangles.triangles.size(), 1u);
  for (const double bad : {0.0, -1.0, kNaN, kInfinity})
    EXPECT_BROKEN(ruler::lifted(good, bad), "is_positive(tolerance)");
  ruler::FacedTriangles broken = good;
  broken.face_of_triangle.clear();
  EXPECT_BROKEN(ruler::lifted(broken, 1e-6), "part.face_of_triangle.size() == part.triangles.size()");
  broken = good;
  broken.face_of_triangle = {0};
  EXPECT_BROKEN(ruler::lifted(broken, 1e-6), "face == kNoFace || face < part.faces.size()");
  broken = good;
  broken.triangles = {{0, 1, 3}};
  EXPECT_BROKEN(ruler::lifted(broken, 1e-6), "index < part.vertices.size()");
}

}  // namespace
}  // namespace verisim::ruler_contracts_test

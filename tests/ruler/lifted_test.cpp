// Triangles lifted onto their surfaces: they are then on them, closed as before, and their overlap is that of the
// solids from which they were made.
#include "engine/ruler/lifted.hpp"

#include <gtest/gtest.h>

#include <map>

#include "engine/geometry/loader.hpp"
#include "tests/length.hpp"
#include "tests/ruler/drop_scenes.hpp"
#include "tests/ruler/shapes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::lifted_test {
namespace {

constexpr double kTolerance = 1e-6;  // m

ruler::Divider cylinder(double radius) {
  ruler::Divider d;
  d.kind = ruler::Divider::Kind::cylinder;
  d.radius = radius;
  return d;
}
ruler::Divider plane(double z) {
  ruler::Divider d;
  d.point.z() = z;
  return d;
}

/// A prism of n sides in a cylinder about z, between z = 0 and 1; bases are fans.
ruler::FacedTriangles coarse_cylinder(std::uint32_t n, double radius) {
  ruler::FacedTriangles part;
  part.faces = {cylinder(radius), plane(0), plane(1)};
  part.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < n; ++i)
    for (const double z : {0.0, 1.0}) {
      const double angle = pinned::kFullTurn * i / n;
      part.vertices.emplace_back(radius * pinned::cos(angle), radius * pinned::sin(angle), z);
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t face) {
    part.triangles.push_back({a, b, c});
    part.face_of_triangle.push_back(face);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % n);
    add(a, b, b + 1, 0);
    add(a, b + 1, a + 1, 0);
    add(0, b, a, 1);
    add(1, a + 1, b + 1, 2);
  }
  return part;
}

TEST(Lifted, TrianglesLieOnTheirSurfaces) {
  const ruler::Lifted lifted = ruler::lifted(coarse_cylinder(8, 0.5), kTolerance);
  EXPECT_EQ(lifted.known, 32u);
  EXPECT_LE(lifted.moved, test::tolerance(1e-15)) << "the corners were on their surfaces before";
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  double farthest = 0;
  for (std::size_t i = 0; i < lifted.triangles.triangles.size(); ++i) {
    const auto& t = lifted.triangles.triangles[i];
    Vector3d middle = Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      middle += lifted.triangles.vertices[t[k]] / 3;
      ++sides[{t[k], t[(k + 1) % 3]}];
    }
    const ruler::Divider& surface = *lifted.triangles.faces[lifted.triangles.face_of_triangle[i]];
    farthest = std::max(farthest, std::abs(ruler::value_at(surface, middle)));
  }
  EXPECT_LE(farthest, lifted.off);
  EXPECT_GT(farthest, 0.1 * lifted.off) << "far finer than was asked for";
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(sides.count({side.second, side.first}), 1u) << "a gap";
  }
}

// What has no known surface stays as it is.
TEST(Lifted, TrianglesOfUnknownSurfacesStay) {
  ruler::FacedTriangles part = coarse_cylinder(8, 0.5);
  part.faces = {std::nullopt, std::nullopt, std::nullopt};
  EXPECT_EQ(ruler::lifted(part, kTolerance).triangles.triangles.size(), 32u);
  EXPECT_EQ(ruler::lifted(part, kTolerance).known, 0u);
}

// A ball and a ring over a plate, as parts of triangles with faces: their surfaces reach as deep as the solids do,
// their triangles less by a chord's height.
TEST(Lifted, OverlapIsThatOfTheSurfaces) {
  const double d = 2e-5;
  const std::vector<std::pair<drops::SolidPtr, double>> bodies = {
      {drops::ball(0.003), 0.003}, {drops::torus(0.003, 0.001), 0.001}, {drops::cone(0.0006, 0.003, 0.006), 0.003}};
  const auto shape_of = [](const drops::SolidPtr& solid) {
    return ruler::Shape(std::vector<ruler::PartData>{{"part", "", to_tables(load_solid(*solid, {}))}});
  };
  ruler::Shape plate = shape_of(drops::moved(drops::box(0.1, 0.1, 0.02), {0, 0, -0.01}));
  plate.lift();
  for (const auto& [solid, height] : test::some_of(bodies)) {
    SCOPED_TRACE(solid->text());
    ruler::Shape body = shape_of(solid);
    ASSERT_TRUE(ruler::has_surfaces(body, plate));
    body.lift();
    const Pose X = ruler::test::at(0, 0, height - d, {0.03, 0, 0});
    const double truth = ruler::overlap(ruler::test::shape(solid->text()), X,
                                        ruler::test::shape("placed(0,0,-0.01;0,0,0,1;box(0.1,0.1,0.02))"), Pose())
                             .depth;
    const ruler::Overlap found = ruler::overlap_of_surfaces(body, X, plate, Pose());
    EXPECT_EQ(found.source, ruler::Source::surfaces);
    EXPECT_LE(found.depth, truth + 1e-7);
    EXPECT_GE(found.depth + found.bound, truth - 1e-7);
    EXPECT_LE(found.bound, 1e-4) << "of the first order in the pieces' sizes: not as good as that of solids";
    EXPECT_EQ(ruler::overlap(body, X, plate, Pose()).source, ruler::Source::triangles);
  }
}

}  // namespace
}  // namespace verisim::lifted_test

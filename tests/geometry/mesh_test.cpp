#include "engine/geometry/mesh.hpp"

#include <limits>

#include "engine/base/random.hpp"
#include "tests/geometry/models.hpp"
#include "tests/support/meshes.hpp"

namespace verisim::mesh_test {
namespace {

using testing::append;
using testing::box_mesh;
using testing::turned_inside_out;

TriangleMesh unit_box() {
  return box_mesh({0, 0, 0}, {1, 1, 1});
}

MeshReport repaired(TriangleMesh& mesh, std::vector<std::string>& notes) {
  return repair(mesh, notes);
}
MeshReport repaired(TriangleMesh& mesh) {
  std::vector<std::string> notes;
  return repair(mesh, notes);
}

/// An STL's way: three corners of its own for every triangle.
TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh loose;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t corner : triangle) loose.vertices.push_back(mesh.vertices[corner]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  return loose;
}

// A box a x b x c: V = abc, I_xx = V (b^2 + c^2) / 12. Binary fractions: each of about 100 operations rounds by 2^-53.
TEST(MassProperties, OfABoxAreTheClosedForm) {
  const Vector3d a(3, -2, 5);
  const Vector3d size(0.5, 2, 1);
  const MassProperties mass = mass_properties_of(box_mesh(a, a + size));
  EXPECT_NEAR(mass.volume, 1, 1e-14);
  EXPECT_LE((mass.centroid - (a + size / 2)).norm(), 1e-14);
  const Matrix3d expected = Vector3d(5.0 / 12, 1.25 / 12, 4.25 / 12).asDiagonal();
  EXPECT_LE((mass.inertia - expected).norm(), 1e-14);
}

// Steiner's theorem is not needed: inertia is about the centroid, wherever the part is.
TEST(MassProperties, DoNotDependOnThePlace) {
  const MassProperties near = mass_properties_of(box_mesh({0, 0, 0}, {1, 2, 3}));
  const MassProperties far = mass_properties_of(box_mesh({1000, 1000, 1000}, {1001, 1002, 1003}));
  EXPECT_NEAR(near.volume, far.volume, 1e-9);
  EXPECT_LE((near.inertia - far.inertia).norm(), 1e-9);
}

TEST(MassProperties, OfAShellTurnedInsideOutAreNegative) {
  EXPECT_NEAR(mass_properties_of(turned_inside_out(unit_box())).volume, -1, 1e-14);
}

TEST(Subdivide, KeepsShapeAndTopology) {
  TriangleMesh coarse = box_mesh({0, 0, 0}, {1, 2, 3});
  coarse.face_of_triangle = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
  const TriangleMesh fine = test::subdivide(coarse);
  EXPECT_EQ(fine.triangles.size(), 4 * coarse.triangles.size());
  EXPECT_EQ(fine.vertices.size(), 8U + 18U);  // Euler: a closed surface with 12 triangles has 18 edges
  EXPECT_EQ(fine.face_of_triangle.size(), fine.triangles.size());
  EXPECT_EQ(fine.face_of_triangle[47], 5U);
  EXPECT_TRUE(examine(fine, true).watertight());
  EXPECT_NEAR(mass_properties_of(fine).volume, 6, 1e-13);
  EXPECT_NEAR(area_of(fine), 22, 1e-13);
}

TEST(Examine, FindsNothingWrongWithABox) {
  const MeshReport report = examine(unit_box(), true);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_EQ(report.degenerate_triangles + report.duplicate_triangles, 0U);
}

TEST(Examine, CountsOpenEdgesAndSaysWhere) {
  TriangleMesh mesh = unit_box();
  mesh.triangles.resize(10);  // without the two triangles at x = 1
  const MeshReport report = examine(mesh, false);
  EXPECT_EQ(report.open_edges, 4U);
  EXPECT_EQ(report.where.x(), 1);
  EXPECT_FALSE(report.watertight());
}

TEST(Examine, CountsEdgesWithMoreThanTwoTriangles) {
  TriangleMesh mesh = unit_box();
  mesh.vertices.emplace_back(2, 2, 2);
  mesh.triangles.push_back({0, 1, 8});  // a fin on the edge from (0,0,0) to (1,0,0)
  const MeshReport report = examine(mesh, false);
  EXPECT_EQ(report.nonmanifold_edges, 1U);
  EXPECT_EQ(report.open_edges, 2U);
}

TEST(Examine, SeesNaNAndInfinity) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = unit_box();
    mesh.vertices[3].y() = bad;
    EXPECT_TRUE(examine(mesh, true).not_finite);
    EXPECT_FALSE(examine(mesh, true).watertight());
    EXPECT_TRUE(repaired(mesh).not_finite);
  }
}

// Two boxes that overlap: each of the three edges of one that pass through a face of the other crosses a triangle
// there.
TEST(SelfIntersections, AreFoundWhereTwoBoxesOverlap) {
  TriangleMesh mesh = unit_box();
  append(mesh, box_mesh({0.6, 0.7, 0.8}, {1.6, 1.7, 1.8}));
  const MeshReport report = examine(mesh, true);
  EXPECT_GT(report.self_intersections, 0U);
  EXPECT_LE((report.where - Vector3d(0.8, 0.8, 0.9)).norm(), 1.0);
}

// Pushed into each other along one axis, the boxes share four planes: nothing but touching pairs and pairs in a plane.
TEST(SelfIntersections, AreFoundWhereAlignedBoxesOverlap) {
  TriangleMesh mesh = unit_box();
  append(mesh, box_mesh({0.5, 0, 0}, {1.5, 1, 1}));
  EXPECT_GT(examine(mesh, true).self_intersections, 0U);
}

// A flat sliver at z = 0 sticks through the foot of a wall in x = 0. The diagonal is 1.7 m, a 2000th of it 0.9 mm.
TEST(SelfIntersections, CountOnlyBeyondATessellationsOwnError) {
  for (const double reach : {0.0005, 0.01}) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 1, 0}, {0, 0.5, 1}, {-1, 0.5, 0}, {reach, 0.5, 0}, {-1, 0.4, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(examine(mesh, true).self_intersections, reach > 0.001 ? 1U : 0U) << reach;
  }
}

TEST(SelfIntersections, AreNoneInNestedShells) {
  TriangleMesh mesh = unit_box();
  append(mesh, turned_inside_out(box_mesh({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75})));
  EXPECT_EQ(examine(mesh, true).self_intersections, 0U);
}

// A corner pulled through the opposite wall of the box: the triangles at it cross those of the wall.
TEST(SelfIntersections, AreFoundWithinOneShell) {
  TriangleMesh mesh = test::subdivide(unit_box());
  mesh.vertices[0] = {0.4, 0.45, 1.5};
  EXPECT_GT(examine(mesh, true).self_intersections, 0U);
}

// A sliver turned over within a flat face overlaps its neighbours there: no volume changes by it.
TEST(SelfIntersections, AreNotCountedWithinOnePlane) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0}, {0.6, 0.1, 0}, {0.1, 0.6, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {3, 4, 5}};
  EXPECT_EQ(examine(mesh, true).self_intersections, 0U);
  mesh.vertices[5].z() = -0.1;  // now the last one leaves the plane and touches both others in it
  EXPECT_GT(examine(mesh, true).self_intersections, 0U);
}

TEST(Repair, LeavesASoundMeshAsItIs) {
  TriangleMesh mesh = unit_box();
  std::vector<std::string> notes;
  EXPECT_TRUE(repaired(mesh, notes).watertight());
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(mesh.triangles.size(), 12U);
}

TEST(Repair, WeldsEqualCornersAndZerosOfBothSigns) {
  TriangleMesh mesh = unwelded(unit_box());
  mesh.vertices[0] = {-0.0, 0.0, -0.0};
  EXPECT_TRUE(repaired(mesh).watertight());
  EXPECT_EQ(mesh.vertices.size(), 8U);
}

TEST(Repair, DropsDegenerateAndDuplicateTrianglesAndSaysSo) {
  TriangleMesh mesh = unit_box();
  mesh.face_of_triangle.assign(12, 7);
  mesh.vertices.emplace_back(0.5, 0, 0);  // on an edge
  for (const auto& extra : {std::array<std::uint32_t, 3>{0, 0, 1}, {0, 1, 8}, {2, 1, 0}}) {
    mesh.triangles.push_back(extra);
    mesh.face_of_triangle.push_back(9);
  }
  std::vector<std::string> notes;
  EXPECT_TRUE(repaired(mesh, notes).watertight());
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.face_of_triangle, std::vector<std::uint32_t>(12, 7));
  EXPECT_EQ(notes, (std::vector<std::string>{"1 triangle with two equal corners dropped",
                                             "1 duplicate triangle dropped", "1 triangle of zero area dropped"}));
}

// The flat triangle (0, 8, 1) fills the slit between a triangle with the long edge 0-1 and two with its halves: the
// mesh is closed with it and open without.
TEST(Repair, KeepsAFlatTriangleThatJoinsItsNeighbours) {
  TriangleMesh mesh = unit_box();
  mesh.vertices.emplace_back(0.5, 0, 0);
  mesh.triangles[0] = {0, 2, 8};
  mesh.triangles.push_back({8, 2, 1});
  mesh.triangles.push_back({0, 8, 1});
  const MeshReport report = repaired(mesh);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.degenerate_triangles, 1U);
  EXPECT_NEAR(mass_properties_of(mesh).volume, 1, 1e-14);
}

TEST(Repair, TurnsAMeshThatIsInsideOut) {
  TriangleMesh mesh = turned_inside_out(unit_box());
  EXPECT_TRUE(examine(mesh, false).inside_out);
  std::vector<std::string> notes;
  EXPECT_TRUE(repaired(mesh, notes).watertight());
  EXPECT_NEAR(mass_properties_of(mesh).volume, 1, 1e-14);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "1 shell turned inside out, so that the material is inside");
}

// Every subset of a box's triangles turned, drawn with a fixed stream: the box always comes out right.
TEST(Repair, OrientsTrianglesTurnedAtRandom) {
  const RandomStream random(1, "orient");
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    TriangleMesh mesh = unit_box();
    const std::uint64_t bits = random.bits(trial);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (((bits >> t) & 1U) != 0) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    }
    ASSERT_TRUE(repaired(mesh).watertight()) << trial;
    ASSERT_NEAR(mass_properties_of(mesh).volume, 1, 1e-14) << trial;
  }
}

// A shell in a shell bounds a void, one in that void material again: V = 1 - 0.5^3 + 0.25^3, whatever way they came.
TEST(Repair, OrientsNestedShellsAlternately) {
  for (unsigned turned = 0; turned < 8; ++turned) {
    TriangleMesh mesh;
    for (unsigned shell = 0; shell < 3; ++shell) {
      const Vector3d half = Vector3d::Constant(std::ldexp(0.5, -static_cast<int>(shell)));
      const TriangleMesh box = box_mesh(-half, half);
      append(mesh, ((turned >> shell) & 1U) != 0 ? turned_inside_out(box) : box);
    }
    const MeshReport report = repaired(mesh);
    EXPECT_TRUE(report.watertight());
    EXPECT_EQ(report.components, 3U);
    EXPECT_NEAR(mass_properties_of(mesh).volume, 1 - 0.125 + 0.015625, 1e-14) << turned;
  }
}

// Two solids that merely overlap both keep their material inside.
TEST(Repair, DoesNotTakeAnOverlapForAVoid) {
  TriangleMesh mesh = unit_box();
  append(mesh, box_mesh({0.2, 0.2, 0.2}, {0.8, 0.8, 1.5}));
  static_cast<void>(repaired(mesh));
  EXPECT_NEAR(mass_properties_of(mesh).volume, 1 + 0.36 * 1.3, 1e-14);
}

// A Moebius strip of five triangles has one side: no orientation agrees everywhere.
TEST(Repair, ReportsASurfaceThatHasOneSide) {
  TriangleMesh mesh;
  for (int i = 0; i < 5; ++i) mesh.vertices.emplace_back(std::cos(1.2566 * i), std::sin(1.2566 * i), 0.1 * i);
  for (std::uint32_t i = 0; i < 5; ++i) mesh.triangles.push_back({i, (i + 1) % 5, (i + 2) % 5});
  const MeshReport report = repaired(mesh);
  EXPECT_GT(report.misoriented_edges, 0U);
}

TEST(Repair, CopesWithAMeshOfNothing) {
  TriangleMesh mesh;
  EXPECT_EQ(repaired(mesh).components, 0U);
  mesh.vertices = {{0, 0, 0}};
  mesh.triangles = {{0, 0, 0}};
  static_cast<void>(repaired(mesh));
  EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace verisim::mesh_test

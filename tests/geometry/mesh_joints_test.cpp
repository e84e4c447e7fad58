// Seams that repair() closes, and those it must not.
#include "engine/geometry/mesh_joints.hpp"

#include <algorithm>

#include "engine/base/random.hpp"
#include "tests/geometry/models.hpp"

namespace verisim::mesh_joints_test {
namespace {

using testing::append;
using testing::box_mesh;

TriangleMesh unit_box() {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) mesh.face_of_triangle.push_back(t);
  return mesh;
}

/// The triangle cut at the given place on its first side, its neighbour across that side not.
void cut_one(TriangleMesh& mesh, std::size_t triangle, double share) {
  const auto [a, b, c] = mesh.triangles[triangle];
  const auto corner = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back((1 - share) * mesh.vertices[a] + share * mesh.vertices[b]);
  mesh.triangles[triangle] = {a, corner, c};
  mesh.triangles.push_back({corner, b, c});
  mesh.face_of_triangle.push_back(mesh.face_of_triangle[triangle]);
}

void expect_whole_box(const TriangleMesh& mesh, double accuracy = 1e-14) {
  const MeshReport report = examine(mesh, true);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.self_intersections + report.degenerate_triangles + report.duplicate_triangles, 0U);
  EXPECT_NEAR(mass_properties_of(mesh).volume, 1, accuracy);
  EXPECT_NEAR(area_of(mesh), 6, accuracy);
}

TEST(Joint, IsClosedByCuttingTheTriangleWithTheWholeSide) {
  TriangleMesh mesh = unit_box();
  cut_one(mesh, 0, 0.5);
  EXPECT_EQ(examine(mesh, false).open_edges, 3U);
  std::vector<std::string> notes;
  EXPECT_TRUE(repair(mesh, notes).watertight());
  expect_whole_box(mesh);
  EXPECT_EQ(mesh.triangles.size(), 14U);
  EXPECT_EQ(notes, std::vector<std::string>{"3 open edges closed within 1.7e-06 m (1e-6 of the diagonal), 0 left: "
                                            "0 corners joined, 1 triangle cut at T-joints"});
}

// Up to five cuts of triangles drawn at random, cut pieces again among them: sides with several corners on them and
// triangles with joints on two sides. Every piece stays in the plane of the face it is said to belong to.
TEST(Joint, IsClosedWhereverItIs) {
  const RandomStream random(1, "joints");
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    TriangleMesh mesh = unit_box();
    const TriangleMesh box = mesh;
    for (std::uint64_t cut = 0; cut < 1 + trial % 5; ++cut) {
      const std::uint64_t bits = random.bits(10 * trial + cut);
      auto& triangle = mesh.triangles[bits % mesh.triangles.size()];
      std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(bits / 4096 % 3), triangle.end());
      cut_one(mesh, bits % mesh.triangles.size(), 0.125 * static_cast<double>(1 + bits / 65536 % 7));
    }
    std::vector<std::string> notes;
    ASSERT_TRUE(repair(mesh, notes).watertight()) << trial;
    expect_whole_box(mesh, 1e-13);
    ASSERT_EQ(mesh.face_of_triangle.size(), mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& of = box.triangles[mesh.face_of_triangle[t]];
      const Vector3d& a = box.vertices[of[0]];
      const Vector3d normal = (box.vertices[of[1]] - a).cross(box.vertices[of[2]] - a);
      for (const std::uint32_t corner : mesh.triangles[t]) {
        ASSERT_NEAR(normal.dot(mesh.vertices[corner] - a), 0, 1e-15) << trial;
      }
    }
  }
}

TEST(Joint, IsFoundToTheStatedToleranceOnly) {
  for (const double off : {1e-6, 3e-6}) {  // the tolerance is 1e-6 sqrt(3) m
    TriangleMesh mesh = unit_box();
    cut_one(mesh, 0, 0.5);
    mesh.vertices.back() += off * Vector3d(0.6, 0, -0.8);
    std::vector<std::string> notes;
    EXPECT_EQ(repair(mesh, notes).watertight(), off < 2e-6) << off;
    EXPECT_EQ(notes.empty(), off > 2e-6) << off;
  }
}

// Each triangle has corners of its own, all of them off by less than the tolerance: nothing is equal, all is near.
TEST(Corners, ThatDifferByRoundingBecomeOne) {
  const TriangleMesh box = unit_box();
  TriangleMesh mesh;
  const RandomStream random(2, "corners");
  for (const auto& triangle : box.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const std::uint32_t corner : triangle) {
      const double off = 7e-10 * static_cast<double>(random.bits(mesh.vertices.size()) % 1024);
      mesh.vertices.emplace_back(box.vertices[corner] + off * Vector3d::Ones());
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  std::vector<std::string> notes;
  EXPECT_TRUE(repair(mesh, notes).watertight());
  expect_whole_box(mesh, 1e-5);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("36 open edges closed"), std::string::npos) << notes[0];
}

// A triangle of no area to the tolerance, but not to double precision, between a whole side and its halves: cut in two
// it would leave slivers, so it goes and the whole side's triangle is cut instead.
TEST(Joint, BesideASliverTakesTheSliverAway) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 1e-7, 0}, {0.25, 0, 0}, {0.5, -1, 0}};
  mesh.triangles = {{0, 3, 2}, {3, 1, 2}, {0, 1, 3}, {0, 5, 4}, {4, 5, 1}};
  std::vector<std::string> notes;
  const MeshReport report = repair(mesh, notes);
  EXPECT_EQ(report.open_edges, 4U);  // the outline
  EXPECT_EQ(report.nonmanifold_edges, 0U);
  EXPECT_EQ(mesh.triangles.size(), 6U);
  EXPECT_NEAR(area_of(mesh), 1, 1e-6);
}

TEST(Gap, WiderThanTheToleranceStaysOpenAndUntouched) {
  TriangleMesh mesh = unit_box();
  mesh.triangles.resize(10);
  mesh.face_of_triangle.resize(10);
  std::vector<std::string> notes;
  EXPECT_EQ(repair(mesh, notes).open_edges, 4U);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(mesh.triangles.size(), 10U);

  TriangleMesh slit = unit_box();  // one triangle's corner pulled off its neighbours' by ten tolerances
  slit.vertices.emplace_back(slit.vertices[slit.triangles[0][0]] - 1.7e-5 * Vector3d::Ones());
  slit.triangles[0][0] = 8;
  EXPECT_GT(repair(slit, notes).open_edges, 0U);
}

// A closed mesh has no open side: its finest details stay, though they are below the tolerance.
TEST(ClosedMesh, KeepsDetailsBelowTheTolerance) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  append(mesh, box_mesh({2, 0, 0}, {2 + 1e-8, 1e-8, 1e-8}));
  std::vector<std::string> notes;
  EXPECT_TRUE(repair(mesh, notes).watertight());
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(mesh.vertices.size(), 16U);
  EXPECT_EQ(mesh.triangles.size(), 24U);
}

}  // namespace
}  // namespace verisim::mesh_joints_test

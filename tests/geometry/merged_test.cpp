// Several solids that move as one: what holds of each still holds, and mass properties are those of the whole.
#include "engine/geometry/merged.hpp"

#include <gtest/gtest.h>

#include "engine/base/pose.hpp"
#include "tests/geometry/models.hpp"

namespace verisim::merged_test {
namespace {

/// A box with its six planes as faces, two triangles each, and one edge between the first two.
Part box_part(const Vector3d& low, const Vector3d& high) {
  Part part;
  part.name = "box";
  part.mesh = testing::box_mesh(low, high);
  part.mass = mass_properties_of(part.mesh);
  part.area = area_of(part.mesh);
  part.watertight = part.exact = true;
  for (std::uint32_t face = 0; face < 6; ++face) {
    part.mesh.face_of_triangle.insert(part.mesh.face_of_triangle.end(), 2, face);
    Face f;
    f.surface = Plane{low, Vector3d::UnitZ(), Vector3d::UnitX()};
    if (face < 2) f.edges = {0};
    part.faces.push_back(f);
  }
  Edge edge;
  edge.faces = {0, 1};
  part.edges.push_back(edge);
  return part;
}

TEST(Merged, OfOnePartIsThatPart) {
  const Part box = box_part({0, 0, 0}, {1, 2, 3});
  const Part all = merged({box});
  EXPECT_EQ(all.name, box.name);
  EXPECT_EQ(all.mesh.vertices, box.mesh.vertices);
  EXPECT_EQ(all.mesh.triangles, box.mesh.triangles);
  EXPECT_EQ(all.mesh.face_of_triangle, box.mesh.face_of_triangle);
  EXPECT_EQ(all.mass.volume, box.mass.volume);
  EXPECT_EQ(all.mass.centroid, box.mass.centroid);
  EXPECT_EQ(all.area, box.area);
  EXPECT_TRUE(all.watertight);
  EXPECT_TRUE(all.exact);
}

// A box of 2 x 2 x 2 in two halves: volume 8, centroid in its middle, inertia 8 (2^2 + 2^2) / 12 about each axis.
TEST(Merged, TwoHalvesWeighAsTheWhole) {
  const Part all = merged({box_part({-1, -1, -1}, {0, 1, 1}), box_part({0, -1, -1}, {1, 1, 1})});
  EXPECT_NEAR(all.mass.volume, 8, 1e-14);
  EXPECT_LE(all.mass.centroid.norm(), 1e-15);
  EXPECT_LE((all.mass.inertia - 8.0 * 8 / 12 * Matrix3d::Identity()).norm(), 1e-14);
}

// The parallel axis theorem in another way: the mesh of both, integrated at once.
TEST(Merged, WeighsAsItsMeshDoes) {
  const Part all = merged({box_part({0, 0, 0}, {1, 2, 3}), box_part({4, -1, 2}, {4.5, 1, 7})});
  const MassProperties of_mesh = mass_properties_of(all.mesh);
  EXPECT_NEAR(all.mass.volume, of_mesh.volume, 1e-13 * of_mesh.volume);
  EXPECT_LE((all.mass.centroid - of_mesh.centroid).norm(), 1e-13);
  EXPECT_LE((all.mass.inertia - of_mesh.inertia).norm(), 1e-13 * of_mesh.inertia.norm());
}

TEST(Merged, LetsTrianglesFacesAndEdgesPointAtTheirOwn) {
  const Part box = box_part({0, 0, 0}, {1, 1, 1});
  const Part all = merged({box, box});  // the same part twice
  ASSERT_EQ(all.faces.size(), 12U);
  ASSERT_EQ(all.edges.size(), 2U);
  const std::size_t half = all.mesh.triangles.size() / 2;
  for (std::size_t i = 0; i < half; ++i) {
    EXPECT_EQ(all.mesh.face_of_triangle[half + i], all.mesh.face_of_triangle[i] + 6);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(all.mesh.triangles[half + i][k], all.mesh.triangles[i][k] + 8);
    }
  }
  EXPECT_EQ(all.edges[1].faces, (std::vector<std::uint32_t>{6, 7}));
  EXPECT_EQ(all.faces[6].edges, std::vector<std::uint32_t>{1});
  EXPECT_TRUE(all.faces[8].edges.empty());
}

TEST(Merged, WithAPartWithoutFacesKeepsTheOthersAndSaysWhichTrianglesHaveNone) {
  Part bare = box_part({2, 0, 0}, {3, 1, 1});
  bare.faces.clear();
  bare.edges.clear();
  bare.mesh.face_of_triangle.clear();
  bare.exact = bare.watertight = false;
  const Part all = merged({bare, box_part({0, 0, 0}, {1, 1, 1})});
  EXPECT_EQ(all.mesh.face_of_triangle.front(), kNoFace);
  EXPECT_EQ(all.mesh.face_of_triangle.back(), 5U);
  EXPECT_EQ(all.faces.size(), 6U);
  EXPECT_FALSE(all.exact);
  EXPECT_FALSE(all.watertight);
}

TEST(Merged, OfMeshesAloneHasNoFaces) {
  Part bare = box_part({0, 0, 0}, {1, 1, 1});
  bare.faces.clear();
  bare.edges.clear();
  bare.mesh.face_of_triangle.clear();
  EXPECT_TRUE(merged({bare, bare}).mesh.face_of_triangle.empty());
}

}  // namespace
}  // namespace verisim::merged_test

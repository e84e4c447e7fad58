#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::refusal_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The text with which voxelizing is refused; fails if it is not.
std::string refusal(const TriangleMesh& mesh, const VoxelizeOptions& options) {
  try {
    (void)voxelize("hole", mesh, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  ADD_FAILURE() << "was accepted";
  return {};
}

const TriangleMesh kHole = shapes::box({0, 0, 0}, {0.15, 0.1, 0.1});

TEST(VoxelizeRefuses, AVoxelSizeOfZero) {
  EXPECT_EQ(refusal(kHole, {.voxel_size = 0}),
            "hole: voxelsize is 0 m but must be above 0; 'hole' measures 0.15 m, mm(3) is usual");
}

TEST(VoxelizeRefuses, ANegativeVoxelSize) {
  EXPECT_EQ(refusal(kHole, {.voxel_size = -0.003}),
            "hole: voxelsize is -0.003 m but must be above 0; 'hole' measures 0.15 m, mm(3) is usual");
}

TEST(VoxelizeRefuses, AVoxelSizeThatIsNotFinite) {
  for (const double size : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_NE(refusal(kHole, {.voxel_size = size}).find("but must be finite"), std::string::npos);
  }
}

TEST(VoxelizeRefuses, AVoxelLargerThanThePart) {
  EXPECT_EQ(refusal(kHole, {.voxel_size = 0.2}),
            "hole: voxelsize is 0.2 m but 'hole' measures only 0.15 m; mm(3) is usual");
  EXPECT_NO_THROW((void)voxelize("hole", kHole, {.voxel_size = 0.15}));
}

TEST(VoxelizeRefuses, AMeshWithoutTriangles) {
  EXPECT_EQ(refusal({}, {.voxel_size = 0.003}), "hole: has no triangles; check the model or its export");
}

TEST(VoxelizeRefuses, ACornerThatIsNotFinite) {
  for (const double bad : {kNaN, kInfinity}) {
    TriangleMesh mesh = kHole;
    mesh.vertices[3].y() = bad;
    EXPECT_EQ(refusal(mesh, {.voxel_size = 0.003}), "hole: vertex 3 is not finite; repair the mesh");
  }
}

TEST(VoxelizeRefuses, ATriangleWithoutItsCorner) {
  TriangleMesh mesh = kHole;
  mesh.triangles[2][1] = 8;
  EXPECT_EQ(refusal(mesh, {.voxel_size = 0.003}), "hole: triangle 2 names vertex 8 of 8; repair the mesh");
}

TEST(VoxelizeRefuses, ASinglePoint) {
  TriangleMesh mesh = kHole;
  for (Vector3d& p : mesh.vertices) p = {1, 1, 1};
  EXPECT_EQ(refusal(mesh, {.voxel_size = 0.003}), "hole: is a single point; check the model and its scale");
}

TEST(VoxelizeRefuses, ANegativePointSpacing) {
  EXPECT_NE(refusal(kHole, {.voxel_size = 0.003, .point_spacing = -1}).find("point spacing is -1 m"),
            std::string::npos);
}

// Vertices that no triangle uses, as loaders leave them, are not looked at.
TEST(Voxelize, IgnoresUnusedVertices) {
  TriangleMesh mesh = kHole;
  mesh.vertices.emplace_back(kNaN, 0, 0);
  EXPECT_EQ(voxelize("hole", mesh, {.voxel_size = 0.003}).voxmap.layers,
            voxelize("hole", kHole, {.voxel_size = 0.003}).voxmap.layers);
}

}  // namespace
}  // namespace verisim::refusal_test

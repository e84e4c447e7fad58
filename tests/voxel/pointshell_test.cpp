#include "engine/voxel/pointshell.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/plain.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::pointshell_test {
namespace {

Vector3d point(const Pointshell& shell, std::size_t i) {
  return Vector3f(shell.x[i], shell.y[i], shell.z[i]).cast<double>() + shell.reference;
}

Vector3d normal(const Pointshell& shell, std::size_t i) {
  return Vector3f(shell.nx[i], shell.ny[i], shell.nz[i]).cast<double>();
}

/// The inward normal of the surface voxel that contains p.
Vector3d normal_at(const VoxelBody& body, const Vector3d& p) {
  const std::int64_t number = body.voxmap.surface_number(body.voxmap.cell_of(p));
  EXPECT_GE(number, 0) << "no surface voxel at " << p.transpose();
  return number < 0 ? Vector3d::Zero() : normal(body.shell, static_cast<std::size_t>(number));
}

constexpr double kFloat = 0x1p-22;  // a normal rounded to floats, and compared with one that is not

TEST(Pointshell, PointIIsTheCentreOfSurfaceVoxelI) {
  const VoxelBody body = voxelize("block", shapes::trial_block(32), {.voxel_size = 0.008});
  const Voxmap& map = body.voxmap;
  std::size_t found = 0;
  plain::for_each_cell(
      Eigen::Vector3i::Zero(), (kBrickSide * map.bricks).array() - 1, [&](const Eigen::Vector3i& cell) {
        const std::int64_t number = map.surface_number(cell);
        ASSERT_EQ(number >= 0, map.layer(cell) == 0);
        if (number < 0) return;
        ++found;
        EXPECT_LT((point(body.shell, static_cast<std::size_t>(number)) - map.center_of(cell)).norm(), 1e-7);
      });
  EXPECT_EQ(found, map.surface_count);
  EXPECT_EQ(body.shell.size(), map.surface_count);
  EXPECT_EQ(map.surface_number({-1, 0, 0}), -1);
}

void expect_clusters_cover(const Pointshell& shell) {
  std::uint32_t next = 0;
  for (const Pointshell::Cluster& cluster : shell.clusters) {
    ASSERT_EQ(cluster.begin, next);
    ASSERT_GT(cluster.end, cluster.begin);
    ASSERT_LE(cluster.end - cluster.begin, static_cast<std::uint32_t>(kBrickCells));
    next = cluster.end;
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      const Vector3d arm = Vector3f(shell.x[i], shell.y[i], shell.z[i]).cast<double>() - cluster.center.cast<double>();
      ASSERT_LE(arm.norm(), static_cast<double>(cluster.radius));
    }
  }
  ASSERT_EQ(next, shell.size());
}

TEST(Pointshell, ClustersPartitionThePointsAndCoverThem) {
  const TriangleMesh mesh = shapes::sphere(1, 4);
  expect_clusters_cover(voxelize("sphere", mesh, {.voxel_size = 0.03}).shell);
  expect_clusters_cover(voxelize("sphere", mesh, {.voxel_size = 0.03, .point_spacing = 0.1}).shell);
}

// A box with faces in cell centres: half a face in each edge voxel, a quarter in each corner voxel, equal shares.
TEST(Pointshell, NormalsOfABoxPointInwardAndShareItsEdges) {
  const VoxelBody body = voxelize("box", shapes::box({-1, -1, -1}, {1, 1, 1}), {.voxel_size = 0.125});
  EXPECT_LT((normal_at(body, {1, 0, 0}) - Vector3d(-1, 0, 0)).norm(), kFloat);
  EXPECT_LT((normal_at(body, {0, -1, 0}) - Vector3d(0, 1, 0)).norm(), kFloat);
  EXPECT_LT((normal_at(body, {1, 0, 1}) - Vector3d(-1, 0, -1).normalized()).norm(), kFloat);
  EXPECT_LT((normal_at(body, {-1, 1, 1}) - Vector3d(1, -1, -1).normalized()).norm(), kFloat);
}

// Facets of the refined octahedron tilt against the sphere by about their half width; voxels add their own.
TEST(Pointshell, NormalsOfASpherePointToItsCentre) {
  const VoxelBody body = voxelize("sphere", shapes::sphere(1, 5), {.voxel_size = 0.02});
  for (std::size_t i = 0; i < body.shell.size(); ++i) {
    ASSERT_NEAR(normal(body.shell, i).norm(), 1, kFloat);
    ASSERT_GT(normal(body.shell, i).dot(-point(body.shell, i).normalized()), std::cos(0.05)) << point(body.shell, i);
  }
}

// Both sides have the same area in the voxel: the lexicographically smallest inward normal is taken.
TEST(Pointshell, AThinWallKeepsOneSide) {
  const VoxelBody wall = voxelize("wall", shapes::box({0, 0, 0}, {1, 1, 0.02}), {.voxel_size = 0.1});
  EXPECT_EQ(normal_at(wall, {0.5, 0.5, 0.01}), Vector3d(0, 0, -1));
  const VoxelBody across = voxelize("wall", shapes::box({0, 0, 0}, {0.02, 1, 1}), {.voxel_size = 0.1});
  EXPECT_EQ(normal_at(across, {0.01, 0.5, 0.5}), Vector3d(-1, 0, 0));
}

// A flat roof in one layer of voxels: below its ridge the two slopes cancel the floor, and the floor is the largest
// face.
TEST(Pointshell, WhereFacesCancelTheLargestDecides) {
  TriangleMesh roof;
  roof.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0.02}, {0, 1, 0}, {1, 1, 0}, {0.5, 1, 0.02}};
  roof.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {0, 2, 5}, {0, 5, 3}};
  EXPECT_GT(shapes::volume(roof), 0);
  const VoxelBody body = voxelize("roof", roof, {.voxel_size = 0.1});
  EXPECT_EQ(normal_at(body, {0.5, 0.5, 0.01}), Vector3d(0, 0, 1));
}

TEST(Pointshell, TrianglesWithoutAreaHaveNoWeight) {
  TriangleMesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
  const VoxelBody clean = voxelize("box", mesh, {.voxel_size = 0.125});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({2, 2, 2});
  const VoxelBody dirty = voxelize("box", mesh, {.voxel_size = 0.125});
  EXPECT_EQ(clean.voxmap.layers, dirty.voxmap.layers);
  EXPECT_EQ(clean.shell.nx, dirty.shell.nx);
  EXPECT_EQ(clean.shell.ny, dirty.shell.ny);
  EXPECT_EQ(clean.shell.nz, dirty.shell.nz);
}

// Far from the origin a float would have lost the points: 2^-24 of 1000 m is 0.06 mm.
TEST(Pointshell, KeepsPointsExactFarFromTheOrigin) {
  const VoxelBody body =
      voxelize("far", shapes::box({1000, 1000, 1000}, {1000.1, 1000.1, 1000.1}), {.voxel_size = 1e-3});
  const Vector3d corner = point(body.shell, 0);
  EXPECT_LT((corner - body.voxmap.center_of(body.voxmap.cell_of(corner))).norm(), 1e-8);
}

TEST(ThinnedPointshell, HasOnePointPerCubeAndDirection) {
  const TriangleMesh mesh = shapes::trial_block(64);
  constexpr double kSpacing = 0.02;
  const Pointshell all = voxelize("block", mesh, {.voxel_size = 0.004}).shell;
  const VoxelBody body = voxelize("block", mesh, {.voxel_size = 0.004, .point_spacing = kSpacing});
  const auto key = [&](const Pointshell& shell, std::size_t i) {
    const Eigen::Vector3i cube = ((point(shell, i) - body.voxmap.origin) / kSpacing).array().floor().cast<int>();
    int axis = 0;
    const Vector3d n = normal(shell, i);
    while (std::abs(n[axis]) < n.cwiseAbs().maxCoeff() - 1e-3) ++axis;
    return std::array<int, 4>{cube.x(), cube.y(), cube.z(), n[axis] < 0 ? axis : axis + 3};
  };
  const auto from_cube_center = [&](const Vector3d& p) {
    const Vector3d at = (p - body.voxmap.origin) / kSpacing;
    return (at - at.array().floor().matrix() - Vector3d::Constant(0.5)).norm();
  };
  std::map<std::array<int, 4>, double> nearest;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [at, is_new] = nearest.try_emplace(key(all, i), 1.0);
    at->second = std::min(at->second, from_cube_center(point(all, i)));
  }
  std::set<std::array<int, 4>> kept;
  for (std::size_t i = 0; i < body.shell.size(); ++i) {
    EXPECT_TRUE(kept.insert(key(body.shell, i)).second);
    EXPECT_NEAR(from_cube_center(point(body.shell, i)), nearest.at(key(body.shell, i)), 1e-5);
    const std::uint32_t voxel = body.shell.voxel[i];
    EXPECT_EQ(point(body.shell, i), point(all, voxel));
    EXPECT_EQ(normal(body.shell, i), normal(all, voxel));
  }
  EXPECT_EQ(kept.size(), nearest.size());
  EXPECT_LT(body.shell.size(), all.size() / 10);
}

TEST(ThinnedPointshell, KeepsAllPointsAtASpacingOfOneVoxel) {
  const TriangleMesh mesh = shapes::sphere(1, 3);
  const VoxelBody body = voxelize("sphere", mesh, {.voxel_size = 0.0625, .point_spacing = 0.0625});
  EXPECT_EQ(std::set<std::uint32_t>(body.shell.voxel.begin(), body.shell.voxel.end()).size(),
            body.voxmap.surface_count);
}

TEST(ThinnedPointshell, ClustersHoldManyPoints) {
  const VoxelBody body = voxelize("sphere", shapes::sphere(1, 4), {.voxel_size = 0.02, .point_spacing = 0.06});
  EXPECT_GT(body.shell.size() / body.shell.clusters.size(), 30U);
}

}  // namespace
}  // namespace verisim::pointshell_test

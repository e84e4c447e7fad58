#include "engine/voxel/voxelize.hpp"

#include <gtest/gtest.h>

#include "tests/length.hpp"
#include "tests/voxel/plain.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::voxelize_test {
namespace {

using shapes::both;
using test::turned_inside_out;

TriangleMesh tilted(const TriangleMesh& mesh) {
  const Eigen::AngleAxisd tilt(0.7, Vector3d(1, 2, 3).normalized());
  return shapes::mapped(mesh, [&](const Vector3d& p) { return Vector3d(tilt * p + Vector3d(0.1, -0.2, 0.3)); });
}

struct Case {
  const char* name;
  TriangleMesh mesh;
  double voxel_size;
};

std::vector<Case> cases() {
  const TriangleMesh cube = shapes::box({0, 0, 0}, {1, 1, 1});
  const TriangleMesh hollow = both(shapes::sphere(1, 2), turned_inside_out(shapes::sphere(0.75, 2)));
  return {
      {"cube", cube, 0.1},
      {"tilted cube", tilted(cube), 0.081},
      {"faces of a second cube in voxel walls", both(cube, shapes::box({0.125, 0.125, 0.125}, {0.875, 0.875, 0.875})),
       0.25},
      {"tilted cylinder", tilted(shapes::cylinder(0.2, 1, 24)), 0.06},
      {"block with a hole", shapes::block_with_hole({1, 1, 0.5}, 0.2, 24), 0.05},
      {"tilted block with a hole", tilted(shapes::block_with_hole({1, 1, 0.5}, 0.2, 24)), 0.07},
      {"three nested spheres, the second a cavity", both(hollow, shapes::sphere(0.4, 2)), 0.08},
      {"cube within a cube, both solid", both(cube, shapes::box({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7})), 0.05},
      {"overlapping cubes", both(cube, tilted(cube)), 0.07},
      {"wall thinner than a voxel", shapes::box({0, 0, 0}, {1, 1, 0.02}), 0.1},
      {"a single voxel", cube, 1.0},
  };
}

// Independent of everything fast: separating axes per voxel and triangle, distance by search, sides by solid angles.
TEST(Voxelize, EqualsThePlainVoxelizer) {
  const std::vector<Case> all = cases();
  for (std::size_t i = 0; i < all.size(); i += test::by_length<std::size_t>(12, 1, 1)) {
    const Case& c = all[i];
    SCOPED_TRACE(c.name);
    const Voxmap map = voxelize(c.name, c.mesh, {.voxel_size = c.voxel_size}).voxmap;
    EXPECT_TRUE(plain::layers(map) == plain::layers(c.mesh, map));
  }
}

// A box of extents n s (n even) is given faces in cell centres: n + 1 cells along each axis, of which the hull is
// surface.
TEST(Voxelize, CountsTheHullOfABox) {
  const VoxelBody body = voxelize("box", shapes::box({-1, -1, -1}, {1, 2, 4}), {.voxel_size = 0.125});
  const auto cells = [](int nx, int ny, int nz) { return static_cast<std::uint32_t>(nx * ny * nz); };
  EXPECT_EQ(body.voxmap.surface_count, cells(17, 25, 41) - cells(15, 23, 39));
  EXPECT_EQ(body.voxmap.layer_at({0, 0, 0}), -kBand - 1);
  EXPECT_EQ(body.voxmap.layer_at({-1, 0, 0}), 0);
  EXPECT_EQ(body.voxmap.layer_at({-1.125, 0, 0}), 1);
  EXPECT_EQ(body.voxmap.layer_at({-0.75, 0, 0}), -2);
  EXPECT_EQ(body.voxmap.layer_at({1e300, 0, 0}), kBand + 1);
}

// Loaders turn shells outward; one that still looks inward bounds nothing, however it is voxelized.
TEST(Voxelize, FindsNoInsideInAnInvertedShell) {
  const VoxelBody body = voxelize("box", turned_inside_out(shapes::box({0, 0, 0}, {1, 1, 1})), {.voxel_size = 0.05});
  EXPECT_GT(body.voxmap.layer_at({0.5, 0.5, 0.5}), 0);
}

TEST(Voxelize, KeepsItsResultWhenTrianglesAreCutInFour) {
  const std::vector<Case> parts = {{"block", shapes::trial_block(64), 0.0045},
                                   {"pin", shapes::cylinder(0.07, 0.4, 64), 0.0045},
                                   {"chamfer", shapes::chamfered({0.1, 0.08, 0.06}, 0.02), 0.0017},
                                   {"tilted chamfer", tilted(shapes::chamfered({0.1, 0.08, 0.06}, 0.02)), 0.0017},
                                   {"thin wall", tilted(shapes::box({0, 0, 0}, {1, 1, 0.01})), 0.03}};
  for (const Case& part : parts) {
    SCOPED_TRACE(part.name);
    const VoxelBody whole = voxelize("whole", part.mesh, {.voxel_size = part.voxel_size});
    const TriangleMesh fine = test::subdivide(test::subdivide(part.mesh));
    const VoxelBody cut = voxelize("cut", fine, {.voxel_size = part.voxel_size});
    EXPECT_EQ(whole.voxmap.brick_block, cut.voxmap.brick_block);
    EXPECT_EQ(whole.voxmap.surface_mask, cut.voxmap.surface_mask);
    EXPECT_EQ(whole.voxmap.layers, cut.voxmap.layers);
    ASSERT_EQ(whole.shell.size(), cut.shell.size());
    for (std::size_t i = 0; i < whole.shell.size(); ++i) {
      ASSERT_NEAR(whole.shell.nx[i], cut.shell.nx[i], 1e-6);
      ASSERT_NEAR(whole.shell.ny[i], cut.shell.ny[i], 1e-6);
      ASSERT_NEAR(whole.shell.nz[i], cut.shell.nz[i], 1e-6);
    }
  }
}

// 8000 cavities: each is a region of its own and costs only what is near it.
TEST(Voxelize, FindsEveryPocket) {
  TriangleMesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  constexpr int kPockets = 20;
  const double pitch = 1.0 / kPockets;
  std::vector<Vector3d> centers;
  for (int i = 0; i < kPockets * kPockets * kPockets; ++i) {
    centers.emplace_back(pitch * Vector3d(i % 20 + 0.5, i / 20 % 20 + 0.5, i / 400 + 0.5));
    const Vector3d arm = Vector3d::Constant(0.2 * pitch);
    mesh = both(std::move(mesh), turned_inside_out(shapes::box(centers.back() - arm, centers.back() + arm)));
  }
  const Voxmap map = voxelize("pockets", mesh, {.voxel_size = pitch / 10}).voxmap;
  for (const Vector3d& center : centers) {
    EXPECT_GT(map.layer_at(center), 0);
    EXPECT_LT(map.layer_at(center + Vector3d::Constant(0.3 * pitch)), 0);
  }
}

// The ray of a winding number meets edges and corners of this mesh wherever it goes: all lie on voxel centres' rows.
TEST(Voxelize, IsNotConfusedByEdgesOnTheRay) {
  const TriangleMesh outer = test::subdivide(test::subdivide(test::subdivide(shapes::box({0, 0, 0}, {2, 2, 2}))));
  const TriangleMesh inner = test::subdivide(test::subdivide(shapes::box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5})));
  const Voxmap map = voxelize("nested", both(outer, turned_inside_out(inner)), {.voxel_size = 0.0625}).voxmap;
  EXPECT_GT(map.layer_at({1, 1, 1}), 0);
  EXPECT_LT(map.layer_at({0.25, 0.25, 0.25}), 0);
  EXPECT_GT(map.layer_at({-0.25, 1, 1}), 0);
}

TEST(Voxelize, GivesTheSameBitsForAnyNumberOfThreads) {
  const TriangleMesh mesh = tilted(shapes::trial_block(64));
  const VoxelBody one = voxelize("block", mesh, {.voxel_size = 0.003});
  for (const unsigned threads : {0U, 2U, 3U, 8U}) {
    const VoxelBody many = voxelize("block", mesh, {.voxel_size = 0.003, .threads = threads});
    EXPECT_EQ(one.voxmap.layers, many.voxmap.layers);
    EXPECT_EQ(one.voxmap.surface_mask, many.voxmap.surface_mask);
    EXPECT_EQ(one.shell.x, many.shell.x);
    EXPECT_EQ(one.shell.nx, many.shell.nx);
    EXPECT_EQ(one.shell.ny, many.shell.ny);
    EXPECT_EQ(one.shell.nz, many.shell.nz);
  }
}

TEST(Voxmap, ClearanceCountsBricksToTheSurface) {
  const VoxelBody body =
      voxelize("hollow", both(shapes::box({0, 0, 0}, {3, 1, 1}), turned_inside_out(shapes::sphere(0.1, 3))),
               {.voxel_size = 0.01});
  const Voxmap& map = body.voxmap;
  std::vector<Eigen::Vector3i> bricks, with_surface;
  plain::for_each_cell(Eigen::Vector3i::Zero(), map.bricks.array() - 1, [&](const auto& b) { bricks.push_back(b); });
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    const auto& mask = map.surface_mask[map.brick_block[i]];
    if (std::any_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word != 0; })) {
      with_surface.push_back(bricks[i]);
    }
  }
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    int nearest = 127;
    for (const auto& other : with_surface) nearest = std::min(nearest, (other - bricks[i]).cwiseAbs().maxCoeff());
    const bool inside = map.layer(kBrickSide * bricks[i]) < 0 && nearest > 0;
    ASSERT_EQ(map.brick_clearance[i], inside ? -nearest : nearest) << bricks[i].transpose();
  }
}

// Per axis: extent 3.5 voxels are 0.25 from a wall either way, 4 fit best with a cell centre in the middle, 3 with a
// wall.
TEST(GridOrigin, KeepsFacesFarFromVoxelWalls) {
  Bounds bounds;
  bounds.include({10, 20, 30});
  bounds.include({13.5, 24, 33});
  Eigen::Vector3i bricks;
  const Vector3d origin = grid_origin(bounds, 1, bricks);
  const auto from_wall = [](double x) { return std::abs(x - std::round(x)); };
  for (const Vector3d& face : {bounds.min, bounds.max}) {
    EXPECT_DOUBLE_EQ(from_wall(face.x() - origin.x()), 0.25);
    EXPECT_DOUBLE_EQ(from_wall(face.y() - origin.y()), 0.5);
    EXPECT_DOUBLE_EQ(from_wall(face.z() - origin.z()), 0.5);
  }
}

TEST(GridOrigin, LeavesABorderOfOneBrickAndLittleMore) {
  for (double extent = 0.5; extent < 60; extent += 0.37) {
    Bounds bounds;
    bounds.include(Vector3d::Zero());
    bounds.include(Vector3d::Constant(extent));
    Eigen::Vector3i bricks;
    const Vector3d low = -grid_origin(bounds, 1, bricks);
    EXPECT_GE(low.x(), kBrickSide);
    EXPECT_LT(low.x(), 2 * kBrickSide);
    const double rest = kBrickSide * bricks.x() - (low.x() + extent);
    EXPECT_GE(rest, kBrickSide);
    EXPECT_LE(rest, 2 * kBrickSide);
  }
}

}  // namespace
}  // namespace verisim::voxelize_test

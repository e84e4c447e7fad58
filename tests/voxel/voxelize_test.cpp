#include "engine/voxel/voxelize.hpp"

#include <gtest/gtest.h>

#include "tests/voxel/plain.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim {
namespace {

using shapes::both;
using shapes::inside_out;

const Eigen::AngleAxisd kTilt(0.7, Vector3d(1, 2, 3).normalized());

TriangleMesh tilted(const TriangleMesh& mesh) {
  return shapes::mapped(mesh, [](const Vector3d& p) { return Vector3d(kTilt * p + Vector3d(0.1, -0.2, 0.3)); });
}

struct Case {
  const char* name;
  TriangleMesh mesh;
  double voxel_size;
};

std::vector<Case> cases() {
  const TriangleMesh cube = shapes::box({0, 0, 0}, {1, 1, 1});
  const TriangleMesh small = shapes::box({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7});
  const TriangleMesh three_spheres =
      both(both(shapes::sphere(1, 3), inside_out(shapes::sphere(0.75, 3))), shapes::sphere(0.4, 3));
  return {
      {"cube", cube, 0.1},
      {"cube whose faces lie in voxel walls and centres alike", cube, 2.0 / 7},
      {"tilted cube", tilted(cube), 0.061},
      {"cylinder", tilted(shapes::cylinder(0.2, 1, 24)), 0.05},
      {"block with a hole", shapes::block_with_hole({1, 1, 0.5}, 0.2, 32), 0.05},
      {"tilted block with a hole", tilted(shapes::block_with_hole({1, 1, 0.5}, 0.2, 32)), 0.06},
      {"three nested spheres", three_spheres, 0.06},
      {"cube with a cavity", both(cube, inside_out(small)), 0.04},
      {"cube within a cube, both solid", both(cube, small), 0.04},
      {"overlapping cubes", both(cube, tilted(cube)), 0.07},
      {"wall thinner than a voxel", shapes::box({0, 0, 0}, {1, 1, 0.02}), 0.1},
      {"one voxel", cube, 1.0},
  };
}

// Independent of everything fast: separating axes per voxel and triangle, distance by search, sides by solid angles.
TEST(Voxelize, EqualsThePlainVoxelizer) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Voxmap map = voxelize(c.name, c.mesh, {.voxel_size = c.voxel_size}).voxmap;
    EXPECT_TRUE(plain::layers(map) == plain::layers(c.mesh, map));
  }
}

}  // namespace
}  // namespace verisim

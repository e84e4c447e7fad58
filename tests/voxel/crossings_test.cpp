#include "engine/voxel/crossings.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "engine/base/random.hpp"
#include "tests/voxel/plain.hpp"

namespace verisim::crossings_test {
namespace {

/// A tetrahedron in a grid of two bricks along x and one along y and z, looking outward or, every other time, inward.
/// Corners on halves are on the very lines that are tested; none is nearer to the grid's walls than the lists' margin.
TriangleMesh random_tetrahedron(std::uint64_t seed, bool on_halves) {
  const RandomStream stream(seed, "tetrahedron");
  TriangleMesh mesh;
  for (std::uint64_t i = 0; i < 4; ++i) {
    const auto within = [&](double size, std::uint64_t k) { return 0.01 + (size - 0.02) * stream.uniform(3 * i + k); };
    Vector3d p(within(16, 0), within(8, 1), within(8, 2));
    if (on_halves) p = p.array().floor() + 0.5;
    mesh.vertices.push_back(p);
  }
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

// Every pair of untouched neighbours along every row, against solid angles at the two ends.
TEST(WindingChange, IsTheDifferenceOfTheWindingNumbersAtTheEnds) {
  int changes = 0;
  Voxmap unit_grid;
  unit_grid.voxel_size = 1;
  unit_grid.bricks = {2, 1, 1};
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const TriangleMesh mesh = random_tetrahedron(seed, seed % 2 == 0);
    const GridMesh grid_mesh{.vertices = mesh.vertices, .triangles = &mesh.triangles};
    const BrickLists lists = list_triangles_by_brick(grid_mesh, unit_grid.bricks);
    std::optional<Eigen::Vector3i> from;
    int from_winding = 0;
    plain::for_each_cell({0, 0, 0}, {15, 7, 7}, [&](const Eigen::Vector3i& cell) {
      if (cell.x() == 0) from.reset();
      if (plain::is_surface(mesh, unit_grid, cell)) return;
      const auto winding = static_cast<int>(std::lround(plain::winding_number(mesh, unit_grid.center_of(cell))));
      if (from) {
        ASSERT_EQ(winding_change(grid_mesh, lists, unit_grid.bricks, *from, cell.x()), winding - from_winding)
            << from->transpose() << " to " << cell.transpose();
      }
      changes += from && winding != from_winding ? 1 : 0;
      from = cell;
      from_winding = winding;
    });
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(changes, 100);
}

}  // namespace
}  // namespace verisim::crossings_test

// The doors of engine/voxel: each stage takes what the stage before made of the same mesh and grid, and nothing else.
// What a user can give is refused at voxelize (refusal_test).
#include <gtest/gtest.h>

#include <limits>

#include "engine/voxel/association.hpp"
#include "engine/voxel/crossings.hpp"
#include "engine/voxel/edge_cells.hpp"
#include "engine/voxel/layers.hpp"
#include "engine/voxel/limits.hpp"
#include "engine/voxel/pointshell.hpp"
#include "engine/voxel/slot_sets.hpp"
#include "tests/support/broken.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::voxel_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TriangleMesh cube() {
  return shapes::box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01});
}

/// The stages of voxelize() for a cube of 20 mm with voxels of 5 mm, one after the other.
struct Stages {
  TriangleMesh mesh = cube();
  Voxmap map;
  GridMesh grid;
  BrickLists lists;
  SurfaceVoxels surface;
  Sides sides;
  std::size_t blocks = 0;
  Stages() {
    map.voxel_size = 0.005;
    map.origin = grid_origin(bounds_of(mesh), map.voxel_size, map.bricks);
    grid = in_grid_coordinates(mesh, map);
    lists = list_triangles_by_brick(grid, map.bricks);
    surface = find_surface(grid, lists, map.bricks, 1);
    sides = find_sides(grid, lists, surface);
    blocks = assign_blocks(surface, sides, map);
    fill_blocks(surface, sides, blocks, 1, map);
    fill_clearance(surface, sides, map);
  }
};

TEST(GridDeathTest, IsLaidAroundSomethingFinite) {
  Eigen::Vector3i bricks;
  const Bounds cube_bounds = bounds_of(cube());
  EXPECT_BROKEN(grid_origin(Bounds(), 0.005, bricks), "is_finite(bounds.min)");
  Bounds bounds = cube_bounds;
  bounds.max.y() = kInfinity;
  EXPECT_BROKEN(grid_origin(bounds, 0.005, bricks), "is_finite(bounds.max)");
  bounds = cube_bounds;
  std::swap(bounds.min, bounds.max);
  EXPECT_BROKEN(grid_origin(bounds, 0.005, bricks), "(bounds.min.array() <= bounds.max.array()).all()");
  EXPECT_BROKEN(grid_origin(cube_bounds, 0, bricks), "is_positive(voxel_size)");
  EXPECT_BROKEN(in_grid_coordinates(cube(), Voxmap()), "is_positive(map.voxel_size)");
  const MemoryEstimate estimate(cube(), cube_bounds);
  EXPECT_BROKEN(estimate.bytes(0), "voxel_size > 0");
  bounds.min = bounds.max = Vector3d::Zero();
  EXPECT_BROKEN(MemoryEstimate(cube(), bounds).smallest_size(1e9), "is_positive(size_.maxCoeff())");
}

TEST(BrickListsDeathTest, HoldTrianglesWithinTheGrid) {
  Stages s;
  EXPECT_BROKEN(list_triangles_by_brick(s.grid, s.map.bricks, -1), "is_not_negative(margin)");
  GridMesh grid = s.grid;
  grid.vertices[0].x() = 0;
  EXPECT_BROKEN(list_triangles_by_brick(grid, s.map.bricks), "lies_within(mesh.vertices[corner], bricks, margin)");
  grid.vertices[0].x() = kNaN;
  EXPECT_BROKEN(list_triangles_by_brick(grid, s.map.bricks), "lies_within(mesh.vertices[corner], bricks, margin)");
  grid = s.grid;
  grid.vertices.pop_back();
  EXPECT_BROKEN(list_triangles_by_brick(grid, s.map.bricks), "corner < mesh.vertices.size()");
}

TEST(SurfaceDeathTest, IsOfItsGrid) {
  Stages s;
  const Eigen::Vector3i more = s.map.bricks + Eigen::Vector3i::UnitX();
  EXPECT_BROKEN(find_surface(s.grid, s.lists, more, 1),
                "lists.begin.size() == static_cast<std::size_t>(bricks.cast<std::int64_t>().prod()) + 1");
}

TEST(SidesDeathTest, AreOfTheirSurface) {
  Stages s;
  s.surface.entry.pop_back();
  EXPECT_BROKEN(find_sides(s.grid, s.lists, s.surface), "lists.begin.size() == surface.entry.size() + 1");
  s = Stages();
  s.surface.cells.pop_back();
  EXPECT_BROKEN(find_sides(s.grid, s.lists, s.surface), "surface.cells.size() == surface.brick.size()");
  s = Stages();
  s.surface.brick.push_back(s.surface.brick.back());
  s.surface.cells.push_back(s.surface.cells.back());
  EXPECT_BROKEN(find_sides(s.grid, s.lists, s.surface), "is_ascending(surface.brick)");
}

TEST(LayersDeathTest, AreOfOneSurfaceAndItsSides) {
  Stages s;
  Sides sides = s.sides;
  sides.brick.pop_back();
  EXPECT_BROKEN(assign_blocks(s.surface, sides, s.map), "sides.brick.size() == surface.entry.size()");
  EXPECT_BROKEN(fill_clearance(s.surface, sides, s.map), "sides.brick.size() == surface.entry.size()");
  sides = s.sides;
  sides.inside.pop_back();
  EXPECT_BROKEN(fill_blocks(s.surface, sides, s.blocks, 1, s.map), "sides.inside.size() == surface.brick.size()");
  EXPECT_BROKEN(fill_blocks(s.surface, s.sides, 1, 1, s.map), "blocks >= 2");
  Voxmap unassigned = s.map;
  unassigned.brick_block.clear();
  EXPECT_BROKEN(fill_blocks(s.surface, s.sides, s.blocks, 1, unassigned),
                "map.brick_block.size() == surface.entry.size()");
  SurfaceVoxels surface = s.surface;
  surface.cells.pop_back();
  EXPECT_BROKEN(assign_blocks(surface, s.sides, s.map), "surface.cells.size() == surface.brick.size()");
  surface = s.surface;
  ++surface.bricks.z();
  EXPECT_BROKEN(fill_clearance(surface, s.sides, s.map),
                "surface.entry.size() == static_cast<std::size_t>(surface.bricks.cast<std::int64_t>().prod())");
}

TEST(PointshellDeathTest, HasAPointForEverySurfaceVoxel) {
  Stages s;
  const Vector3d o = Vector3d::Zero();
  const Pointshell shell = make_pointshell(s.grid, s.lists, s.surface, s.map, o, 1);
  EXPECT_BROKEN(make_pointshell(s.grid, s.lists, s.surface, s.map, {kNaN, 0, 0}, 1), "is_finite(reference)");
  Voxmap map = s.map;
  ++map.surface_count;
  EXPECT_BROKEN(make_pointshell(s.grid, s.lists, s.surface, map, o, 1), "map.surface_count == surface.voxels");
  map = s.map;
  map.brick_block.pop_back();
  EXPECT_BROKEN(make_pointshell(s.grid, s.lists, s.surface, map, o, 1),
                "map.brick_block.size() == surface.entry.size()");
  BrickLists lists = s.lists;
  lists.begin.pop_back();
  EXPECT_BROKEN(make_pointshell(s.grid, lists, s.surface, s.map, o, 1),
                "lists.begin.size() == surface.entry.size() + 1");

  EXPECT_BROKEN(thinned(shell, s.map, 0), "is_positive(spacing)");
  EXPECT_BROKEN(thinned(thinned(shell, s.map, 0.01), s.map, 0.01), "shell.voxel.empty()");
  map = s.map;
  ++map.surface_count;
  EXPECT_BROKEN(thinned(shell, map, 0.01), "shell.size() == map.surface_count");
}

TEST(SlotSetsDeathTest, KnowTheSetOfEverySurfaceVoxel) {
  const Stages s;
  const FeatureSets sets;
  std::vector<FeatureSetId> of_voxel(s.map.surface_count, 0);
  of_voxel.back() = 1;
  EXPECT_BROKEN(sets_by_slot(s.map, of_voxel, sets, 1),
                "std::ranges::all_of(of_voxel, [&](FeatureSetId id) { return id < sets.size(); })");
  of_voxel.pop_back();
  EXPECT_BROKEN(sets_by_slot(s.map, of_voxel, sets, 1), "of_voxel.size() == map.surface_count");
  EXPECT_BROKEN(FeatureSets("part", FeatureSets::kMostSets + 1), "most <= kMostSets");
}

TEST(AssociationDeathTest, IsOfAPartWhoseFacesAndEdgesAreThere) {
  VoxelBody body;
  EXPECT_BROKEN(associate("part", Part(), {}, body), "body.voxmap.surface_count > 0");
  body = voxelize("part", cube(), {.voxel_size = 0.005});
  Part part;
  part.mesh = shapes::box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.012});
  EXPECT_BROKEN(associate("part", part, {}, body), "is_of(body.voxmap, name, part.mesh)");
  part.mesh = cube();
  part.mesh.triangles[0][0] += 100;
  EXPECT_BROKEN(associate("part", part, {}, body), "is_whole(part.mesh)");
  part.mesh = cube();
  part.faces.resize(1);
  EXPECT_BROKEN(associate("part", part, {}, body), "part.mesh.face_of_triangle.size() == part.mesh.triangles.size()");
  part.faces[0].edges = {0};
  EXPECT_BROKEN(associate("part", part, {}, body), "edge < part.edges.size()");
  part.faces.clear();
  part.edges.resize(1);
  part.edges[0].faces = {0};
  EXPECT_BROKEN(associate("part", part, {}, body), "face < part.faces.size()");
}

TEST(DeclaredFeaturesDeathTest, BelongToOneBodyAndAreNumberedAsAdded) {
  const VoxelBody body = voxelize("part", cube(), {.voxel_size = 0.005});
  DeclaredFeatures declared;
  EXPECT_BROKEN(declared.assign(body, body.voxmap.surface_count, 0), "voxel < body.voxmap.surface_count");
  EXPECT_BROKEN(declared.assign(body, 0, 1), "id <= size()");
  EXPECT_BROKEN(declared.entities_in(1), "id <= size()");
  EXPECT_BROKEN(declared.numbered(1, 0, 0), "id <= size()");
  const VoxelBody thin = voxelize("part", cube(), {.voxel_size = 0.005, .point_spacing = 0.01});
  EXPECT_BROKEN(declared.assign(thin, 0, 0), "body.shell.size() == body.voxmap.surface_count");
  declared.assign(body, 0, 0);
  const VoxelBody finer = voxelize("part", cube(), {.voxel_size = 0.004});
  EXPECT_BROKEN(declared.assign(finer, 0, 0), "of_voxel_.empty() || of_voxel_.size() == body.voxmap.surface_count");
  Face face;
  face.surface = Plane{{0, 0, 0.01}, {0, 0, 1}, {1, 0, 0}};
  const std::array<DeclaredFeatures::Entity, 1> set = {face};
  const FeatureSetId id = declared.add("part", set);
  EXPECT_BROKEN(declared.numbered(id, 3, 3), "first_face + faces_.size() <= first_edge");
}

TEST(VoxmapDeathTest, IsAskedForSlotsThatItHas) {
  const Stages s;
  const auto beyond = static_cast<std::uint32_t>(s.map.surface_mask.size() * kBrickCells);
  EXPECT_BROKEN(surface_number_of_slot(s.map, beyond), "block < map.surface_mask.size()");
  const Vector3d o = Vector3d::Zero();
  EXPECT_BROKEN(triangle_touches_box(o, o, o, o, 0), "half_side > 0");
}

TEST(CrossingsDeathTest, AreCountedForwardAlongARowOfTheGrid) {
  const Stages s;
  const auto change = [&](const Eigen::Vector3i& from, int to_x) {
    return winding_change(s.grid, s.lists, s.map.bricks, from, to_x);
  };
  EXPECT_BROKEN(change({0, -1, 0}, 0), "(from.array() >= 0).all()");
  EXPECT_BROKEN(change({0, 0, 8 * s.map.bricks.z()}, 0), "(from.array() < kBrickSide * bricks.array()).all()");
  EXPECT_BROKEN(change({1, 0, 0}, 0), "from.x() <= to_x");
  EXPECT_BROKEN(change({0, 0, 0}, 8 * s.map.bricks.x()), "to_x < kBrickSide * bricks.x()");
}

TEST(EdgesDeathTest, LieInAGrid) {
  const Stages s;
  Edge edge;
  edge.curve = Line{{0, 0, 0}, {1, 0, 0}};
  edge.t_range = {0, 0.01};
  const Matrix3d axes = Matrix3d::Identity();
  EXPECT_BROKEN(GridCurve(edge, axes, {0, 0, 0}, 0), "is_positive(scale)");
  EXPECT_BROKEN(GridCurve(edge, kNaN * axes, {0, 0, 0}, 1), "axes.allFinite()");
  EXPECT_BROKEN(GridCurve(edge, axes, {kInfinity, 0, 0}, 1), "is_finite(origin)");
  const std::vector<GridCurve> curves = {GridCurve(edge, axes, s.map.origin, 200)};
  EXPECT_BROKEN(EdgeLists(curves, {}, s.map.bricks, s.surface.entry, 1), "distances.size() == curves.size()");
  EXPECT_BROKEN(EdgeLists(curves, {-1}, s.map.bricks, s.surface.entry, 1),
                "std::ranges::all_of(distances, is_not_negative)");
  EXPECT_BROKEN(EdgeLists(curves, {1}, s.map.bricks, {}, 1),
                "entry_of_brick.size() == static_cast<std::size_t>(bricks.cast<std::int64_t>().prod())");
}

}  // namespace
}  // namespace verisim::voxel_contracts_test

#include "engine/voxel/voxelize.hpp"

#include "engine/base/error.hpp"
#include "engine/voxel/layers.hpp"
#include "engine/voxel/limits.hpp"
#include "engine/voxel/pointshell.hpp"

namespace verisim {

namespace {

double result_bytes(const SurfaceVoxels& surface, std::size_t blocks) {
  return static_cast<double>(surface.voxels) * 6 * sizeof(float) +
         static_cast<double>(surface.brick.size() * sizeof(Pointshell::Cluster)) +
         static_cast<double>(blocks) * (kBrickCells + sizeof(BrickMask) + sizeof(std::uint32_t)) +
         static_cast<double>(surface.entry.size()) * (sizeof(std::uint32_t) + sizeof(Layer));
}

}  // namespace

VoxelBody voxelize(const std::string& name, const TriangleMesh& mesh, const VoxelizeOptions& options) {
  const Bounds bounds = checked_bounds(name, mesh);
  check_voxel_size(name, mesh, bounds, options);

  VoxelBody body;
  Voxmap& map = body.voxmap;
  map.voxel_size = options.voxel_size;
  map.origin = grid_origin(bounds, options.voxel_size, map.bricks);
  const GridMesh grid_mesh = in_grid_coordinates(mesh, map);
  const BrickLists lists = list_triangles_by_brick(grid_mesh, map.bricks);
  const SurfaceVoxels surface = find_surface(grid_mesh, lists, map.bricks, options.threads);
  {
    const Sides sides = find_sides(grid_mesh, lists, surface);
    const std::size_t blocks = assign_blocks(surface, sides, map);
    check_result_size(name, mesh, bounds, options, result_bytes(surface, blocks));
    fill_blocks(surface, sides, blocks, options.threads, map);
    fill_clearance(surface, sides, map);
  }
  VERISIM_ASSERT(map.surface_count == surface.voxels);  // a voxel's number is its point's: association, contacts
  body.shell = make_pointshell(grid_mesh, lists, surface, map, bounds.center(), options.threads);
  if (options.point_spacing > 0) body.shell = thinned(body.shell, map, options.point_spacing);
  return body;
}

}  // namespace verisim

// Signed distance layers and the block storage of a voxmap, from surface and sides.
#pragma once

#include "engine/voxel/regions.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

// Of all three: @pre `sides` is what find_sides says of `surface`, `map` what assign_blocks made of both.

/// Gives a block to every brick within kBand of a surface voxel, in brick order, and kOutsideBlock or kInsideBlock to
/// the others. Fills brick_block. @returns the number of blocks, including these two
[[nodiscard]] std::size_t assign_blocks(const SurfaceVoxels& surface, const Sides& sides, Voxmap& map);

/// Fills layers, surface_mask, first_surface and surface_count. About 1 us per block.
void fill_blocks(const SurfaceVoxels& surface, const Sides& sides, std::size_t blocks, unsigned threads, Voxmap& map);

/// Fills brick_clearance. About 20 ns per brick.
void fill_clearance(const SurfaceVoxels& surface, const Sides& sides, Voxmap& map);

}  // namespace verisim

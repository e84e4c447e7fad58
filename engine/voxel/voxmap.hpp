// The voxel representation of one body: a sparse map of signed distance layers (voxmap) and its pointshell.
//
// Source: dissertation chapters 6 and 8 (surface voxels, 12-bit private data per voxel; here 16); Voxmap PointShell of
// McNeely et al. 1999. Coordinates: grid coordinates G are body coordinates shifted by `origin` and divided by the
// voxel size, so cell (i,j,k) is the closed box [i,i+1] x [j,j+1] x [k,k+1].
//
// Storage is in bricks of 8 x 8 x 8 voxels. A brick without a surface voxel within the band holds one value everywhere
// and refers to one common block (kOutsideBlock or kInsideBlock), so memory follows surface area. Look-up is two
// dependent loads:
//   block = brick_block[brick index];  layer = layers[block * 512 + cell in brick]
// The grid has a border of at least one outside brick on every side: coordinates clamped to the grid read "outside".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/pose.hpp"
#include "engine/voxel/feature_sets.hpp"

namespace verisim {

inline constexpr int kBrickShift = 3;
inline constexpr int kBrickSide = 1 << kBrickShift;
inline constexpr int kBrickCells = 1 << (3 * kBrickShift);  ///< also the most points that a cluster of the shell has
inline constexpr std::uint32_t kOutsideBlock = 0;
inline constexpr std::uint32_t kInsideBlock = 1;
inline constexpr int kBand = 6;  ///< layers are exact (Chebyshev voxel steps from the nearest surface voxel) up to here

/// Signed layer of a voxel: 0 = surface (a triangle passes through its closed box), -k = inside, k voxel steps
/// (26-neighbourhood) from the nearest surface voxel, +k = outside; clamped to ±(kBand + 1).
using Layer = std::int8_t;

/// brick_clearance counts bricks (Chebyshev steps) to the nearest brick with a surface voxel: + outside, - inside, 0
/// has one; clamped to ±127.
struct Voxmap {                            //  shape        unit  meaning
  Vector3d origin = Vector3d::Zero();      //               m     corner of cell (0,0,0) in body coordinates
  double voxel_size = 0;                   //               m
  Eigen::Vector3i bricks = {0, 0, 0};      //               -     number of bricks along x, y, z
  std::vector<std::uint32_t> brick_block;  //  (bz,by,bx)   -     block of each brick, x fastest
  std::vector<Layer> brick_clearance;      //  (bz,by,bx)   -     signed distance to the surface in bricks
  std::vector<Layer> layers;               //  (blocks,512) -     cell = x + 8 y + 64 z within the brick
  std::vector<std::array<std::uint64_t, 8>> surface_mask;   // (blocks) - bit x + 8 y of word z: is a surface voxel
  std::vector<std::array<std::uint32_t, 8>> first_surface;  // (blocks) - number of each word's first surface voxel
  std::uint32_t surface_count = 0;

  /// Layer of the voxel that contains the body-coordinate point; outside the grid: +(kBand + 1). For tests and tools.
  [[nodiscard]] Layer layer_at(const Vector3d& p_B) const;
  /// Cell of a body-coordinate point, not clamped.
  [[nodiscard]] Eigen::Vector3i cell_of(const Vector3d& p_B) const;
  [[nodiscard]] Layer layer(const Eigen::Vector3i& cell) const;  ///< as layer_at, by cell
  /// Number of a surface voxel in [0, surface_count), which is also its pointshell point; -1 if it is none.
  [[nodiscard]] std::int64_t surface_number(const Eigen::Vector3i& cell) const;
  [[nodiscard]] Vector3d center_of(const Eigen::Vector3i& cell) const {
    return origin + voxel_size * (cell.cast<double>() + Vector3d::Constant(0.5));
  }
  [[nodiscard]] std::size_t memory_bytes() const;
};

/// Bits that are set: without the popcount instruction, which not every x86-64 has, std::popcount is a function call.
[[nodiscard]] inline std::uint32_t count_bits(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F;
  return static_cast<std::uint32_t>(word * 0x0101010101010101 >> 56);
}

/// Number of the surface voxel that is stored at `slot` (block * 512 + cell); -1 if it is none. A few ns.
/// @pre the map has that block
[[nodiscard]] inline std::int64_t surface_number_of_slot(const Voxmap& map, std::uint32_t slot) {
  const std::uint32_t block = slot / kBrickCells, z = slot % kBrickCells / 64, bit = slot % 64;
  VERISIM_ASSERT(block < map.surface_mask.size());
  const std::uint64_t word = map.surface_mask[block][z];
  if ((word >> bit & 1) == 0) return -1;
  return map.first_surface[block][z] + count_bits(word & ((std::uint64_t{1} << bit) - 1));
}

/// One point per surface voxel: the voxel's centre with an inward normal. Sorted by brick (z, y, x), then by cell
/// within it, so that point i is surface voxel i of the same body's voxmap and a cluster is a sequence of neighbours.
/// A normal is the mean of the faces in the voxel, weighted by their area in it (normals.hpp).
struct Pointshell {                    //  shape  unit  meaning
  std::vector<float> x, y, z;          //  (n)    m     voxel's centre relative to `reference`, body coordinates
  std::vector<float> nx, ny, nz;       //  (n)    1     inward normal
  std::vector<std::uint32_t> voxel;    //  (n)    -     surface voxel number of each point; empty: point i is voxel i
  std::vector<FeatureSetId> features;  //  (surface_count) - set of entities in each SURFACE VOXEL; empty: unknown
  struct Cluster {
    std::uint32_t begin, end;  //  -            points [begin, end), at most 512
    Vector3f center;           //  m            of the bounding ball, relative to `reference`
    float radius;              //  m            covers every point (rounded up)
  };
  std::vector<Cluster> clusters;
  Vector3d reference = Vector3d::Zero();  // m  body coordinates; keeps floats small for parts far from their origin
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] std::size_t memory_bytes() const;
};

/// The voxel representation of a body.
struct VoxelBody {
  Voxmap voxmap;
  Pointshell shell;
  BodyFeatures features;                ///< referred to by shell.features; empty unless filled by association.hpp
  std::vector<FeatureSetId> slot_sets;  ///< (blocks,512): see slot_sets.hpp; empty likewise
};

}  // namespace verisim

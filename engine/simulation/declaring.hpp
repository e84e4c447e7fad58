// A described body as voxels while its scene is built: what a script goes through to declare entities by hand.
// Body coordinates, m. The simulation makes its own voxels from the same description: the same ones.
#pragma once

#include <cstdint>
#include <span>

#include "engine/simulation/scene.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

class Declaring {
 public:
  /// Voxelizes the body. Error(input) as voxelize() has it.
  explicit Declaring(const BodyDescription& body);

  [[nodiscard]] std::uint32_t surface_voxels() const { return voxels_.voxmap.surface_count; }
  [[nodiscard]] Vector3d center(std::uint32_t voxel) const;  ///< @pre voxel < surface_voxels()
  [[nodiscard]] std::size_t memory_bytes() const;

  /// Gives the surface voxel that holds p the set, in body.declared. Returns the set's number, 0 for an empty set.
  /// Error(input) that names the body: no surface voxel there; what DeclaredFeatures::add refuses; an entity that,
  /// unbounded, is further from the voxel's centre than two of its diagonals: no shape fitted to the voxels is.
  /// @pre body is what this was made from
  FeatureSetId give(BodyDescription& body, const Vector3d& p, std::span<const DeclaredFeatures::Entity> set) const;

 private:
  VoxelBody voxels_;
};

}  // namespace verisim

// The voxels of a body as bytes and back, for what is prepared once and kept (engine/record/prepared_store.hpp). Round
// trip is exact to the bit. For the same build alone.
#pragma once

#include <string>
#include <string_view>

#include "engine/voxel/voxmap.hpp"

namespace verisim {

[[nodiscard]] std::string to_bytes(const VoxelBody& body);
/// Error(input) if the bytes end too early or go on. @pre to_bytes of the same build made them
[[nodiscard]] VoxelBody voxel_body_from(std::string_view bytes);

}  // namespace verisim

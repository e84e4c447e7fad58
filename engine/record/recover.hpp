// What the first bytes of an HDF5 file say of the process that wrote it.
#pragma once

#include <cstdint>
#include <string>

namespace verisim {

struct Superblock {
  bool left_open = false;         ///< by a writer that did not come to its end
  std::uint64_t end_address = 0;  ///< bytes that the file says it has
};

/// Throws Error(input): not there, empty, not HDF5, older than SWMR.
[[nodiscard]] Superblock read_superblock(const std::string& path);

}  // namespace verisim

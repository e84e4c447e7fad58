// The superblock of an HDF5 file: its state when the writing process ended.
#pragma once

#include <cstdint>
#include <string>

namespace verisim {

struct Superblock {
  bool left_open = false;         ///< by a writer that did not close it
  std::uint64_t end_address = 0;  ///< length of the file in bytes, as it records it
};

/// Throws Error(input): not there, empty, not HDF5, older than SWMR.
[[nodiscard]] Superblock read_superblock(const std::string& path);

}  // namespace verisim

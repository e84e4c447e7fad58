// HDF5 keeps strings of their own length (h5py's str) in "global heaps", the one structure of its current format
// without a checksum, and believes the lengths that it finds there. A flipped bit in one would crash the reader: looked
// at first.
#pragma once

#include <string>
#include <string_view>

namespace verisim {

/// Throws hdf5::Failure if a global heap of the file contradicts itself. Reads the whole file once (about 5 GB/s).
void check_text_heaps(const std::string& path);
/// The same of a file in memory.
void check_text_heaps_of(std::string_view bytes);

}  // namespace verisim

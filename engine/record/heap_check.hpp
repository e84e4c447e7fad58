// A check of HDF5's "global heaps", which hold strings of variable length (h5py's str). They are the one structure of
// its current format without a checksum, and HDF5 trusts the lengths in them. A flipped bit would crash the reader.
#pragma once

#include <string>
#include <string_view>

namespace verisim {

/// Throws hdf5::Failure if a global heap of the file is inconsistent. Reads the whole file once (about 5 GB/s).
void check_text_heaps(const std::string& path);
/// The same of a file in memory.
void check_text_heaps_of(std::string_view bytes);

}  // namespace verisim

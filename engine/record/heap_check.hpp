// A check of HDF5's "global heaps", which hold strings of variable length (h5py's str). They are the one structure of
// its current format without a checksum, and HDF5 trusts the lengths in them. A flipped bit would crash the reader.
//
// What is a heap is HDF5's to say, not a signature's: the same bytes may stand in any input, name or number. HDF5 reads
// every text attribute of the file, through a file driver of its own; what it fetches as a heap is checked before HDF5
// sees it.
#pragma once

#include <string>
#include <string_view>

namespace verisim {

/// Throws hdf5::Failure if a heap that an attribute's texts lie in is inconsistent, or if objects or attributes cannot
/// be read. A file that its writer left open is taken as it is. Reads the file's structure and its texts, no dataset.
void check_text_heaps(const std::string& path);
/// The same of a file in memory.
void check_text_heaps_of(std::string_view bytes);

}  // namespace verisim

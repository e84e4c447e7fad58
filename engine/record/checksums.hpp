// Checksums of what a run file holds and no replay computes again: wall clock, program and machine, models as loaded,
// descriptions. They find what was changed afterwards, not a forger who makes them anew.
//
// The attribute `checksums` of "/" is text, a line each: 16 hex digits (XXH3-64), two spaces, what they are of. Every
// attribute of "/" and of /summary has its line, "attribute 'seed' of /"; every other object has one, its path: type,
// shape, attributes, and the values too unless they stand under /state, /cost or /events, which replay --verify
// compares one by one. How HDF5 stores it all (chunks, order, free space) is left out, and so is that attribute itself.
#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

namespace verisim {

inline constexpr const char* kChecksums = "checksums";

/// The text of an open file. Throws hdf5::Failure.
[[nodiscard]] std::string checksums_of(hid_t file);
/// Writes it, in place of a former one.
void write_checksums(hid_t file);

/// What is not as `stored` says: changed, added or missing, as lines name it.
[[nodiscard]] std::vector<std::string> altered(const std::string& stored, const std::string& now);

}  // namespace verisim

// The superblock of an HDF5 file: its state when the writing process ended.
#pragma once

#include <cstdint>
#include <string>

namespace verisim {

struct Superblock {
  bool left_open = false;         ///< by a writer that did not close it
  std::uint64_t end_address = 0;  ///< length of the file in bytes, as it records it
};

/// Looks at no more than the beginning; a file of holes, terabytes long, is refused.
/// Throws Error(input): not there, no plain file, empty, not HDF5, older than SWMR.
[[nodiscard]] Superblock read_superblock(const std::string& path);

/// A copy of a run file that was left open, closed, in the system's folder for such, until its end. For folders where
/// recover() may not write.
class ClosedCopy {
 public:
  /// As recover(), but for the place. Error(io) if there is no room for the copy.
  explicit ClosedCopy(const std::string& path);
  ~ClosedCopy();
  ClosedCopy(const ClosedCopy&) = delete;
  ClosedCopy& operator=(const ClosedCopy&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// False if the file's folder may not be written: nothing there can be replaced.
[[nodiscard]] bool can_be_replaced(const std::string& path);

}  // namespace verisim

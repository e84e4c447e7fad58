// Files that the user names, opened for reading: a plain file of a sensible size, or one line that says what it is
// instead. Opening never waits (a FIFO without a writer would) and touches no device. Whoever reads a file that a
// command line, a scenario or another file names opens it here, or has it looked at here first.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace verisim {

/// Which file it is, whatever its name: paths, hard links and symbolic links of one file have the same.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  bool operator==(const FileIdentity&) const = default;
};

/// Nothing if there is no such file. Links are followed.
[[nodiscard]] std::optional<FileIdentity> identity_of(const std::string& path);

/// "a folder", "a FIFO", "a device", "a socket"; empty for a plain file, and if there is none. Links are followed.
[[nodiscard]] std::string other_than_plain(const std::string& path);

/// The longest file that is read as a whole [bytes]: scripts, models, traces.
inline constexpr std::uint64_t kContentMax = std::uint64_t{2} << 30;

/// A plain file, open for reading.
class UserFile {
 public:
  /// `name` is what errors call it. Error(input): it is not there, no plain file, or may not be read.
  UserFile(const std::string& name, const std::string& path);
  ~UserFile();
  UserFile(const UserFile&) = delete;
  UserFile& operator=(const UserFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] FileIdentity identity() const { return identity_; }
  /// All of it. Error(input) if that is more than `size_max` bytes, or if it cannot be read.
  [[nodiscard]] std::string content(std::uint64_t size_max = kContentMax) const;
  /// Its first `size` bytes, or all if it has fewer. Error(input).
  [[nodiscard]] std::string beginning(std::size_t size) const;
  /// Bytes that the file system stores; the rest of size() are holes.
  [[nodiscard]] std::uint64_t stored_bytes() const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  FileIdentity identity_;
  [[nodiscard]] std::string read(std::size_t size_max) const;
};

}  // namespace verisim

// Files that are replaced in one step, and the mark by which a file says that a living process writes it.
// A reader sees the old file or the new one, never half of either, whenever the writer is killed.
#pragma once

#include <cstdint>
#include <string>

namespace verisim {

/// The system's word for the last failed call ("No space left on device").
[[nodiscard]] std::string system_cause();

/// Error(io): "PATH: cannot be written (CAUSE); …".
[[noreturn]] void refuse_write(const std::string& path, const std::string& cause);

/// A file beside `target` that takes its place at commit() and is removed if that never comes. A leftover of that name
/// from a killed process is overwritten.
class Replacement {
 public:
  /// `suffix` is added to the target's name: ".part".
  Replacement(std::string target, const std::string& suffix) : target_(std::move(target)), path_(target_ + suffix) {}
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Fills it with all bytes of the open file `descriptor`. Error(io).
  void copy_from(int descriptor) const;
  /// Fills it with `content`. Error(io).
  void write(const std::string& content) const;
  /// Takes the target's place. Error(io). Does nothing the second time.
  void commit();
  [[nodiscard]] bool committed() const { return committed_; }

 private:
  std::string target_, path_;
  bool committed_ = false;
};

/// An open file and this process's mark on it, which the system drops when the process ends, however it ends. Marks are
/// locks of the open file description: HDF5's own locks are of another kind and do not meet them, and a lock that is
/// only its own comes down to a shared one in a single step.
class MarkedFile {
 public:
  enum class Mark { writer, recovery };
  /// Opens the file, for `writer` makes it if it is not there, and marks it so that nobody else can. `descriptor()` is
  /// -1 if there is no such file, `refused()` if somebody else's mark stands in the way.
  MarkedFile(const std::string& path, Mark mark);
  ~MarkedFile();
  MarkedFile(const MarkedFile&) = delete;
  MarkedFile& operator=(const MarkedFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] bool refused() const { return refused_; }
  /// Is it still the file of that name? Its former owner may have renamed it before the mark was set.
  [[nodiscard]] bool is_at(const std::string& path) const;
  /// Lets readers lock the file as well, on file systems where all kinds of locks meet (NFS). Never fails.
  void share() const;

 private:
  int descriptor_ = -1;
  bool refused_ = false;
};

/// Room on the disk for a growing file, taken before it is needed: HDF5 does not survive a write that fails half way
/// (its lengths get ahead of its values), so a full disk must be met between its writes. Where the file system knows no
/// reserving, nothing is reserved.
class Reservation {
 public:
  explicit Reservation(const std::string& path);
  ~Reservation();  ///< gives back what the file did not need
  Reservation(const Reservation&) = delete;
  Reservation& operator=(const Reservation&) = delete;
  /// @pre step > 0
  /// Makes sure that the file can grow by `bytes`. Error(io). Usually one fstat; takes `step` more when it takes some.
  void ensure(std::uint64_t bytes, std::uint64_t step);

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;  ///< reserved up to here
};

/// Does a living process write (or recover) this file at this moment?
[[nodiscard]] bool is_being_written(const std::string& path);

}  // namespace verisim

// Atomic replacement of files, and a lock that marks a file as being written by a living process. A reader sees the old
// file or the new one, never a part, whenever the writer is killed.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.hpp"

namespace verisim {

/// The system's text for the last failed call ("No space left on device").
[[nodiscard]] std::string system_cause();

/// Error(io): "PATH: cannot be written (CAUSE); …".
[[noreturn]] void refuse_write(const std::string& path, const std::string& cause);

/// Copies all bytes of one open file into another. Error(io) naming `path`.
void copy_file(const std::string& path, int from, int to);

/// What another run is writing: Error(io), told apart so that a default name can be another.
class BeingWritten : public Error {
 public:
  explicit BeingWritten(const std::string& what) : Error(ErrorKind::io, what) {}
};

/// A file beside `target` that replaces it at commit(). It is removed if neither commit() nor keep() is called. A
/// leftover of a killed process is overwritten.
class Replacement {
 public:
  /// `suffix` is added to the target's name: ".part".
  Replacement(std::string target, const std::string& suffix) : target_(std::move(target)), path_(target_ + suffix) {}
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Copies all bytes of the open file `descriptor` into it. Error(io).
  void copy_from(int descriptor) const;
  /// Writes `content` into it. Error(io).
  void write(const std::string& content) const;
  /// Replaces the target. Error(io). A second call does nothing.
  void commit();
  /// Leaves the file where it is, under its own name: it holds what would else be lost. Nothing once it is committed.
  void keep() { kept_ = !committed_; }
  [[nodiscard]] bool is_kept() const { return kept_; }

 private:
  std::string target_, path_;
  bool committed_ = false, kept_ = false;
};

/// An open file and this process's mark on it. The system removes the mark when the process ends, however it ends. A
/// mark is a lock of the open file description. HDF5's own locks are of another kind and do not conflict with it, and
/// an exclusive lock becomes a shared one atomically.
class MarkedFile {
 public:
  enum class Mark { writer, recovery };
  /// Opens the file and marks it exclusively; a writer creates it if it does not exist. descriptor() is -1 if there is
  /// no such file; refused() is true if another process has a mark.
  MarkedFile(const std::string& path, Mark mark);
  ~MarkedFile();
  MarkedFile(const MarkedFile&) = delete;
  MarkedFile& operator=(const MarkedFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] bool refused() const { return refused_; }
  /// True if it is still the file of that name. Its former owner may have renamed it before the mark was set.
  [[nodiscard]] bool is_at(const std::string& path) const;
  /// Lets readers lock the file too, on file systems where all kinds of locks conflict (NFS). Never fails.
  void allow_readers() const;

 private:
  int descriptor_ = -1;
  bool refused_ = false;
};

/// Disk space reserved for a growing file in advance. HDF5 does not survive a write that fails half way (its lengths
/// get ahead of its values), so a full disk must be detected between writes. If the file system cannot reserve, nothing
/// is reserved.
class Reservation {
 public:
  explicit Reservation(const std::string& path);
  ~Reservation();  ///< gives back what the file did not need
  Reservation(const Reservation&) = delete;
  Reservation& operator=(const Reservation&) = delete;
  /// Ensures that the file can grow by `bytes`. Error(io). Usually one fstat; reserves in steps of `step`.
  /// @pre step > 0
  void ensure(std::uint64_t bytes, std::uint64_t step);

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;  ///< reserved up to here
};

/// True if a living process is writing (or recovering) this file.
[[nodiscard]] bool is_being_written(const std::string& path);

}  // namespace verisim

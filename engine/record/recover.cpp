#include "engine/record/recover.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/user_file.hpp"
#include "engine/record/checksums.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/heap_check.hpp"
#include "engine/record/object_walk.hpp"
#include "engine/record/run_columns.hpp"
#include "engine/record/run_writer.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

// HDF5 File Format Specification, II.A, version 3: signature (8 bytes), version, size of offsets, size of lengths,
// consistency flags, base address, extension address, end of file address (8 bytes each), …
constexpr std::array<char, 8> kFileSignature = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
constexpr std::size_t kVersionAt = 8, kFlagsAt = 11, kEndAt = 28, kSuperblockBytes = 48;

// A kill may come between the system's enlarging of the file and HDF5's note of it, or the other way round.
void cover_end_address(const std::string& path, std::uint64_t end_address) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return;
  const auto size = static_cast<std::uint64_t>(info.st_size);
  constexpr std::uint64_t kSlack = 64 << 20;  // far more than one flush adds: beyond it the number is damaged
  if (end_address <= size || end_address > size + kSlack) return;
  if (::truncate(path.c_str(), static_cast<off_t>(end_address)) != 0) {
    refuse_write(path, system_cause());
  }
}

Handle open_although_left_open(const std::string& path) {
  const Handle access = hdf5::file_access();
  // The property by which HDF5's own h5clear asks H5Fopen to forget the former writer.
  const hbool_t forget = true;
  check_status(H5Pset(access, "clear_status_flags", &forget), "recover");
  Handle file(check(H5Fopen(path.c_str(), H5F_ACC_RDWR, access), path.c_str()), H5Fclose);
  check_status(H5Fincrement_filesize(file, 0), "recover");  // what was written after the last note of the end counts
  return file;
}

void cut(hid_t file, const std::string& path, std::size_t rows, std::size_t width) {
  const hsize_t extent[2] = {rows, width};
  check_status(H5Dset_extent(hdf5::open_dataset(file, path), extent), path.c_str());
}

std::size_t cut_to_shortest(hid_t file) {
  const std::vector<StoredColumn> columns = read_columns(file);
  const StoredPairs pairs = read_pairs(file);
  const CompleteFrames frames(file, columns, pairs);  // all read before anything is cut
  for (const StoredColumn& stored : columns) {
    const std::size_t rows = frames.rows_of(stored.column);
    if (stored.rows != rows) cut(file, stored.column.path, rows, stored.column.width);
  }
  if (pairs.there && pairs.rows != frames.pairs()) cut(file, kPairsPath, frames.pairs(), 1);
  return frames.count();
}

std::uint64_t bytes_of(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

/// Closes `copy`, a copy of the run file `path` that was left open. Returns the number of rows kept.
std::size_t close_copy(const std::string& path, const std::string& copy, std::uint64_t end_address) {
  cover_end_address(copy, end_address);
  check_text_heaps(copy);
  Handle file = open_although_left_open(copy);
  check_objects(file, bytes_of(copy), SoftLinks::refused);
  check_is_run(path, file);
  const std::size_t rows = cut_to_shortest(file);
  write_checksums(file);
  check_status(H5Fclose(file.release()), path.c_str());
  return rows;
}

/// Error(input) if another process is still writing it.
void check_nobody_writes(const std::string& path, const MarkedFile& original) {
  if (original.refused())
    fail(ErrorKind::input, "{}: a running process is still writing it; wait until that ends", path);
}

/// Calls `work`; what HDF5 cannot read is a damaged file.
template <typename Work>
auto mending(const std::string& path, Work work) {
  const hdf5::Session session;
  try {
    return work();
  } catch (const hdf5::Failure& failure) {
    fail(ErrorKind::input, "{}: is damaged ({}); run the scenario again", path, failure.what());
  }
}

/// Error(io) if what stands where the closed copy is made is not the rest of a killed recovery.
void check_rest(const std::string& copy) {
  if (!identity_of(copy)) return;
  const std::string beginning = UserFile(copy, copy).beginning(kFileSignature.size());
  if (!beginning.empty() &&
      !std::equal(kFileSignature.begin(), kFileSignature.end(), beginning.begin(), beginning.end()))
    refuse_write(copy, "another file has this name");
}

/// A run file has a few holes where its writer had reserved room. A thousand times more of them than of values is none.
void check_holes(const std::string& path, const UserFile& file) {
  constexpr std::uint64_t kSmall = std::uint64_t{1} << 30;
  if (file.size() < kSmall || file.stored_bytes() >= file.size() / 1000) return;
  fail(ErrorKind::input, "{}: has {} bytes, nearly all of them holes: no run file is like that; run the scenario again",
       path, file.size());
}

}  // namespace

Superblock read_superblock(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    fail(ErrorKind::input, "{}: {}; name a run file", path,
         (error ? error : std::make_error_code(std::errc::no_such_file_or_directory)).message());
  const UserFile file(path, path);
  const std::string bytes = file.beginning(kSuperblockBytes);
  if (bytes.empty()) fail(ErrorKind::input, "{}: is empty; run the scenario again", path);
  if (!bytes.starts_with(std::string_view(kFileSignature.data(), kFileSignature.size()))) {
    fail(ErrorKind::input, "{}: is not an HDF5 file; name a file that 'verisim run' wrote", path);
  }
  if (bytes.size() < kSuperblockBytes) {
    fail(ErrorKind::input, "{}: ends after {} bytes; run the scenario again", path, bytes.size());
  }
  check_holes(path, file);
  Superblock superblock;
  if (bytes[kVersionAt] < 2) return superblock;  // older layout: never written by SWMR, no such flags
  superblock.left_open = bytes[kFlagsAt] != 0;
  std::memcpy(&superblock.end_address, &bytes[kEndAt], sizeof superblock.end_address);
  return superblock;
}

bool can_be_replaced(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return ::access(folder.empty() ? "." : folder.c_str(), W_OK) == 0;
}

ClosedCopy::ClosedCopy(const std::string& path) {
  const MarkedFile original(path, MarkedFile::Mark::recovery);
  check_nobody_writes(path, original);
  const Superblock superblock = read_superblock(path);
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) refuse_write("a copy of " + path, "the system's temporary folder: " + error.message());
  path_ = (folder / "verisim-XXXXXX").string();
  const int descriptor = ::mkostemp(path_.data(), O_CLOEXEC);
  if (descriptor < 0) refuse_write("a copy of " + path, path_ + ": " + system_cause());
  try {
    copy_file("a copy of " + path, original.descriptor(), descriptor);
    static_cast<void>(mending(path, [&] { return close_copy(path, path_, superblock.end_address); }));
  } catch (const Error&) {
    ::close(descriptor);
    ::unlink(path_.c_str());
    throw;
  }
  ::close(descriptor);
}

ClosedCopy::~ClosedCopy() {
  ::unlink(path_.c_str());
}

std::optional<std::size_t> recover(const std::string& named) {
  if (!read_superblock(named).left_open) {
    static_cast<void>(RunFile(named));
    return std::nullopt;
  }
  const std::string path = std::filesystem::canonical(named).string();  // of a link its end: that is to be replaced
  const MarkedFile original(path, MarkedFile::Mark::recovery);
  check_nobody_writes(path, original);
  const Superblock superblock = read_superblock(path);  // only now does nobody else change it
  if (!superblock.left_open) return std::nullopt;
  return mending(path, [&] {
    check_rest(path + ".recovering");
    Replacement closed(path, ".recovering");
    closed.copy_from(original.descriptor());
    const std::size_t rows = close_copy(path, closed.path(), superblock.end_address);
    closed.commit();
    return rows;
  });
}

}  // namespace verisim

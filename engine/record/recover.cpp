#include "engine/record/recover.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>

#include "engine/base/error.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/heap_check.hpp"
#include "engine/record/run_columns.hpp"

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

std::size_t cut_to_shortest(hid_t file) {
  const std::vector<StoredColumn> columns = read_columns(file);
  const std::size_t frames = frames_of(file, columns);
  std::vector<std::size_t> rows_wanted;  // before anything is cut: one column says how long another has to be
  for (const StoredColumn& stored : columns) rows_wanted.push_back(rows_of(file, columns, stored.column, frames));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const StoredColumn& stored = columns[i];
    const std::size_t rows = rows_wanted[i];
    if (stored.rows == rows) continue;
    const hsize_t extent[2] = {rows, stored.column.width};
    check_status(H5Dset_extent(hdf5::open_dataset(file, stored.column.path), extent), stored.column.path.c_str());
  }
  return frames;
}

}  // namespace

Superblock read_superblock(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) fail(ErrorKind::input, "{}: {}; name a run file", path, system_cause());
  if (!S_ISREG(info.st_mode)) fail(ErrorKind::input, "{}: is not a file; name a run file", path);
  std::array<char, kSuperblockBytes> bytes{};
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(ErrorKind::input, "{}: cannot be read ({}); check its permissions", path, system_cause());
  in.read(bytes.data(), bytes.size());
  if (in.gcount() == 0) fail(ErrorKind::input, "{}: is empty; run the scenario again", path);
  if (!std::equal(kFileSignature.begin(), kFileSignature.end(), bytes.begin())) {
    fail(ErrorKind::input, "{}: is not an HDF5 file; name a file that 'verisim run' wrote", path);
  }
  if (in.gcount() < static_cast<std::streamsize>(bytes.size())) {
    fail(ErrorKind::input, "{}: ends after {} bytes; run the scenario again", path, in.gcount());
  }
  Superblock superblock;
  if (bytes[kVersionAt] < 2) return superblock;  // older layout: never written by SWMR, no such flags
  superblock.left_open = bytes[kFlagsAt] != 0;
  std::memcpy(&superblock.end_address, &bytes[kEndAt], sizeof superblock.end_address);
  return superblock;
}

std::optional<std::size_t> recover(const std::string& path) {
  if (!read_superblock(path).left_open) {
    static_cast<void>(RunFile(path));
    return std::nullopt;
  }
  const MarkedFile original(path, MarkedFile::Mark::recovery);
  if (original.refused()) {
    fail(ErrorKind::input, "{}: a running process is still writing it; wait until that ends", path);
  }
  const Superblock superblock = read_superblock(path);  // only now does nobody else change it
  if (!superblock.left_open) return std::nullopt;
  const hdf5::Session session;
  try {
    Replacement closed(path, ".recovering");
    closed.copy_from(original.descriptor());
    cover_end_address(closed.path(), superblock.end_address);
    check_text_heaps(closed.path());
    Handle file = open_although_left_open(closed.path());
    check_is_run(path, file);
    const std::size_t rows = cut_to_shortest(file);
    check_status(H5Fclose(file.release()), path.c_str());
    closed.commit();
    return rows;
  } catch (const hdf5::Failure& failure) {
    fail(ErrorKind::input, "{}: is damaged ({}); run the scenario again", path, failure.what());
  }
}

}  // namespace verisim

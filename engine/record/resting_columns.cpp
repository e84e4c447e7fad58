#include "engine/record/resting_columns.hpp"

#include <algorithm>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/record/repeated_row.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

// Those of what may be written now and then are as those of other columns. The stored ones are larger, so that they are
// few, and small enough to fit into the cache of those who read row by row (1 MiB with h5py).
constexpr std::size_t kWrittenChunkRows = 256;
constexpr std::size_t kStoredChunkRows = 4096;
constexpr std::size_t kStoredStep = std::size_t{1} << 16;  // rows, of chunks that are stored at a time
constexpr std::size_t kLengthStep = std::size_t{1} << 20;  // rows; a file left open claims no more than that in vain
constexpr std::uint64_t kIndexPage = 4096;                 // bytes
constexpr std::size_t kRestBytesMax = 256;                 // so that a stored chunk is of 1 MiB at most
constexpr hsize_t kChunkBytesMax = hsize_t{1} << 20;

bool is_zero(const Column& column) {
  return std::all_of(column.rest.begin(), column.rest.end(), [](std::byte b) { return b == std::byte{0}; });
}

bool is_awake(const std::uint64_t* words, std::size_t part) {
  return (words[part / kPartsInWord] >> part % kPartsInWord & 1) != 0;
}

/// As many rows as are planned, or a step more than there are.
std::size_t length_for(std::size_t rows, std::size_t planned) {
  const std::size_t steps = (rows / kLengthStep + 1) * kLengthStep;
  return planned >= rows && planned > 0 ? std::min(planned, steps) : steps;
}

/// Whole chunks for so many rows, of a dataset of this length.
std::size_t stored_for(std::size_t rows, std::size_t length) {
  return (std::min(rows, length) + kStoredChunkRows - 1) / kStoredChunkRows * kStoredChunkRows;
}

}  // namespace

RestingColumns::RestingColumns(const Schema& schema, std::size_t rows_planned)
    : row_bytes_(schema.row_bytes()), length_(length_for(0, rows_planned)), stored_(stored_for(kStoredStep, length_)) {
  for (const Column& column : schema.columns()) {
    if (column.rest.empty()) continue;
    VERISIM_ASSERT(column.bytes() <= kRestBytesMax);
    words_ = std::max(words_, column.part / kPartsInWord + 1);
    const bool same_part = !columns_.empty() && columns_.back().column.part == column.part;
    part_bytes_ = (same_part ? part_bytes_ : 0) + column.bytes();
    part_bytes_max_ = std::max(part_bytes_max_, part_bytes_);
    if (!is_zero(column)) step_bytes_ += kStoredStep * column.bytes() / 64 + kIndexPage;  // deflated() makes less
    Resting resting;
    resting.column = column;
    columns_.push_back(std::move(resting));
  }
}

Handle RestingColumns::create(hid_t file, const Column& column, hid_t type) const {
  VERISIM_ASSERT(!column.rest.empty());
  const int rank = column.width == 1 ? 1 : 2;
  const hsize_t now[2] = {length_, column.width};
  const hsize_t max[2] = {H5S_UNLIMITED, column.width};
  const hsize_t chunk[2] = {is_zero(column) ? kWrittenChunkRows : kStoredChunkRows, column.width};
  const Handle space(check(H5Screate_simple(rank, now, max), "shape"), H5Sclose);
  const Handle creation(check(H5Pcreate(H5P_DATASET_CREATE), "dataset"), H5Pclose);
  check_status(H5Pset_chunk(creation, rank, chunk), "chunk");
  if (!is_zero(column)) check_status(H5Pset_deflate(creation, 1), "compression");
  Handle dataset = hdf5::create_dataset(file, column.path, type, space, creation);
  hdf5::write_attribute(dataset, kRests, std::int64_t{1});
  if (!is_zero(column)) store_chunks(dataset, column, 0, stored_);
  return dataset;
}

void RestingColumns::store_chunks(hid_t dataset, const Column& column, std::size_t from, std::size_t to) {
  const std::vector<std::byte> chunk = deflated(column.rest, kStoredChunkRows);
  for (std::size_t row = from; row < to; row += kStoredChunkRows) {
    const hsize_t start[2] = {row, 0};
    check_status(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, start, chunk.size(), chunk.data()), column.path.c_str());
  }
}

Handle RestingColumns::opened(const Column& column) const {
  VERISIM_ASSERT(file_ >= 0);
  const Handle access(check(H5Pcreate(H5P_DATASET_ACCESS), "access"), H5Pclose);
  check_status(H5Pset_chunk_cache(access, 7, 4 * kWrittenChunkRows * column.bytes(), 1.0), "cache");
  return {check(H5Dopen2(file_, column.path.c_str(), access), column.path.c_str()), H5Dclose};
}

// A whole chunk before their first row is: by then a later flush than their own has made them safe.
bool RestingColumns::chunks_are_due(std::size_t rows) const {
  return stored_ < length_ && stored_ < rows + kStoredChunkRows;
}

void RestingColumns::store_due_chunks(std::size_t rows) {
  const bool late = stored_ < rows;  // the run is longer than it was planned
  const std::size_t to = stored_for(stored_ + kStoredStep, length_);
  for (const Resting& resting : columns_) {
    if (is_zero(resting.column)) continue;
    const Handle dataset = opened(resting.column);
    store_chunks(dataset, resting.column, stored_, to);
    if (late) check_status(H5Dflush(dataset), resting.column.path.c_str());
  }
  stored_ = to;
}

void RestingColumns::lengthen(std::size_t rows) {
  if (rows <= length_) return;
  length_ = length_for(rows, 0);
  for (const Resting& resting : columns_) {
    const hsize_t now[2] = {length_, resting.column.width};
    check_status(H5Dset_extent(opened(resting.column), now), resting.column.path.c_str());
  }
}

std::uint64_t RestingColumns::room(std::size_t rows, std::size_t awake) const {
  constexpr std::uint64_t kColumnsInPart = 8;  // and more than there are
  const std::uint64_t written =
      awake * ((rows / kWrittenChunkRows + 2) * kWrittenChunkRows * part_bytes_max_ + kColumnsInPart * kIndexPage);
  return written + (chunks_are_due(rows_ + rows) ? step_bytes_ : 0);
}

void RestingColumns::append(const std::byte* rows, const std::uint64_t* awake, std::size_t count) {
  if (columns_.empty() || count == 0) return;
  lengthen(rows_ + count);
  while (chunks_are_due(rows_ + count)) store_due_chunks(rows_ + count);
  std::vector<std::uint64_t> ever(words_, 0);
  for (std::size_t i = 0; i < count * words_; ++i) ever[i % words_] |= awake[i];
  for (Resting& resting : columns_)
    if (is_awake(ever.data(), resting.column.part)) write_awake(resting, rows, awake, count);
  rows_ += count;
}

/// Of the rows those from the first to the last that say something else than at rest.
void RestingColumns::write_awake(Resting& resting, const std::byte* rows, const std::uint64_t* awake,
                                 std::size_t count) {
  const Column& column = resting.column;
  const std::size_t bytes = column.bytes();
  packed_.resize(count * bytes);
  std::size_t first = count, last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool at_rest = !is_awake(awake + i * words_, column.part);
    const std::byte* const value = at_rest ? column.rest.data() : rows + i * row_bytes_ + column.offset;
    std::memcpy(&packed_[i * bytes], value, bytes);
    if (at_rest || std::memcmp(value, column.rest.data(), bytes) == 0) continue;
    first = std::min(first, i);
    last = i;
  }
  if (first == count) return;
  if (resting.dataset < 0) {
    resting.dataset = opened(column);
    resting.type = Handle(check(H5Dget_type(resting.dataset), "type"), H5Tclose);
  }
  const int rank = column.width == 1 ? 1 : 2;
  const hsize_t start[2] = {rows_ + first, 0};
  const hsize_t block[2] = {last - first + 1, column.width};
  const Handle there(check(H5Dget_space(resting.dataset), "shape"), H5Sclose);
  check_status(H5Sselect_hyperslab(there, H5S_SELECT_SET, start, nullptr, block, nullptr), "rows");
  const Handle here(check(H5Screate_simple(rank, block, nullptr), "shape"), H5Sclose);
  check_status(H5Dwrite(resting.dataset, resting.type, here, there, H5P_DEFAULT, &packed_[first * bytes]),
               column.path.c_str());
  check_status(H5Dflush(resting.dataset), column.path.c_str());
}

void RestingColumns::cut(hid_t file) const {
  if (rows_ == length_) return;
  for (const Resting& resting : columns_) {
    const hsize_t now[2] = {rows_, resting.column.width};
    check_status(H5Dset_extent(hdf5::open_dataset(file, resting.column.path), now), resting.column.path.c_str());
  }
}

void RestingColumns::close() {
  for (Resting& resting : columns_) resting.dataset.reset();
}

void RestingColumns::release() {
  for (Resting& resting : columns_) resting.dataset.release();
}

void check_resting(hid_t dataset, const Column& column, std::size_t rows) {
  const Handle creation(check(H5Dget_create_plist(dataset), column.path.c_str()), H5Pclose);
  hsize_t chunk[2] = {0, 0};
  const int rank = column.width == 1 ? 1 : 2;
  if (H5Pget_layout(creation) != H5D_CHUNKED || H5Pget_chunk(creation, 2, chunk) != rank ||
      column.width > kRestBytesMax)
    throw hdf5::Failure(column.path + ": wrong shape");
  if (rank == 1) chunk[1] = 1;
  const hsize_t bytes = chunk[0] <= kChunkBytesMax ? chunk[0] * chunk[1] * size_of(column.dtype) : kChunkBytesMax + 1;
  if (chunk[0] == 0 || chunk[1] != column.width || bytes > kChunkBytesMax)
    throw hdf5::Failure(column.path + ": wrong chunks");
  if (H5Pget_nfilters(creation) == 0) return;
  for (hsize_t row = 0; row < rows; row += chunk[0]) {
    const hsize_t start[2] = {row, 0};
    hsize_t stored = 0;
    const herr_t there = H5Dget_chunk_storage_size(dataset, start, &stored);
    if (there < 0 || stored > bytes) throw hdf5::Failure(column.path + ": damaged chunks");
  }
}

}  // namespace verisim

#include "engine/record/run_writer.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/record/recover.hpp"
#include "engine/record/run_inputs.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

// A flush rewrites the last chunk of every column: small chunks keep that cheap (a flush comes every 50 rows).
constexpr hsize_t kChunkRows = 256;
constexpr hsize_t kChunkEvents = 64;
constexpr std::uint64_t kIndexBytes = 4096;
constexpr std::uint64_t kReserveStep = 16 << 20;

// Number or, for named u8 values, an HDF5 enum of the same byte: its memory type is its stored type.
Handle column_type(const Column& column) {
  if (column.enum_names.empty() || column.dtype != Dtype::u8) {
    return {check(H5Tcopy(hdf5::stored_type(column.dtype)), "type"), H5Tclose};
  }
  Handle type(check(H5Tenum_create(H5T_STD_U8LE), "enum"), H5Tclose);
  for (std::size_t i = 0; i < column.enum_names.size(); ++i) {
    const auto value = static_cast<std::uint8_t>(i);
    check_status(H5Tenum_insert(type, column.enum_names[i].c_str(), &value), "enum");
  }
  return type;
}

Handle growing_dataset(hid_t file, const std::string& path, hid_t type, hsize_t width, hsize_t chunk_rows) {
  const int rank = width == 1 ? 1 : 2;
  const hsize_t now[2] = {0, width};
  const hsize_t max[2] = {H5S_UNLIMITED, width};
  const hsize_t chunk[2] = {chunk_rows, width};
  const Handle space(check(H5Screate_simple(rank, now, max), "shape"), H5Sclose);
  const Handle creation(check(H5Pcreate(H5P_DATASET_CREATE), "dataset"), H5Pclose);
  check_status(H5Pset_chunk(creation, rank, chunk), "chunk");
  check_status(H5Pset_obj_track_times(creation, false), "times");
  const Handle links = hdf5::link_creation();
  return {check(H5Dcreate2(file, path.c_str(), type, space, links, creation, H5P_DEFAULT), path.c_str()), H5Dclose};
}

// Only the last chunk is ever written again: a small cache of its own for each dataset.
Handle open_growing(hid_t file, const std::string& path, std::size_t chunk_bytes) {
  const Handle access(check(H5Pcreate(H5P_DATASET_ACCESS), "access"), H5Pclose);
  check_status(H5Pset_chunk_cache(access, 7, 4 * chunk_bytes, 1.0), "cache");
  return {check(H5Dopen2(file, path.c_str(), access), path.c_str()), H5Dclose};
}

void append_values(hid_t dataset, hid_t type, hsize_t width, hsize_t before, hsize_t count, const void* values) {
  const int rank = width == 1 ? 1 : 2;
  const hsize_t total[2] = {before + count, width};
  const hsize_t start[2] = {before, 0};
  const hsize_t block[2] = {count, width};
  check_status(H5Dset_extent(dataset, total), "append");
  const Handle file_space(check(H5Screate_simple(rank, total, nullptr), "append"), H5Sclose);
  check_status(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start, nullptr, block, nullptr), "append");
  const Handle memory_space(check(H5Screate_simple(rank, block, nullptr), "append"), H5Sclose);
  check_status(H5Dwrite(dataset, type, memory_space, file_space, H5P_DEFAULT, values), "append");
}

void replace_attribute(hid_t object, const std::string& name, const Attribute& value) {
  if (hdf5::has_attribute(object, name)) check_status(H5Adelete(object, name.c_str()), name.c_str());
  hdf5::write_attribute(object, name, value);
}

// A file of this name that says it is open for writing, and whose writer lives. (A reader's mark is no writer's.)
bool is_live(const std::string& path) {
  try {
    return read_superblock(path).left_open && is_being_written(path);
  } catch (const Error&) {  // not there, or no run file: nobody's loss
    return false;
  }
}

[[noreturn]] void refuse_second_run(const std::string& path) {
  fail(ErrorKind::io, "{}: another run is writing it; choose another name or wait until that ends", path);
}

// The mark on PATH.part, which one run at a time can have. A run that has renamed its file is found by that name, and
// is looked for once nobody can rename to it any more.
std::unique_ptr<MarkedFile> claim(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) {
    fail(ErrorKind::io, "{}: is a folder; name a file in it", path);
  }
  const std::string part = path + ".part";
  for (;;) {
    auto mark = std::make_unique<MarkedFile>(part, MarkedFile::Mark::writer);
    if (mark->descriptor() < 0) refuse_write(path, system_cause());
    if (mark->refused()) refuse_second_run(path);
    if (mark->is_at(part)) return mark;
  }
}

}  // namespace

Handle event_type() {
  const auto text = [](std::size_t size) {
    Handle type(check(H5Tcopy(H5T_C_S1), "text"), H5Tclose);
    check_status(H5Tset_size(type, size), "text");
    check_status(H5Tset_cset(type, H5T_CSET_UTF8), "text");
    return type;
  };
  Handle type(check(H5Tcreate(H5T_COMPOUND, sizeof(StoredEvent)), "event"), H5Tclose);
  check_status(H5Tinsert(type, "time", HOFFSET(StoredEvent, time), H5T_IEEE_F64LE), "event");
  check_status(H5Tinsert(type, "kind", HOFFSET(StoredEvent, kind), text(sizeof(StoredEvent::kind))), "event");
  check_status(H5Tinsert(type, "text", HOFFSET(StoredEvent, text), text(sizeof(StoredEvent::text))), "event");
  return type;
}

// A file that the disk refused is left as it is: closing it would try again, and clear the mark that says "recover me"
// although not all of it was written.
template <typename Work>
void RunWriter::guard(Work work) {
  try {
    work();
  } catch (const hdf5::Failure& failure) {
    failed_ = true;
    refuse_write(path_, failure.what());
  } catch (const Error&) {
    failed_ = true;
    throw;
  }
}

RunWriter::RunWriter(const std::string& path, const Schema& schema, const RunHeader& header)
    : path_(path), mark_(claim(path)), part_(path, ".part"), schema_(schema) {
  if (is_live(path)) refuse_second_run(path);
  const hdf5::Session session;
  guard([&] {
    create(header);
    start_swmr();
    room_ = std::make_unique<Reservation>(part_.path());
    mark_->allow_readers();
  });
}

void RunWriter::create(const RunHeader& header) {
  const Handle file(
      check(H5Fcreate(part_.path().c_str(), H5F_ACC_TRUNC, hdf5::file_creation(), hdf5::file_access()), path_.c_str()),
      H5Fclose);
  hdf5::write_attribute(file, "format", std::string(kRunFormat));
  hdf5::write_attribute(file, "format_version", kRunFormatVersion);
  hdf5::write_attribute(file, "columns", static_cast<std::int64_t>(schema_.columns().size()));
  for (const auto& [name, value] : header.attributes) replace_attribute(file, name, value);
  write_inputs(file, header.files, header.models);
  static_cast<void>(hdf5::create_group(file, "/summary"));
  std::int64_t order = 0;
  for (const Column& column : schema_.columns()) {
    const Handle type = column_type(column);
    const Handle dataset = growing_dataset(file, column.path, type, column.width, kChunkRows);
    hdf5::write_attribute(dataset, "units", column.units);
    hdf5::write_attribute(dataset, "description", column.description);
    hdf5::write_attribute(dataset, "order", order++);
    if (!column.enum_names.empty()) hdf5::write_attribute(dataset, "names", column.enum_names);
    if (!column.due.empty()) hdf5::write_attribute(dataset, "rows_where", column.due);
  }
  const Handle events = growing_dataset(file, "/events", event_type(), 1, kChunkEvents);
  hdf5::write_attribute(events, "units", std::string("s, 1, 1"));
  hdf5::write_attribute(events, "description", std::string("What happened: simulated time, kind, text"));
  check_status(H5Fflush(file, H5F_SCOPE_LOCAL), path_.c_str());
}

void RunWriter::start_swmr() {
  file_ = Handle(
      check(H5Fopen(part_.path().c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, hdf5::file_access()), path_.c_str()),
      H5Fclose);
  for (const Column& column : schema_.columns()) {
    columns_.push_back({.column = column,
                        .type = column_type(column),
                        .dataset = open_growing(file_, column.path, kChunkRows * column.bytes()),
                        .due = due_offset(column)});
  }
  event_type_ = event_type();
  event_dataset_ = open_growing(file_, "/events", kChunkEvents * sizeof(StoredEvent));
}

RunWriter::~RunWriter() {
  const hdf5::Session session;
  if (failed_) {
    for (Stored& stored : columns_) stored.dataset.release();
    event_dataset_.release();
    file_.release();
  }
  try {
    close_handles();
  } catch (const hdf5::Failure&) {  // left as a kill would leave it
  }
}

void RunWriter::close_handles() {
  columns_.clear();
  event_dataset_.reset();
  event_type_.reset();
  if (file_ >= 0) check_status(H5Fclose(file_.release()), path_.c_str());
}

void RunWriter::reserve(std::size_t rows, std::size_t events) {
  // A new chunk and a page of its index for every column, though most of them need none.
  const std::uint64_t chunks = rows / kChunkRows + 2;
  const std::uint64_t event_chunks = events / kChunkEvents + 2;
  const std::uint64_t bytes = chunks * kChunkRows * schema_.row_bytes() +
                              event_chunks * kChunkEvents * sizeof(StoredEvent) + (columns_.size() + 8) * kIndexBytes;
  room_->ensure(bytes, kReserveStep);
}

void RunWriter::append(const std::byte* rows, std::size_t count) {
  VERISIM_ASSERT(rows != nullptr || count == 0);
  const hdf5::Session session;
  guard([&] {
    for (Stored& stored : columns_) {
      const std::size_t packed = pack(stored, rows, count);
      if (packed == 0) continue;
      append_values(stored.dataset, stored.type, stored.column.width, stored.rows, packed, packed_.data());
      stored.rows += packed;
    }
  });
  has_rows_ = has_rows_ || count > 0;
}

std::optional<std::size_t> RunWriter::due_offset(const Column& column) const {
  if (column.due.empty()) return {};
  for (const Column& other : schema_.columns())
    if (other.path == column.due && other.dtype == Dtype::u32 && other.width == 1) return other.offset;
  VERISIM_ASSERT(!"a column's due is another column of its schema");
  return {};
}

// The values of one column, one after the other. Returns how many of the rows have one.
std::size_t RunWriter::pack(const Stored& stored, const std::byte* rows, std::size_t count) {
  const std::size_t bytes = stored.column.bytes();
  packed_.resize(std::max(packed_.size(), count * bytes));
  std::size_t packed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* row = rows + i * schema_.row_bytes();
    std::uint32_t due = 1;
    if (stored.due) std::memcpy(&due, row + *stored.due, sizeof due);
    if (due != 0) std::memcpy(&packed_[packed++ * bytes], row + stored.column.offset, bytes);
  }
  return packed;
}

void RunWriter::append(const StoredEvent* events, std::size_t count) {
  VERISIM_ASSERT(events != nullptr || count == 0);
  const hdf5::Session session;
  guard([&] { append_values(event_dataset_, event_type_, 1, events_, count, events); });
  events_ += count;
}

void RunWriter::flush() {
  const hdf5::Session session;
  guard([&] {
    check_status(H5Fflush(file_, H5F_SCOPE_LOCAL), path_.c_str());
    if (has_rows_) part_.commit();
  });
}

void RunWriter::close(const std::map<std::string, Attribute>& summary, const std::map<std::string, Attribute>& root) {
  const hdf5::Session session;
  guard([&] {
    close_handles();
    room_.reset();  // the copy may need it
    Replacement finished(path_, ".closing");
    finished.copy_from(mark_->descriptor());
    {
      const Handle file(check(H5Fopen(finished.path().c_str(), H5F_ACC_RDWR, hdf5::file_access()), path_.c_str()),
                        H5Fclose);
      for (const auto& [name, value] : root) replace_attribute(file, name, value);
      const Handle group = hdf5::open_group(file, "/summary");
      for (const auto& [name, value] : summary) replace_attribute(group, name, value);
      check_status(H5Fflush(file, H5F_SCOPE_LOCAL), path_.c_str());
    }
    finished.commit();
  });
}

}  // namespace verisim

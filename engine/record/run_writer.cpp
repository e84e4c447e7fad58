#include "engine/record/run_writer.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <exception>

#include "engine/base/error.hpp"
#include "engine/record/checksums.hpp"
#include "engine/record/recover.hpp"
#include "engine/record/run_inputs.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

// A flush rewrites the last chunk of every column: small chunks keep that cheap (a flush comes every 50 rows).
constexpr hsize_t kChunkRows = 256;
constexpr hsize_t kChunkTableRows = 1024;
constexpr hsize_t kChunkPairs = 64;
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
  return hdf5::create_dataset(file, path, type, space, creation);
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
  throw BeingWritten(fmt::format("{}: another run is writing it; choose another name or wait until that ends", path));
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

namespace {

// The longest beginning of `text` that fits and does not end inside a UTF-8 character.
std::size_t fitting_length(std::string_view text, std::size_t room) {
  if (text.size() <= room) return text.size();
  std::size_t length = room;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;
  return length;
}

template <std::size_t N>
void store(char (&to)[N], std::string_view text) {
  text.copy(to, fitting_length(text, N - 1));
}

Handle fixed_text(std::size_t size) {
  Handle type(check(H5Tcopy(H5T_C_S1), "text"), H5Tclose);
  check_status(H5Tset_size(type, size), "text");
  check_status(H5Tset_cset(type, H5T_CSET_UTF8), "text");
  return type;
}

}  // namespace

StoredEvent stored_event(double time, std::string_view kind, std::string_view text) {
  StoredEvent event;
  event.time = time;
  store(event.kind, kind);
  store(event.text, text);
  return event;
}

Handle event_type() {
  Handle type(check(H5Tcreate(H5T_COMPOUND, sizeof(StoredEvent)), "event"), H5Tclose);
  check_status(H5Tinsert(type, "time", HOFFSET(StoredEvent, time), H5T_IEEE_F64LE), "event");
  check_status(H5Tinsert(type, "kind", HOFFSET(StoredEvent, kind), fixed_text(sizeof(StoredEvent::kind))), "event");
  check_status(H5Tinsert(type, "text", HOFFSET(StoredEvent, text), fixed_text(sizeof(StoredEvent::text))), "event");
  return type;
}

Handle pair_type(std::size_t length) {
  Handle type(check(H5Tcreate(H5T_COMPOUND, 2 * length), "pair"), H5Tclose);
  const Handle text = fixed_text(length);
  check_status(H5Tinsert(type, "first", 0, text), "pair");
  check_status(H5Tinsert(type, "second", length, text), "pair");
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
    if (has_rows_) part_.keep();
    refuse_write(part_.is_kept() ? part_.path() : path_, failure.what());
  } catch (const Error&) {
    failed_ = true;
    if (has_rows_) part_.keep();
    throw;
  }
}

RunWriter::RunWriter(const std::string& path, const Schema& schema, const RunHeader& header, std::size_t rows_planned)
    : path_(path), mark_(claim(path)), part_(path, ".part"), schema_(schema), resting_(schema, rows_planned) {
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
  const Handle file = hdf5::create_file(part_.path());
  hdf5::write_attribute(file, "format", std::string(kRunFormat));
  hdf5::write_attribute(file, "format_version", kRunFormatVersion);
  hdf5::write_attribute(file, "columns", static_cast<std::int64_t>(schema_.columns().size() + schema_.table().size()));
  for (const auto& [name, value] : header.attributes) replace_attribute(file, name, value);
  write_inputs(file, header.files, header.models);
  static_cast<void>(hdf5::create_group(file, "/summary"));
  std::int64_t order = 0;
  const auto add = [&](const Column& column, hsize_t chunk_rows) {
    const Handle type = column_type(column);
    const Handle dataset = column.rest.empty() ? growing_dataset(file, column.path, type, column.width, chunk_rows)
                                               : resting_.create(file, column, type);
    hdf5::write_attribute(dataset, "units", column.units);
    hdf5::write_attribute(dataset, "description", column.description);
    hdf5::write_attribute(dataset, "order", order++);
    if (!column.enum_names.empty()) hdf5::write_attribute(dataset, "names", column.enum_names);
    if (!column.due.empty()) hdf5::write_attribute(dataset, "rows_where", column.due);
    if (!column.rows_in_frame.empty()) hdf5::write_attribute(dataset, "rows_in_frame", column.rows_in_frame);
  };
  for (const Column& column : schema_.columns()) add(column, kChunkRows);
  for (const Column& column : schema_.table()) add(column, kChunkTableRows);
  const Handle events = growing_dataset(file, "/events", event_type(), 1, kChunkEvents);
  hdf5::write_attribute(events, "units", std::string("s, 1, 1"));
  hdf5::write_attribute(events, "description", std::string("What happened: simulated time, kind, text"));
  if (!schema_.pairs_in_frame.empty()) {
    const Handle pairs = growing_dataset(file, kPairsPath, pair_type(name_length()), 1, kChunkPairs);
    hdf5::write_attribute(pairs, "units", std::string("1, 1"));
    hdf5::write_attribute(pairs, "description",
                          std::string("Pairs of bodies that came near each other, in the order in which they did"));
    hdf5::write_attribute(pairs, "rows_in_frame", schema_.pairs_in_frame);
  }
  check_status(H5Fflush(file, H5F_SCOPE_LOCAL), path_.c_str());
}

std::size_t RunWriter::name_length() const {
  std::size_t longest = 0;
  for (const std::string& name : schema_.bodies) longest = std::max(longest, name.size());
  return longest + 1;
}

void RunWriter::start_swmr() {
  file_ = Handle(
      check(H5Fopen(part_.path().c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, hdf5::writer_access()), path_.c_str()),
      H5Fclose);
  const auto open = [&](const Column& column, hsize_t chunk_rows) {
    Stored stored;
    stored.column = column;
    stored.type = column_type(column);
    stored.dataset = open_growing(file_, column.path, chunk_rows * column.bytes());
    stored.due = due_offset(column);
    return stored;
  };
  for (const Column& column : schema_.columns())
    if (column.rest.empty()) columns_.push_back(open(column, kChunkRows));
  resting_.use(file_);
  for (const Column& column : schema_.table()) table_.push_back(open(column, kChunkTableRows));
  events_.type = event_type();
  events_.dataset = open_growing(file_, "/events", kChunkEvents * sizeof(StoredEvent));
  if (schema_.pairs_in_frame.empty()) return;
  pairs_.type = pair_type(name_length());
  pairs_.dataset = open_growing(file_, kPairsPath, kChunkPairs * 2 * name_length());
}

std::vector<RunWriter::Growing*> RunWriter::growing() {
  std::vector<Growing*> all = {&events_, &pairs_};
  for (Stored& stored : columns_) all.push_back(&stored);
  for (Stored& stored : table_) all.push_back(&stored);
  return all;
}

RunWriter::~RunWriter() {
  try {  // ended by an exception: whole but for what only a full run has
    if (!failed_ && has_rows_ && file_ >= 0) close({}, {});
  } catch (const std::exception&) {  // of any kind, out of memory among them: then it is left as a kill would leave it
  }
  try {
    const hdf5::Session session;
    if (failed_) {
      for (Growing* growing : growing()) growing->dataset.release();
      resting_.release();
      file_.release();
    }
    close_handles();
  } catch (const std::exception&) {  // left as a kill would leave it
  }
}

void RunWriter::close_handles() {
  for (Growing* growing : growing()) growing->dataset.reset();
  resting_.close();
  if (file_ >= 0) check_status(H5Fclose(file_.release()), path_.c_str());
}

void RunWriter::reserve(const Amount& amount) {
  // A new chunk and a page of its index for every column, though most of them need none.
  const std::uint64_t chunks = amount.rows / kChunkRows + 2;
  const std::uint64_t table_chunks = amount.table_rows / kChunkTableRows + 2;
  const std::uint64_t event_chunks = amount.events / kChunkEvents + 2;
  const std::uint64_t pair_chunks = amount.pairs / kChunkPairs + 2;
  const std::uint64_t bytes =
      chunks * kChunkRows * (schema_.row_bytes() - schema_.rest_bytes()) + resting_.room(amount.rows, amount.awake) +
      table_chunks * kChunkTableRows * schema_.table_row_bytes() + event_chunks * kChunkEvents * sizeof(StoredEvent) +
      pair_chunks * kChunkPairs * 2 * name_length() + (columns_.size() + table_.size() + 8) * kIndexBytes;
  room_->ensure(bytes, kReserveStep);
}

void RunWriter::append_packed(std::vector<Stored>& columns, const std::byte* rows, std::size_t count,
                              std::size_t row_bytes) {
  VERISIM_ASSERT(rows != nullptr || count == 0);
  const hdf5::Session session;
  guard([&] {
    for (Stored& stored : columns) {
      const std::size_t packed = pack(stored, rows, count, row_bytes);
      if (packed == 0) continue;
      append_values(stored.dataset, stored.type, stored.column.width, stored.rows, packed, packed_.data());
      stored.rows += packed;
    }
  });
}

void RunWriter::append(const std::byte* rows, const std::uint64_t* awake, std::size_t count) {
  {
    const hdf5::Session session;
    guard([&] { resting_.append(rows, awake, count); });  // before the others, so that no frame is without it
  }
  append_packed(columns_, rows, count, schema_.row_bytes());
  has_rows_ = has_rows_ || count > 0;
}

void RunWriter::append_to_table(const std::byte* rows, std::size_t count) {
  append_packed(table_, rows, count, schema_.table_row_bytes());
}

std::optional<std::size_t> RunWriter::due_offset(const Column& column) const {
  if (column.due.empty()) return {};
  for (const Column& other : schema_.columns())
    if (other.path == column.due && other.dtype == Dtype::u32 && other.width == 1) return other.offset;
  VERISIM_ASSERT(!"a column's due is another column of its schema");
  return {};
}

// The values of one column, one after the other. Returns how many of the rows have one.
std::size_t RunWriter::pack(const Stored& stored, const std::byte* rows, std::size_t count, std::size_t row_bytes) {
  const std::size_t bytes = stored.column.bytes();
  packed_.resize(std::max(packed_.size(), count * bytes));
  std::size_t packed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* row = rows + i * row_bytes;
    std::uint32_t due = 1;
    if (stored.due) std::memcpy(&due, row + *stored.due, sizeof due);
    if (due != 0) std::memcpy(&packed_[packed++ * bytes], row + stored.column.offset, bytes);
  }
  return packed;
}

void RunWriter::append(const StoredEvent* events, std::size_t count) {
  VERISIM_ASSERT(events != nullptr || count == 0);
  const hdf5::Session session;
  guard([&] { append_values(events_.dataset, events_.type, 1, events_.rows, count, events); });
  events_.rows += count;
}

void RunWriter::append(const BodyPair* pairs, std::size_t count) {
  VERISIM_ASSERT(pairs != nullptr || count == 0);
  if (count == 0) return;
  const hdf5::Session session;
  const std::size_t length = name_length();
  std::vector<char> texts(count * 2 * length, '\0');
  for (std::size_t i = 0; i < count; ++i) {
    schema_.bodies[pairs[i].first].copy(&texts[2 * i * length], length - 1);
    schema_.bodies[pairs[i].second].copy(&texts[(2 * i + 1) * length], length - 1);
  }
  guard([&] { append_values(pairs_.dataset, pairs_.type, 1, pairs_.rows, count, texts.data()); });
  pairs_.rows += count;
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
      resting_.cut(file);
      for (const auto& [name, value] : root) replace_attribute(file, name, value);
      const Handle group = hdf5::open_group(file, "/summary");
      for (const auto& [name, value] : summary) replace_attribute(group, name, value);
      write_checksums(file);
      check_status(H5Fflush(file, H5F_SCOPE_LOCAL), path_.c_str());
    }
    finished.commit();
  });
}

}  // namespace verisim

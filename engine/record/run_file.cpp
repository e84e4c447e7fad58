#include "engine/record/run_file.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/record/checksums.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/heap_check.hpp"
#include "engine/record/object_walk.hpp"
#include "engine/record/recover.hpp"
#include "engine/record/resting_columns.hpp"
#include "engine/record/run_columns.hpp"
#include "engine/record/run_inputs.hpp"
#include "engine/record/run_writer.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

template <std::size_t N>
std::string text_of(const char (&bytes)[N]) {
  return std::string(bytes, std::find(bytes, bytes + N, '\0'));
}

}  // namespace

struct RunFile::Implementation {
  std::string path;
  bool recovered = false;
  std::unique_ptr<ClosedCopy> copy;  ///< read in place of the file, if that was left open and cannot be closed there
  Handle file;
  RunHeader header;
  std::map<std::string, Attribute> summary;
  Schema schema;
  std::int64_t format_version = 0;
  std::optional<CompleteFrames> frames;

  ~Implementation() {
    const hdf5::Session session;
    file.reset();
  }

  /// Calls `work` with HDF5 at hand; what HDF5 cannot read is a damaged file.
  template <typename Work>
  auto reading(Work work) const {
    const hdf5::Session session;
    try {
      return work();
    } catch (const hdf5::Failure& failure) {
      fail(ErrorKind::input, "{}: is damaged ({}); run the scenario again", path, failure.what());
    }
  }

  void open() {
    const std::string from = copy ? copy->path() : path;
    check_text_heaps(from);
    file = Handle(check(H5Fopen(from.c_str(), H5F_ACC_RDONLY, hdf5::reader_access()), path.c_str()), H5Fclose);
    check_objects(file, std::filesystem::file_size(from), SoftLinks::refused);
    check_is_run(path, file);
    header.attributes = hdf5::read_attributes(file);
    header.files = read_input_files(file);
    header.models = read_input_models(file);
    summary = hdf5::read_attributes(hdf5::open_group(file, "/summary"));
    format_version = hdf5::read_integer(file, "format_version");
    const std::vector<StoredColumn> columns = read_columns(file);
    frames.emplace(file, columns, read_pairs(file));
    for (const StoredColumn& stored : columns) schema.add(stored.column);
  }
};

RunFile::RunFile(const std::string& path) : implementation_(std::make_unique<Implementation>()) {
  implementation_->path = path;
  if (read_superblock(path).left_open) {
    if (can_be_replaced(path))
      static_cast<void>(recover(path));
    else
      implementation_->copy = std::make_unique<ClosedCopy>(path);
    implementation_->recovered = true;
  }
  implementation_->reading([&] { implementation_->open(); });
}

RunFile::~RunFile() = default;
RunFile::RunFile(RunFile&&) noexcept = default;

const RunHeader& RunFile::header() const {
  return implementation_->header;
}
const std::map<std::string, Attribute>& RunFile::summary() const {
  return implementation_->summary;
}
const Schema& RunFile::schema() const {
  return implementation_->schema;
}
std::size_t RunFile::rows() const {
  return implementation_->frames->count();
}
std::int64_t RunFile::format_version() const {
  return implementation_->format_version;
}
bool RunFile::recovered() const {
  return implementation_->recovered;
}

bool RunFile::closed_in_place() const {
  return implementation_->copy == nullptr;
}

std::vector<std::byte> RunFile::column(const Column& column) const {
  return implementation_->reading([&] {
    const Handle dataset = hdf5::open_dataset(implementation_->file, column.path);
    const Handle type(check(H5Dget_type(dataset), "type"), H5Tclose);
    const Handle space(check(H5Dget_space(dataset), "shape"), H5Sclose);
    const std::size_t rows = implementation_->frames->rows_of(column);
    const hsize_t start[2] = {0, 0};
    const hsize_t block[2] = {rows, column.width};
    if (hdf5::has_attribute(dataset, kRests)) check_resting(dataset, column, rows);
    std::vector<std::byte> values(rows * column.bytes());
    if (values.empty()) return values;
    const Handle memory(check(H5Screate_simple(column.width == 1 ? 1 : 2, block, nullptr), "shape"), H5Sclose);
    check_status(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, block, nullptr), "rows");
    const bool named = H5Tget_class(type) == H5T_ENUM;  // an enum's bytes are read as they are stored
    const hid_t wanted = named ? static_cast<hid_t>(type) : hdf5::memory_type(column.dtype);
    check_status(H5Dread(dataset, wanted, memory, space, H5P_DEFAULT, values.data()), column.path.c_str());
    return values;
  });
}

std::vector<std::pair<std::string, std::string>> RunFile::pairs() const {
  return implementation_->reading([&] {
    std::vector<std::pair<std::string, std::string>> names;
    const StoredPairs stored = read_pairs(implementation_->file);
    if (!stored.there || stored.rows == 0) return names;
    const Handle dataset = hdf5::open_dataset(implementation_->file, kPairsPath);
    const Handle type(check(H5Dget_type(dataset), "type"), H5Tclose);
    const std::size_t length = H5Tget_size(type) / 2;
    std::vector<char> texts(stored.rows * 2 * length);
    check_status(H5Dread(dataset, pair_type(length), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), kPairsPath);
    const auto text_at = [&](std::size_t i) {
      const char* const begin = &texts[i * length];
      return std::string(begin, std::find(begin, begin + length, '\0'));
    };
    for (std::size_t i = 0; i < implementation_->frames->pairs(); ++i)
      names.emplace_back(text_at(2 * i), text_at(2 * i + 1));
    return names;
  });
}

std::vector<std::string> RunFile::altered() const {
  const auto stored = header().attributes.find(kChecksums);
  if (stored == header().attributes.end() || !std::holds_alternative<std::string>(stored->second))
    return {fmt::format("attribute '{}' of /: is missing", kChecksums)};
  const std::string now = implementation_->reading([&] { return checksums_of(implementation_->file); });
  return verisim::altered(std::get<std::string>(stored->second), now);
}

Event as_stored(const Event& event) {
  const StoredEvent stored = stored_event(event.time, event.kind, event.text);
  return {stored.time, text_of(stored.kind), text_of(stored.text)};
}

std::vector<Event> RunFile::events() const {
  return implementation_->reading([&] {
    const Handle dataset = hdf5::open_dataset(implementation_->file, "/events");
    const hdf5::Shape shape = hdf5::checked_shape(dataset, sizeof(StoredEvent));
    if (shape.size() != 1) throw hdf5::Failure("/events: wrong shape");
    std::vector<StoredEvent> stored(shape[0]);
    if (!stored.empty()) {
      check_status(H5Dread(dataset, event_type(), H5S_ALL, H5S_ALL, H5P_DEFAULT, stored.data()), "/events");
    }
    std::vector<Event> events;
    for (const StoredEvent& e : stored) events.push_back({e.time, text_of(e.kind), text_of(e.text)});
    return events;
  });
}

}  // namespace verisim

#include "engine/record/run_columns.hpp"

#include <algorithm>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/resting_columns.hpp"
#include "engine/record/run_writer.hpp"

namespace verisim {
namespace {

using hdf5::Handle;

/// The column that says which frames add rows to this one; empty: every frame adds one.
const std::string& counter_of(const Column& column) {
  return column.rows_in_frame.empty() ? column.due : column.rows_in_frame;
}

Dtype number_type(hid_t dataset) {
  const Handle type(hdf5::check(H5Dget_type(dataset), "type"), H5Tclose);
  if (H5Tget_class(type) != H5T_ENUM) return hdf5::dtype_of_stored(type);
  return hdf5::dtype_of_stored(Handle(hdf5::check(H5Tget_super(type), "enum"), H5Tclose));
}

StoredColumn read_column(hid_t dataset, const std::string& path) {
  StoredColumn stored;
  Column& column = stored.column;
  column.path = path;
  column.dtype = number_type(dataset);
  stored.rests = hdf5::has_attribute(dataset, kRests);
  const hdf5::Shape shape =
      stored.rests ? hdf5::unchecked_shape(dataset) : hdf5::checked_shape(dataset, size_of(column.dtype));
  if (shape.empty() || shape.size() > 2 || (shape.size() == 2 && shape[1] == 0))
    throw hdf5::Failure(path + ": wrong shape");
  stored.rows = shape[0];
  column.width = shape.size() == 2 ? shape[1] : 1;
  column.units = hdf5::read_string(dataset, "units");
  column.description = hdf5::read_string(dataset, "description");
  if (hdf5::has_attribute(dataset, "names")) column.enum_names = hdf5::read_strings(dataset, "names");
  if (hdf5::has_attribute(dataset, "rows_where")) column.due = hdf5::read_string(dataset, "rows_where");
  if (hdf5::has_attribute(dataset, "rows_in_frame")) column.rows_in_frame = hdf5::read_string(dataset, "rows_in_frame");
  return stored;
}

void collect(hid_t group, const std::string& prefix, std::vector<std::pair<std::int64_t, StoredColumn>>& found) {
  for (const std::string& name : hdf5::children(group)) {
    const std::string path = prefix + "/" + name;
    if (path == "/inputs" || path == "/summary" || path == "/events" || path == kPairsPath) continue;
    const Handle object(hdf5::check(H5Oopen(group, name.c_str(), H5P_DEFAULT), path.c_str()), H5Oclose);
    if (H5Iget_type(object) == H5I_GROUP) {
      collect(object, path, found);
    } else if (H5Iget_type(object) == H5I_DATASET) {
      found.emplace_back(hdf5::read_integer(object, "order"), read_column(object, path));
    }
  }
}

/// The first `frames` values of a column that counts what each frame adds to another.
std::vector<std::uint32_t> read_counts(hid_t file, const std::vector<StoredColumn>& columns, const std::string& path,
                                       std::size_t frames) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const StoredColumn& other) { return other.column.path == path; });
  if (found == columns.end() || found->column.dtype != Dtype::u32 || found->column.width != 1 ||
      !counter_of(found->column).empty() || found->rows < frames)
    throw hdf5::Failure(path + ": does not say which frames rows belong to");
  std::vector<std::uint32_t> counts(frames);
  if (frames == 0) return counts;
  const Handle dataset = hdf5::open_dataset(file, path);
  const Handle space(hdf5::check(H5Dget_space(dataset), "shape"), H5Sclose);
  const hsize_t start = 0;
  const hsize_t count = frames;
  const Handle memory(hdf5::check(H5Screate_simple(1, &count, nullptr), "shape"), H5Sclose);
  hdf5::check_status(H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, nullptr, &count, nullptr), "rows");
  hdf5::check_status(H5Dread(dataset, hdf5::memory_type(Dtype::u32), memory, space, H5P_DEFAULT, counts.data()),
                     path.c_str());
  return counts;
}

/// How many of the frames have all of their rows: `added` says how many rows a count stands for.
template <typename Added>
std::size_t frames_with_rows(const std::vector<std::uint32_t>& counts, std::size_t frames, std::size_t stored,
                             Added added) {
  std::size_t rows = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    rows += added(counts[frame]);
    if (rows > stored) return frame;
  }
  return frames;
}

std::size_t one_where_due(std::uint32_t count) {
  return count != 0 ? 1 : 0;
}
std::size_t as_many(std::uint32_t count) {
  return count;
}

template <typename Added>
std::size_t sum_of(const std::vector<std::uint32_t>& counts, std::size_t frames, Added added) {
  std::size_t rows = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) rows += added(counts[frame]);
  return rows;
}

/// The state of a row is one run of bytes: Schema relies on it.
void check_order(const std::vector<StoredColumn>& columns) {
  bool state = true;
  bool table = false;
  for (const StoredColumn& stored : columns) {
    const std::string& path = stored.column.path;
    const bool in_table = !stored.column.rows_in_frame.empty();
    if (table && !in_table) throw hdf5::Failure(path + ": stands behind the table");
    table = in_table;
    if (table) continue;
    const bool is_state = path.starts_with("/state/") && path != "/state/hash";
    if (is_state && !state) throw hdf5::Failure(path + ": stands behind columns that are not state");
    state = is_state;
  }
}

}  // namespace

std::vector<StoredColumn> read_columns(hid_t file) {
  std::vector<std::pair<std::int64_t, StoredColumn>> found;
  collect(file, "", found);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<StoredColumn> columns;
  for (auto& [order, stored] : found) {
    if (order != static_cast<std::int64_t>(columns.size())) break;
    columns.push_back(std::move(stored));
  }
  const std::int64_t promised = hdf5::read_integer(file, "columns");
  if (static_cast<std::int64_t>(columns.size()) != promised || columns.size() != found.size()) {
    throw hdf5::Failure("of " + std::to_string(promised) + " columns " + std::to_string(found.size()) + " are there");
  }
  check_order(columns);
  return columns;
}

StoredPairs read_pairs(hid_t file) {
  StoredPairs pairs;
  if (!hdf5::exists(hdf5::open_group(file, "/state"), "pairs")) return pairs;
  const Handle dataset = hdf5::open_dataset(file, kPairsPath);
  const Handle type(hdf5::check(H5Dget_type(dataset), "type"), H5Tclose);
  const hdf5::Shape shape = hdf5::checked_shape(dataset, std::max<std::size_t>(1, H5Tget_size(type)));
  if (shape.size() != 1) throw hdf5::Failure("/state/pairs: wrong shape");
  return {true, hdf5::read_string(dataset, "rows_in_frame"), shape[0]};
}

CompleteFrames::CompleteFrames(hid_t file, const std::vector<StoredColumn>& columns, const StoredPairs& pairs) {
  std::optional<std::size_t> frames;
  for (const StoredColumn& stored : columns)  // what claims more than it stores says nothing of how many there are
    if (counter_of(stored.column).empty() && !stored.rests)
      frames = std::min(frames.value_or(stored.rows), stored.rows);
  count_ = frames.value_or(0);
  for (const StoredColumn& stored : columns)
    if (stored.rests) count_ = std::min(count_, stored.rows);
  for (const StoredColumn& stored : columns) {
    const Column& column = stored.column;
    if (!column.rows_in_frame.empty())
      count_ = frames_with_rows(counts(file, columns, column.rows_in_frame), count_, stored.rows, as_many);
    else if (!column.due.empty())
      count_ = frames_with_rows(counts(file, columns, column.due), count_, stored.rows, one_where_due);
  }
  if (!pairs.there) return;
  const std::vector<std::uint32_t>& met = counts(file, columns, pairs.pairs_in_frame);
  count_ = frames_with_rows(met, count_, pairs.rows, as_many);
  pairs_ = sum_of(met, count_, as_many);
}

const std::vector<std::uint32_t>& CompleteFrames::counts(hid_t file, const std::vector<StoredColumn>& columns,
                                                         const std::string& path) {
  const auto [at, is_new] = counts_.try_emplace(path);
  if (is_new) at->second = read_counts(file, columns, path, count_);
  return at->second;
}

std::size_t CompleteFrames::rows_of(const Column& column) const {
  if (counter_of(column).empty()) return count_;
  const auto found = counts_.find(counter_of(column));
  VERISIM_ASSERT(found != counts_.end());
  return column.rows_in_frame.empty() ? sum_of(found->second, count_, one_where_due)
                                      : sum_of(found->second, count_, as_many);
}

void check_is_run(const std::string& path, hid_t file) {
  if (!hdf5::has_attribute(file, "format") ||
      hdf5::read_attribute(file, "format") != Attribute(std::string(kRunFormat))) {
    fail(ErrorKind::input, "{}: is an HDF5 file but no run of verisim; name a file that 'verisim run' wrote", path);
  }
  const std::int64_t version = hdf5::read_integer(file, "format_version");
  if (version > kRunFormatVersion) {
    fail(ErrorKind::input, "{}: was written by a later verisim (format {}, this one reads up to {}); update this one",
         path, version, kRunFormatVersion);
  }
}

}  // namespace verisim

#include "engine/cli/stored_run.hpp"

#include <algorithm>
#include <cstring>

#include "engine/base/error.hpp"

namespace verisim::cli {
namespace {

constexpr std::size_t kNoRow = static_cast<std::size_t>(-1);

std::string hex(const std::byte* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = size; i-- > 0;) text += fmt::format("{:02x}", static_cast<unsigned>(bytes[i]));
  return text;
}

std::string describe(std::size_t frame, const std::string& path, const Column& column, const std::byte* stored,
                     const std::byte* simulated) {
  const std::size_t size = size_of(column.dtype);
  std::size_t i = 0;
  while (std::memcmp(stored + i * size, simulated + i * size, size) == 0) ++i;
  const std::string index = column.width > 1 ? fmt::format("[{}]", i) : "";
  return fmt::format("frame {}, {}{}: stored {}, simulated {}", frame, path, index, hex(stored + i * size, size),
                     hex(simulated + i * size, size));
}

/// Where the values of each frame lie in a column to which not every frame adds a row.
std::vector<std::size_t> rows_of_frames(const Column& column, const Schema& simulated, const RunFile& file) {
  std::vector<std::size_t> rows;
  for (const Column& due : simulated.columns()) {
    if (column.due.empty() || due.path != column.due) continue;
    const std::vector<std::byte> counts = file.column(due);
    std::size_t next = 0;
    for (std::size_t at = 0; at < counts.size(); at += sizeof(std::uint32_t)) {
      std::uint32_t count = 0;
      std::memcpy(&count, &counts[at], sizeof count);
      rows.push_back(count != 0 ? next++ : kNoRow);
    }
  }
  return rows;
}

}  // namespace

StoredRun::StoredRun(const RunFile& file, const Simulation& simulation)
    : is_format_1_(file.format_version() < 2), pairs_(file.pairs()) {
  simulation.describe(simulated_);
  read_rows(file);
  if (is_format_1_) read_dense_links(file);
}

const Column* StoredRun::stored_column(const RunFile& file, const Column& column) const {
  for (const auto* columns : {&file.schema().columns(), &file.schema().table()})
    for (const Column& stored : *columns)
      if (stored.path == column.path) {
        if (stored.dtype != column.dtype || stored.width != column.width)
          fail(ErrorKind::check_failed, "{}: has another shape in the run file", column.path);
        return &stored;
      }
  fail(ErrorKind::check_failed, "{}: is in the simulation and not in the run file", column.path);
}

void StoredRun::read_rows(const RunFile& file) {
  for (const Column& column : simulated_.columns()) {
    const bool comparable = column.path.starts_with("/state/") && column.path != "/state/hash";
    if (is_format_1_ && !comparable) continue;
    rows_.push_back({column, file.column(*stored_column(file, column)), rows_of_frames(column, simulated_, file)});
  }
  if (is_format_1_) return;
  for (const Column& column : simulated_.table())
    table_.push_back({column, file.column(*stored_column(file, column)), {}});
}

void StoredRun::read_dense_links(const RunFile& file) {
  for (const Column& stored : file.schema().columns()) {
    const std::string prefix = "/state/link/";
    if (!stored.path.starts_with(prefix)) continue;
    const std::size_t slash = stored.path.rfind('/');
    const std::string fact = "/state/links/" + stored.path.substr(slash + 1);
    for (const Column& column : simulated_.table())
      if (column.path == fact && column.dtype == stored.dtype && column.width == stored.width)
        dense_.push_back({column, stored.path.substr(prefix.size(), slash - prefix.size()), file.column(stored)});
  }
}

std::string StoredRun::pair_name(const BodyPair& pair) const {
  return simulated_.bodies[pair.first] + "~" + simulated_.bodies[pair.second];
}

std::string StoredRun::difference_in_frame(std::size_t frame, std::span<const std::byte> row,
                                           const Simulation& simulation) {
  for (const Stored& s : rows_) {
    const std::size_t stored_row = s.row_of_frame.empty() ? frame : s.row_of_frame[frame];
    if (stored_row == kNoRow) continue;
    const std::byte* simulated = row.data() + s.column.offset;
    const std::byte* stored = s.bytes.data() + stored_row * s.column.bytes();
    if (std::memcmp(simulated, stored, s.column.bytes()) != 0)
      return describe(frame, s.column.path, s.column, stored, simulated);
  }
  return is_format_1_ ? difference_in_dense_links(frame, simulation) : difference_in_table(frame, simulation);
}

std::string StoredRun::difference_in_table(std::size_t frame, const Simulation& simulation) {
  const std::span<const std::byte> simulated = simulation.table_rows();
  const std::size_t row_bytes = simulated_.table_row_bytes();
  for (std::size_t at = 0; at < simulated.size(); at += row_bytes, ++table_row_) {
    for (const Stored& s : table_) {
      const std::size_t bytes = s.column.bytes();
      const std::byte* value = simulated.data() + at + s.column.offset;
      if ((table_row_ + 1) * bytes > s.bytes.size()) return fmt::format("{}: rows are missing", s.column.path);
      const std::byte* stored = s.bytes.data() + table_row_ * bytes;
      if (std::memcmp(value, stored, bytes) == 0) continue;
      return describe(frame, fmt::format("{}, row {}", s.column.path, table_row_), s.column, stored, value);
    }
  }
  return {};
}

std::string StoredRun::difference_in_dense_links(std::size_t frame, const Simulation& simulation) const {
  const std::vector<std::byte> nothing(sizeof(double) * 8, std::byte{0});
  const std::span<const std::byte> rows = simulation.table_rows();
  const Column& pair = *std::find_if(simulated_.table().begin(), simulated_.table().end(),
                                     [](const Column& column) { return column.path == "/state/links/pair"; });
  std::map<std::string, const std::byte*> row_of_pair;
  for (std::size_t at = 0; at < rows.size(); at += simulated_.table_row_bytes()) {
    std::uint32_t number = 0;
    std::memcpy(&number, rows.data() + at + pair.offset, sizeof number);
    row_of_pair[pair_name(simulation.pairs()[number])] = rows.data() + at;
  }
  for (const DenseColumn& dense : dense_) {
    const auto row = row_of_pair.find(dense.pair);
    const std::byte* simulated = row == row_of_pair.end() ? nothing.data() : row->second + dense.column.offset;
    const std::byte* stored = dense.bytes.data() + frame * dense.column.bytes();
    if (std::memcmp(simulated, stored, dense.column.bytes()) != 0)
      return describe(frame, fmt::format("{} of {}", dense.column.path, dense.pair), dense.column, stored, simulated);
  }
  return {};
}

std::string StoredRun::difference_in_pairs(const Simulation& simulation) const {
  if (is_format_1_) return {};
  const std::vector<BodyPair>& met = simulation.pairs();
  for (std::size_t i = 0; i < std::max(met.size(), pairs_.size()); ++i) {
    const std::string stored = i < pairs_.size() ? pairs_[i].first + "~" + pairs_[i].second : "nothing";
    const std::string simulated = i < met.size() ? pair_name(met[i]) : "nothing";
    if (stored != simulated) return fmt::format("/state/pairs, row {}: stored {}, simulated {}", i, stored, simulated);
  }
  return {};
}

}  // namespace verisim::cli

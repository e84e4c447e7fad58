#include "engine/compare/first_difference.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::compare {
namespace {

bool is_state(const Column& column) {
  return column.path.starts_with("/state/") && column.path != "/state/hash";
}

const Column* find(const std::vector<Column>& columns, const std::string& path) {
  const auto found =
      std::find_if(columns.begin(), columns.end(), [&](const Column& column) { return column.path == path; });
  return found == columns.end() ? nullptr : &*found;
}

template <typename T>
std::string number_at(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return fmt::format("{}", value);
}

std::string value_at(Dtype dtype, const std::byte* at) {
  switch (dtype) {
    case Dtype::f64:
      return number_at<double>(at);
    case Dtype::f32:
      return number_at<float>(at);
    case Dtype::u64:
      return number_at<std::uint64_t>(at);
    case Dtype::u32:
      return number_at<std::uint32_t>(at);
    case Dtype::u16:
      return number_at<std::uint16_t>(at);
    case Dtype::u8:
      return number_at<std::uint8_t>(at);
    case Dtype::i32:
      return number_at<std::int32_t>(at);
    case Dtype::i8:
      return number_at<std::int8_t>(at);
  }
  return "";
}

/// Frame of each row of a column that not every frame adds to. Empty: every frame has one.
std::vector<std::size_t> frames_of_rows(const RunFile& file, const Column& column) {
  std::vector<std::size_t> frames;
  const std::string& counts_path = column.due.empty() ? column.rows_in_frame : column.due;
  const Column* const counts = counts_path.empty() ? nullptr : find(file.schema().columns(), counts_path);
  if (counts == nullptr) return frames;
  const std::vector<std::byte> bytes = file.column(*counts);
  for (std::size_t frame = 0; (frame + 1) * sizeof(std::uint32_t) <= bytes.size(); ++frame) {
    std::uint32_t count = 0;
    std::memcpy(&count, &bytes[frame * sizeof count], sizeof count);
    frames.insert(frames.end(), column.due.empty() ? count : std::min<std::uint32_t>(count, 1), frame);
  }
  return frames;
}

struct Place {
  std::size_t frame = 0;
  std::string text;
};

/// Where a dataset that both have differs first.
std::optional<Place> difference_in(const RunFile& a, const RunFile& b, const Column& of_a, const Column& of_b) {
  if (of_a.dtype != of_b.dtype || of_a.width != of_b.width)
    return Place{0, fmt::format("{}: has another shape", of_a.path)};
  const std::vector<std::byte> bytes_a = a.column(of_a), bytes_b = b.column(of_b);
  const std::size_t common = std::min(bytes_a.size(), bytes_b.size());
  const auto differs =
      std::mismatch(bytes_a.begin(), bytes_a.begin() + static_cast<std::ptrdiff_t>(common), bytes_b.begin()).first;
  const auto at = static_cast<std::size_t>(differs - bytes_a.begin());
  const bool is_of_frames = of_a.due.empty() && of_a.rows_in_frame.empty();
  // Where one run only ends earlier its frames differ in number, which is said elsewhere.
  if (at == common && (is_of_frames || bytes_a.size() == bytes_b.size())) return {};
  const std::size_t row = at / of_a.bytes();
  std::vector<std::size_t> frames = frames_of_rows(a, of_a);
  if (row >= frames.size() && !is_of_frames) frames = frames_of_rows(b, of_b);
  const std::size_t frame = is_of_frames ? row : row < frames.size() ? frames[row] : 0;
  if (at == common) {
    if (frame >= std::min(a.rows(), b.rows())) return {};
    return Place{frame, fmt::format("{}: row {} is only in {}", of_a.path, row, bytes_a.size() > common ? "A" : "B")};
  }
  const std::size_t size = size_of(of_a.dtype), value = at / size;
  const std::string index = of_a.width > 1 ? fmt::format("[{}]", value % of_a.width) : "";
  return Place{frame,
               fmt::format("{}{}: {} in A, {} in B", of_a.path, index, value_at(of_a.dtype, &bytes_a[value * size]),
                           value_at(of_b.dtype, &bytes_b[value * size]))};
}

}  // namespace

StateDifference state_difference(const RunFile& a, const RunFile& b) {
  StateDifference difference;
  std::optional<Place> first;
  for (const auto& list : {&Schema::columns, &Schema::table}) {
    const std::vector<Column>&of_a = (a.schema().*list)(), &of_b = (b.schema().*list)();
    for (const Column& column : of_a) {
      if (!is_state(column)) continue;
      const Column* const other = find(of_b, column.path);
      if (other == nullptr) {
        difference.only_a.push_back(column.path);
        continue;
      }
      const std::optional<Place> place = difference_in(a, b, column, *other);
      if (place && (!first || place->frame < first->frame)) first = place;
    }
    for (const Column& column : of_b)
      if (is_state(column) && find(of_a, column.path) == nullptr) difference.only_b.push_back(column.path);
  }
  if (first) difference.first = fmt::format("frame {}, {}", first->frame, first->text);
  return difference;
}

}  // namespace verisim::compare

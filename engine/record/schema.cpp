#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

void Schema::add(Column column) {
  VERISIM_ASSERT(column.path.starts_with('/'));
  VERISIM_ASSERT(column.width > 0);
  if (!paths_.insert(column.path).second) {
    fail(ErrorKind::input, "'{}' would be stored twice; give every body and device a name of its own", column.path);
  }
  if (!column.rows_in_frame.empty()) {
    column.offset = table_row_bytes_;
    table_row_bytes_ += column.bytes();
    table_.push_back(std::move(column));
    return;
  }
  column.offset = row_bytes_;
  row_bytes_ += column.bytes();
  if (!column.rest.empty()) {
    VERISIM_ASSERT(column.rest.size() == column.bytes() && column.part != Column::kNoPart);
    rest_bytes_ += column.bytes();
  }
  if (column.path.starts_with("/state/") && column.path != "/state/hash") {
    VERISIM_ASSERT(state_bytes_ == column.offset);  // /state first: the state of a row is one run of bytes
    state_bytes_ = row_bytes_;
  }
  columns_.push_back(std::move(column));
}

std::vector<ByteRange> Schema::without_rest() const {
  std::vector<ByteRange> ranges;
  for (const Column& column : columns_) {
    if (!column.rest.empty()) continue;
    if (ranges.empty() || ranges.back().offset + ranges.back().bytes != column.offset)
      ranges.push_back({column.offset, 0});
    ranges.back().bytes += column.bytes();
  }
  return ranges;
}

}  // namespace verisim

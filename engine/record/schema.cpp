#include "engine/base/error.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

std::size_t Schema::add(Column column) {
  VERISIM_ASSERT(column.path.starts_with('/'));
  VERISIM_ASSERT(column.width > 0);
  for (const Column& other : columns_) {
    if (other.path == column.path) {
      fail(ErrorKind::input, "'{}' would be stored twice; give every body, device and link a name of its own",
           column.path);
    }
  }
  column.offset = row_bytes_;
  row_bytes_ += column.bytes();
  if (column.path.starts_with("/state/") && column.path != "/state/hash") {
    VERISIM_ASSERT(state_bytes_ == column.offset);  // /state first: the state of a row is one run of bytes
    state_bytes_ = row_bytes_;
  }
  columns_.push_back(std::move(column));
  return columns_.size() - 1;
}

}  // namespace verisim

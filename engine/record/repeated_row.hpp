// The zlib stream (RFC 1950, 1951) of one row that is repeated: made in the time that a row takes, however often that
// is, and the same bytes with every version of zlib.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace verisim {

/// What inflates to `row`, `times` times. About 2 bytes for 258. @pre a row of 1 to 32768 bytes; times > 0
[[nodiscard]] std::vector<std::byte> deflated(std::span<const std::byte> row, std::size_t times);

}  // namespace verisim

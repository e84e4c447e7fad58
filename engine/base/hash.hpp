// Hashes: XXH3 (64 bit) for state and look-up, SHA-256 for the identity of input files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace verisim {

/// XXH3-64 of `size` bytes with a seed. The same on every machine of one byte order.
[[nodiscard]] std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed);
/// The same, by the widest vectors of this CPU: for rows of kilobytes. hash_bytes calls it where that is faster.
[[nodiscard]] std::uint64_t hash_long_bytes(const void* data, std::size_t size, std::uint64_t seed);

/// SHA-256 as 64 lower-case hex digits.
[[nodiscard]] std::string sha256(std::string_view content);

/// 16 lower-case hex digits, as state_hash is written everywhere.
[[nodiscard]] std::string to_hex(std::uint64_t value);

}  // namespace verisim

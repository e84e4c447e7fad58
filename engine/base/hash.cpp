#include "engine/base/hash.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace verisim {
namespace {

constexpr std::size_t kLong = 4096;  // bytes; below, a call by way of a table costs what wider vectors save

}  // namespace

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed) {
  return size < kLong ? XXH3_64bits_withSeed(data, size, seed) : hash_long_bytes(data, size, seed);
}

std::string sha256(std::string_view content) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(), digest);
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::string to_hex(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

}  // namespace verisim

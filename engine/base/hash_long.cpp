// Apart from hash.cpp: the library's own choice of vector width does not go together with its inlined functions.
#include <xxh_x86dispatch.h>
#include <xxhash.h>

#include "engine/base/hash.hpp"

namespace verisim {

std::uint64_t hash_long_bytes(const void* data, std::size_t size, std::uint64_t seed) {
  static const bool has_avx = __builtin_cpu_supports("avx") != 0;
  const std::uint64_t hash = XXH3_64bits_withSeed(data, size, seed);  // by the header's macro that of the CPU
  // libxxhash 0.8.1 leaves the upper halves of the vector registers dirty: all that follows costs an eighth more.
  if (has_avx) asm volatile("vzeroupper");
  return hash;
}

}  // namespace verisim

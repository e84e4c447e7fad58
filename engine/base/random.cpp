#include "engine/base/random.hpp"

#include <cmath>

#include "engine/base/hash.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

constexpr std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
constexpr std::uint64_t kNormalHalf = std::uint64_t{1} << 63;

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name)
    : key_(mix(seed * kGolden + hash_bytes(name.data(), name.size(), 0))) {}

std::uint64_t RandomStream::bits(std::uint64_t counter) const {
  return mix(key_ + mix(counter + kGolden) * kGolden);
}

double RandomStream::uniform(std::uint64_t counter) const {
  return static_cast<double>(bits(counter) >> 11) * 0x1p-53;
}

double RandomStream::normal(std::uint64_t counter) const {
  const double u = 1 - uniform(kNormalHalf + 2 * counter);  // (0, 1]: the logarithm stays finite
  const double v = uniform(kNormalHalf + 2 * counter + 1);
  return std::sqrt(-2 * pinned::log(u)) * pinned::cos(2 * pinned::kPi * v);
}

}  // namespace verisim

// Random numbers of a simulation: counter-based streams, each named, all derived from the run's one seed.
//
// A value depends on (seed, name, counter) alone, never on what was drawn before: a stream can be added, left out or
// drawn in another order without changing any other (DESIGN rule 1). The generator is SplitMix64's finalizer
// (Steele, Lea, Flood 2014) over a keyed counter.
#pragma once

#include <cstdint>
#include <string_view>

namespace verisim {

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  [[nodiscard]] std::uint64_t bits(std::uint64_t counter) const;
  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] double uniform(std::uint64_t counter) const;
  /// Standard normal (Box-Muller with pinned functions); uses counters 2c and 2c + 1 of its own half of the stream.
  [[nodiscard]] double normal(std::uint64_t counter) const;

 private:
  std::uint64_t key_;
};

}  // namespace verisim

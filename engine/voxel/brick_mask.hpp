// A set of cells of one brick: 512 bits, bit x + 8 y of word z. Also used for 8 x 8 x 8 bricks of a larger cube.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "engine/voxel/voxmap.hpp"

namespace verisim {

using BrickMask = std::array<std::uint64_t, kBrickSide>;

inline constexpr std::uint64_t kEveryByte = 0x0101010101010101;

/// The cells of `more` too.
inline void add(BrickMask& mask, const BrickMask& more) {
  for (std::size_t z = 0; z < mask.size(); ++z) mask[z] |= more[z];
}

[[nodiscard]] inline bool any(const BrickMask& mask) {
  std::uint64_t bits = 0;
  for (const std::uint64_t word : mask) bits |= word;
  return bits != 0;
}

[[nodiscard]] inline int count(const BrickMask& mask) {
  int n = 0;
  for (const std::uint64_t word : mask) n += std::popcount(word);
  return n;
}

[[nodiscard]] inline bool contains(const BrickMask& mask, int x, int y, int z) {
  return (mask[static_cast<std::size_t>(z)] >> (x + 8 * y) & 1) != 0;
}

/// Calls visit(x, y, z) for every cell of the set, z slowest, x fastest.
template <class Visit>
void for_each_cell(const BrickMask& mask, Visit visit) {
  for (int z = 0; z < kBrickSide; ++z) {
    for (std::uint64_t word = mask[static_cast<std::size_t>(z)]; word != 0; word &= word - 1) {
      const int bit = std::countr_zero(word);
      visit(bit & 7, bit >> 3, z);
    }
  }
}

/// The set and its 26 neighbours within the brick: Chebyshev distance at most one.
[[nodiscard]] inline BrickMask dilated(const BrickMask& mask) {
  constexpr std::uint64_t kNotFirst = 0xFE * kEveryByte;  // all but x = 0
  constexpr std::uint64_t kNotLast = 0x7F * kEveryByte;   // all but x = 7
  BrickMask flat;
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t row = mask[z] | (mask[z] << 1 & kNotFirst) | (mask[z] >> 1 & kNotLast);
    flat[z] = row | row << 8 | row >> 8;
  }
  BrickMask result;
  for (std::size_t z = 0; z < 8; ++z) {
    result[z] = flat[z] | (z > 0 ? flat[z - 1] : 0) | (z < 7 ? flat[z + 1] : 0);
  }
  return result;
}

}  // namespace verisim

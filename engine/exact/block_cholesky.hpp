// Cholesky factors of a sparse symmetric positive definite matrix of 6 x 6 blocks: one row of blocks per body, a block
// off the diagonal per pair of bodies that touch. Source: George and Liu, "Computer Solution of Large Sparse Positive
// Definite Systems", 1981 (minimum degree; the pattern of a column is what is left of its neighbours when it goes).
//
// The order of elimination, and with it every sum, depends on the pairs alone: of the bodies with the fewest neighbours
// left the one with the lowest number goes first. No threads, no vector width enters the result (block_kernels.hpp).
//
// Use: begin(bodies), join(…) for every pair, analyze(); then for any number of matrices of that pattern clear(),
// diagonal(…) and off_diagonal(…) to be added to, factor(), solve(…). No allocation but in reserve().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim::exact {

class BlockCholesky {
 public:
  /// A 6 x 6 block; column c begins at 6 c.
  using Block = std::array<double, 36>;

  /// Room for so many bodies, and for so many blocks of the factor below its diagonal. Never less than before.
  /// Memory: bodies^2 / 8 bytes and 290 bytes per block.
  void reserve(std::size_t bodies, std::size_t blocks);
  [[nodiscard]] std::size_t bodies_max() const { return bodies_max_; }
  [[nodiscard]] std::size_t blocks_max() const { return values_.capacity(); }

  /// Begins a pattern without any pair. @pre bodies <= bodies_max()
  void begin(std::size_t bodies);
  /// @pre both are below `bodies` and not the same; a pair may be joined again
  void join(std::size_t a, std::size_t b);
  /// Finds the order of elimination and the pattern of the factor. False if that has more than blocks_max() blocks: no
  /// matrix can be factored then. About bodies^2 / 64 and 10 ns per block.
  [[nodiscard]] bool analyze();
  [[nodiscard]] std::size_t blocks_needed() const { return blocks_needed_; }  ///< by the last analyze()

  // After an analyze() that gave true.
  void clear();  ///< the matrix of zeros
  /// The block of a body with itself: only its lower triangle is read.
  [[nodiscard]] Block& diagonal(std::size_t body) { return diagonal_[place_[body]]; }
  /// The block of two bodies that were joined. Its rows are of the one that is eliminated later: see is_later.
  [[nodiscard]] Block& off_diagonal(std::size_t a, std::size_t b);
  [[nodiscard]] bool is_later(std::size_t a, std::size_t b) const { return place_[a] > place_[b]; }
  /// Replaces the matrix by its factor. @pre it is positive definite
  void factor();
  /// Solves for x in place of the right side: six numbers per body. @pre factor() was called since clear()
  void solve(std::span<double> x) const;

 private:
  [[nodiscard]] std::size_t find(std::size_t column, std::uint32_t row) const;
  void eliminate(std::size_t body);

  std::size_t bodies_max_ = 0, bodies_ = 0, words_ = 0, blocks_needed_ = 0;
  std::vector<std::uint64_t> neighbours_;  ///< (bodies, words): bit set of those that are not eliminated yet
  std::vector<std::uint32_t> degree_;      ///< of bodies: how many bits
  std::vector<std::uint32_t> place_;       ///< of bodies: when they are eliminated
  std::vector<std::uint32_t> order_;       ///< the bodies in that order
  // The factor by columns, in the order of elimination; blocks of a column below the diagonal by ascending rows.
  std::vector<std::uint32_t> begin_;   ///< (bodies + 1)
  std::vector<std::uint32_t> row_;     ///< of each block: the place of its row
  std::vector<Block> values_;          ///< of each block
  std::vector<Block> diagonal_;        ///< by place; after factor(): pivots inverted
  mutable std::vector<double> right_;  ///< (6 bodies) of solve, by place
};

}  // namespace verisim::exact

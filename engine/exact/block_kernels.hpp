// The loops of BlockCholesky over the numbers of its blocks: factor and triangular solves, with the widest vectors that
// the processor has. A vector holds several rows of one column of a block, and each row is computed as it would be
// alone: the bits do not depend on the width. No fused multiply-add. Private to this folder.
#pragma once

#include <cstddef>
#include <cstdint>

namespace verisim::exact {

/// The pattern of a sparse lower triangle of 6 x 6 blocks by columns, as in BlockCholesky. A block's column c begins at
/// 6 c of its 36 numbers.
struct BlockPattern {
  std::size_t columns;
  const std::uint32_t* begin;  ///< (columns + 1): of each column, where its blocks below the diagonal begin
  const std::uint32_t* row;    ///< of each of these blocks, ascending in a column
};

/// Replaces a matrix by its factor, the pivots inverted. @pre it is positive definite, and the pattern that of the
/// factor
/// @param values    (36) of each block below the diagonal
/// @param diagonal  (36) of each column
void factor_blocks(const BlockPattern& pattern, double* values, double* diagonal);

/// Solves L L^T x = b in place of b (6 numbers of each column). @pre factor_blocks was called
void solve_blocks(const BlockPattern& pattern, const double* values, const double* diagonal, double* b);

}  // namespace verisim::exact

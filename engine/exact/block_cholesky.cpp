#include "engine/exact/block_cholesky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::exact {
namespace {

using Block = BlockCholesky::Block;
constexpr std::size_t kBits = 64;
constexpr std::uint32_t kEliminated = static_cast<std::uint32_t>(-1);

/// A = L L^T in place of the lower triangle; the diagonal of L is inverted.
void factor_diagonal(Block& A) {
  for (std::size_t j = 0; j < 6; ++j) {
    double pivot = A[6 * j + j];
    for (std::size_t k = 0; k < j; ++k) pivot -= A[6 * k + j] * A[6 * k + j];
    const double inverse = 1 / std::sqrt(pivot);
    for (std::size_t i = j + 1; i < 6; ++i) {
      double sum = A[6 * j + i];
      for (std::size_t k = 0; k < j; ++k) sum -= A[6 * k + i] * A[6 * k + j];
      A[6 * j + i] = sum * inverse;
    }
    A[6 * j + j] = inverse;
  }
}

/// B L^-T in place of B.
void divide(Block& B, const Block& L) {
  for (std::size_t j = 0; j < 6; ++j) {
    double* column = &B[6 * j];
    for (std::size_t k = 0; k < j; ++k)
      for (std::size_t i = 0; i < 6; ++i) column[i] -= L[6 * k + j] * B[6 * k + i];
    for (std::size_t i = 0; i < 6; ++i) column[i] *= L[6 * j + j];
  }
}

/// C - A B^T in place of C. Two columns at once, so that what is summed stays in registers.
void subtract_product(Block& C, const Block& A, const Block& B) {
  for (std::size_t j = 0; j < 6; j += 2) {
    double first[6];
    double second[6];
    for (std::size_t i = 0; i < 6; ++i) {
      first[i] = C[6 * j + i];
      second[i] = C[6 * j + 6 + i];
    }
    for (std::size_t k = 0; k < 6; ++k) {
      const double b = B[6 * k + j];
      const double c = B[6 * k + j + 1];
      for (std::size_t i = 0; i < 6; ++i) {
        first[i] -= A[6 * k + i] * b;
        second[i] -= A[6 * k + i] * c;
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      C[6 * j + i] = first[i];
      C[6 * j + 6 + i] = second[i];
    }
  }
}

}  // namespace

void BlockCholesky::reserve(std::size_t bodies, std::size_t blocks) {
  VERISIM_ASSERT(bodies < kEliminated);
  bodies_max_ = std::max(bodies_max_, bodies);
  neighbours_.reserve(bodies_max_ * ((bodies_max_ + kBits - 1) / kBits));
  degree_.reserve(bodies_max_);
  place_.reserve(bodies_max_);
  order_.reserve(bodies_max_);
  begin_.reserve(bodies_max_ + 1);
  diagonal_.reserve(bodies_max_);
  right_.reserve(6 * bodies_max_);
  row_.reserve(blocks);
  values_.reserve(blocks);
}

void BlockCholesky::begin(std::size_t bodies) {
  VERISIM_ASSERT(bodies <= bodies_max_);
  bodies_ = bodies;
  words_ = (bodies + kBits - 1) / kBits;
  neighbours_.assign(bodies * words_, 0);
}

void BlockCholesky::join(std::size_t a, std::size_t b) {
  VERISIM_ASSERT(a != b);
  VERISIM_ASSERT(std::max(a, b) < bodies_);
  neighbours_[a * words_ + b / kBits] |= std::uint64_t{1} << b % kBits;
  neighbours_[b * words_ + a / kBits] |= std::uint64_t{1} << a % kBits;
}

/// What is left of the body's neighbours are the rows of its column; they become each other's neighbours.
void BlockCholesky::eliminate(std::size_t body) {
  const std::uint64_t* rows = &neighbours_[body * words_];
  for (std::size_t w = 0; w < words_; ++w) {
    for (std::uint64_t left = rows[w]; left != 0; left &= left - 1) {
      const std::size_t other = w * kBits + static_cast<std::size_t>(std::countr_zero(left));
      std::uint64_t* of_other = &neighbours_[other * words_];
      for (std::size_t i = 0; i < words_; ++i) of_other[i] |= rows[i];
      of_other[body / kBits] &= ~(std::uint64_t{1} << body % kBits);
      of_other[other / kBits] &= ~(std::uint64_t{1} << other % kBits);
      std::uint32_t degree = 0;
      for (std::size_t i = 0; i < words_; ++i) degree += static_cast<std::uint32_t>(std::popcount(of_other[i]));
      degree_[other] = degree;
      if (blocks_needed_ < row_.capacity()) row_.push_back(static_cast<std::uint32_t>(other));
      ++blocks_needed_;
    }
  }
}

bool BlockCholesky::analyze() {
  order_.clear();
  row_.clear();
  begin_.assign(1, 0);
  degree_.assign(bodies_, 0);
  place_.assign(bodies_, kEliminated);
  blocks_needed_ = 0;
  for (std::size_t i = 0; i < bodies_ * words_; ++i)
    degree_[i / words_] += static_cast<std::uint32_t>(std::popcount(neighbours_[i]));
  while (order_.size() < bodies_) {
    const auto least = std::min_element(degree_.begin(), degree_.end());  // the first of several
    const auto body = static_cast<std::size_t>(least - degree_.begin());
    place_[body] = static_cast<std::uint32_t>(order_.size());
    order_.push_back(static_cast<std::uint32_t>(body));
    eliminate(body);
    degree_[body] = kEliminated;
    begin_.push_back(static_cast<std::uint32_t>(row_.size()));
  }
  if (blocks_needed_ > row_.size()) return false;
  for (std::uint32_t& row : row_) row = place_[row];
  for (std::size_t j = 0; j < bodies_; ++j) std::sort(row_.begin() + begin_[j], row_.begin() + begin_[j + 1]);
  values_.resize(row_.size());
  diagonal_.resize(bodies_);
  right_.resize(6 * bodies_);
  return true;
}

void BlockCholesky::clear() {
  for (Block& block : values_) block.fill(0);
  for (Block& block : diagonal_) block.fill(0);
}

/// The number of the block in that column and row. @pre it is there
std::size_t BlockCholesky::find(std::size_t column, std::uint32_t row) const {
  const auto end = row_.begin() + begin_[column + 1];
  const auto at = std::lower_bound(row_.begin() + begin_[column], end, row);
  VERISIM_ASSERT(at != end && *at == row);
  return static_cast<std::size_t>(at - row_.begin());
}

Block& BlockCholesky::off_diagonal(std::size_t a, std::size_t b) {
  const auto [early, late] = std::minmax(place_[a], place_[b]);
  return values_[find(early, late)];
}

void BlockCholesky::factor() {
  for (std::size_t j = 0; j < bodies_; ++j) {
    factor_diagonal(diagonal_[j]);
    const std::size_t end = begin_[j + 1];
    for (std::size_t b = begin_[j]; b < end; ++b) divide(values_[b], diagonal_[j]);
    for (std::size_t b = begin_[j]; b < end; ++b) {
      const std::size_t column = row_[b];
      subtract_product(diagonal_[column], values_[b], values_[b]);
      std::size_t to = begin_[column];
      for (std::size_t a = b + 1; a < end; ++a) {
        while (row_[to] != row_[a]) ++to;  // the pattern of the column holds all that is left of this one's
        subtract_product(values_[to], values_[a], values_[b]);
      }
    }
  }
}

void BlockCholesky::solve(std::span<double> x) const {
  VERISIM_ASSERT(x.size() == 6 * bodies_);
  for (std::size_t j = 0; j < bodies_; ++j) std::copy_n(&x[6 * order_[j]], 6, &right_[6 * j]);
  for (std::size_t j = 0; j < bodies_; ++j) {
    const Block& L = diagonal_[j];
    double* y = &right_[6 * j];
    for (std::size_t c = 0; c < 6; ++c) {
      y[c] *= L[6 * c + c];
      for (std::size_t r = c + 1; r < 6; ++r) y[r] -= L[6 * c + r] * y[c];
    }
    for (std::size_t b = begin_[j]; b < begin_[j + 1]; ++b)
      for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t r = 0; r < 6; ++r) right_[6 * row_[b] + r] -= values_[b][6 * c + r] * y[c];
  }
  for (std::size_t j = bodies_; j-- > 0;) {
    const Block& L = diagonal_[j];
    double* y = &right_[6 * j];
    for (std::size_t b = begin_[j]; b < begin_[j + 1]; ++b)
      for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t r = 0; r < 6; ++r) y[c] -= values_[b][6 * c + r] * right_[6 * row_[b] + r];
    for (std::size_t c = 6; c-- > 0;) {
      for (std::size_t r = c + 1; r < 6; ++r) y[c] -= L[6 * c + r] * y[r];
      y[c] *= L[6 * c + c];
    }
  }
  for (std::size_t j = 0; j < bodies_; ++j) std::copy_n(&right_[6 * j], 6, &x[6 * order_[j]]);
}

}  // namespace verisim::exact

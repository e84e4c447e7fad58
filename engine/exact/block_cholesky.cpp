#include "engine/exact/block_cholesky.hpp"

#include <algorithm>
#include <bit>

#include "engine/base/error.hpp"
#include "engine/exact/block_kernels.hpp"

namespace verisim::exact {
namespace {

using Block = BlockCholesky::Block;
constexpr std::size_t kBits = 64;
constexpr std::uint32_t kEliminated = static_cast<std::uint32_t>(-1);

/// The numbers of all blocks, one block after the other.
template <typename Blocks>
auto* first_of(Blocks& blocks) {
  return blocks.empty() ? nullptr : blocks.front().data();
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
  factor_blocks({bodies_, begin_.data(), row_.data()}, first_of(values_), first_of(diagonal_));
}

void BlockCholesky::solve(std::span<double> x) const {
  VERISIM_ASSERT(x.size() == 6 * bodies_);
  for (std::size_t j = 0; j < bodies_; ++j) std::copy_n(&x[6 * order_[j]], 6, &right_[6 * j]);
  solve_blocks({bodies_, begin_.data(), row_.data()}, first_of(values_), first_of(diagonal_), right_.data());
  for (std::size_t j = 0; j < bodies_; ++j) std::copy_n(&right_[6 * j], 6, &x[6 * order_[j]]);
}

}  // namespace verisim::exact

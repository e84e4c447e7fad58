// The sparse solver against Eigen's dense one, on random patterns; what it does when there is no room.
#include "engine/exact/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "engine/base/random.hpp"
#include "engine/contact/query.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::block_cholesky_test {
namespace {

using verisim::test::tolerance;

/// Bodies on a line, a plane or in space that touch their neighbours, numbered at random; or any pairs.
struct Pattern {
  std::size_t bodies = 0;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
};

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : stream_(seed, "block cholesky") {}
  double next() { return 2 * stream_.uniform(n_++) - 1; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(stream_.uniform(n_++) * static_cast<double>(n)); }

 private:
  RandomStream stream_;
  std::uint64_t n_ = 0;
};

Pattern random_pattern(std::uint64_t seed) {
  Numbers numbers(seed);
  Pattern pattern;
  pattern.bodies = 1 + numbers.below(120);
  const std::size_t pairs = numbers.below(3 * pattern.bodies);
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::size_t a = numbers.below(pattern.bodies);
    const std::size_t b = numbers.below(2) == 0 ? numbers.below(pattern.bodies) : (a + 1) % pattern.bodies;
    if (a != b) pattern.pairs.emplace_back(a, b);
  }
  return pattern;
}

/// The same matrix, dense and in blocks: springs between the bodies of each pair, and a mass.
Eigen::MatrixXd fill(const Pattern& pattern, std::uint64_t seed, BlockCholesky& sparse) {
  Numbers numbers(seed + 1000);
  const auto n = static_cast<Eigen::Index>(6 * pattern.bodies);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  sparse.clear();
  const auto add = [&](std::size_t a, std::size_t b, const Matrix6d& block) {
    dense.block<6, 6>(static_cast<Eigen::Index>(6 * a), static_cast<Eigen::Index>(6 * b)) += block;
    if (a != b && !sparse.is_later(a, b)) return;
    BlockCholesky::Block& to = a == b ? sparse.diagonal(a) : sparse.off_diagonal(a, b);
    for (std::size_t i = 0; i < 36; ++i) to[i] += block.data()[i];
  };
  for (std::size_t i = 0; i < pattern.bodies; ++i) add(i, i, (1 + 0.5 * numbers.next()) * Matrix6d::Identity());
  for (const auto& [a, b] : pattern.pairs) {
    Vector6d J, K;
    for (int i = 0; i < 6; ++i) J[i] = numbers.next();
    for (int i = 0; i < 6; ++i) K[i] = numbers.next();
    const double k = 1 + 100 * std::abs(numbers.next());
    add(a, a, k * J * J.transpose());
    add(b, b, k * K * K.transpose());
    add(a, b, k * J * K.transpose());
    add(b, a, k * K * J.transpose());
  }
  return dense;
}

bool analyze(const Pattern& pattern, BlockCholesky& sparse) {
  sparse.begin(pattern.bodies);
  for (const auto& [a, b] : pattern.pairs) sparse.join(a, b);
  return sparse.analyze();
}

TEST(BlockCholesky, SolvesAsADenseOne) {
  BlockCholesky sparse;
  sparse.reserve(120, 120 * 119 / 2);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const Pattern pattern = random_pattern(seed);
    ASSERT_TRUE(analyze(pattern, sparse));
    const Eigen::MatrixXd dense = fill(pattern, seed, sparse);
    Numbers numbers(seed + 2000);
    Eigen::VectorXd b(dense.rows());
    for (double& x : b) x = numbers.next();
    std::vector<double> x(b.begin(), b.end());
    const std::uint64_t before = allocations;
    sparse.factor();
    sparse.solve(x);
    EXPECT_EQ(allocations, before);
    const Eigen::VectorXd wanted = dense.llt().solve(b);
    for (Eigen::Index i = 0; i < b.size(); ++i)
      ASSERT_NEAR(x[static_cast<std::size_t>(i)], wanted[i], tolerance(1e-11 * wanted.norm()));
  }
}

TEST(BlockCholesky, GivesTheSameBitsOnEverySimdTarget) {
  struct AnySimdTarget {
    ~AnySimdTarget() { use_simd_target(""); }
  } const restore;
  BlockCholesky sparse;
  sparse.reserve(120, 120 * 119 / 2);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Pattern pattern = random_pattern(seed);
    ASSERT_TRUE(analyze(pattern, sparse));
    std::vector<double> wanted;
    for (const std::string& target : simd_targets()) {
      use_simd_target(target);
      (void)fill(pattern, seed, sparse);
      std::vector<double> x(6 * pattern.bodies, 1.0);
      sparse.factor();
      sparse.solve(x);
      if (wanted.empty()) wanted = x;
      EXPECT_EQ(x, wanted) << target;
    }
  }
}

// A chain that is numbered at random fills nothing in; a grid of n x n bodies less than the n^3 of a band.
TEST(BlockCholesky, FillsLittleIn) {
  BlockCholesky sparse;
  sparse.reserve(400, 400 * 399 / 2);
  Pattern chain{100, {}};
  std::vector<std::size_t> number(100);
  Numbers numbers(1);
  for (std::size_t i = 0; i < 100; ++i) number[i] = i;
  for (std::size_t i = 99; i > 0; --i) std::swap(number[i], number[numbers.below(i + 1)]);
  for (std::size_t i = 1; i < 100; ++i) chain.pairs.emplace_back(number[i - 1], number[i]);
  ASSERT_TRUE(analyze(chain, sparse));
  EXPECT_EQ(sparse.blocks_needed(), 99U);
  Pattern grid{400, {}};
  for (std::size_t i = 0; i < 400; ++i) {
    if (i % 20 != 19) grid.pairs.emplace_back(i, i + 1);
    if (i < 380) grid.pairs.emplace_back(i, i + 20);
  }
  ASSERT_TRUE(analyze(grid, sparse));
  EXPECT_LT(sparse.blocks_needed(), 3800U);  // half of what the order of their numbers gives, 19 x 400
}

TEST(BlockCholesky, SaysWhatItNeedsWhenThereIsNoRoom) {
  const Pattern pattern{4, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}};  // a ring: one block fills in
  BlockCholesky sparse;
  sparse.reserve(4, 4);
  EXPECT_FALSE(analyze(pattern, sparse));
  EXPECT_EQ(sparse.blocks_needed(), 5U);
  sparse.reserve(4, sparse.blocks_needed());
  EXPECT_TRUE(analyze(pattern, sparse));
}

}  // namespace
}  // namespace verisim::exact::test::block_cholesky_test

#include "engine/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <vector>

#include "tests/support/tolerance.hpp"

namespace verisim::random_test {
namespace {

using test::tolerance;

constexpr int kDraws = 200000;
// Statistics may miss by five standard errors: one in 1.7 million seeds would, and the seed is fixed.
constexpr double kSigmas = 5;

TEST(RandomStream, KeepsItsBits) {
  const RandomStream stream(1, "tremor");
  EXPECT_EQ(stream.bits(0), 0x0a009d8eb18d5384u);
  EXPECT_EQ(stream.bits(1), 0x6b33b47da540906fu);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(stream.uniform(0)), 0x3fa4013b1d631aa0u);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(stream.normal(0)), 0x3ff93f208253e4f9u);
  EXPECT_EQ(RandomStream(2026, "").bits(0), 0x6f9ca2c3f5a3a2fau);
}

// DESIGN rule 1: what is drawn where and when must not matter.
TEST(RandomStream, DoesNotDependOnWhatElseIsDrawn) {
  const RandomStream stream(7, "errors"), other(7, "tremor");
  std::vector<std::uint64_t> forward, backward;
  for (std::uint64_t c = 0; c < 100; ++c) forward.push_back(stream.bits(c));
  for (std::uint64_t c = 100; c-- > 0;) {
    (void)other.normal(c);
    backward.push_back(RandomStream(7, "errors").bits(c));
  }
  std::reverse(backward.begin(), backward.end());
  EXPECT_EQ(forward, backward);
}

TEST(RandomStream, DiffersBySeedNameAndCounter) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const char* name : {"", "a", "b", "tremor"})
      for (std::uint64_t c = 0; c < 100; ++c) seen.insert(RandomStream(seed, name).bits(c));
  EXPECT_EQ(seen.size(), 20u * 4 * 100);
}

TEST(RandomStream, UniformStaysBelowOneWithTheRightMoments) {
  const RandomStream stream(3, "uniform");
  double sum = 0, squares = 0, lowest = 1, highest = 0, lag = 0, before = 0.5;
  for (int i = 0; i < kDraws; ++i) {
    const double u = stream.uniform(static_cast<std::uint64_t>(i));
    lowest = std::min(lowest, u);
    highest = std::max(highest, u);
    sum += u;
    squares += (u - 0.5) * (u - 0.5);
    lag += (u - 0.5) * (before - 0.5);
    before = u;
  }
  EXPECT_GE(lowest, 0);
  EXPECT_LT(highest, 1);
  // Variances: of u 1/12, of (u - 1/2)^2 1/180, of the product of two independent ones 1/144.
  EXPECT_LE(std::abs(sum / kDraws - 0.5), tolerance(kSigmas * std::sqrt(1.0 / 12 / kDraws)));
  EXPECT_LE(std::abs(squares / kDraws - 1.0 / 12), tolerance(kSigmas * std::sqrt(1.0 / 180 / kDraws)));
  EXPECT_LE(std::abs(lag / kDraws), tolerance(kSigmas * std::sqrt(1.0 / 144 / kDraws)));
}

TEST(RandomStream, EveryBitIsSetHalfOfTheTime) {
  const RandomStream stream(4, "bits");
  std::vector<int> set(64);
  for (int i = 0; i < kDraws; ++i)
    for (std::size_t b = 0; b < 64; ++b)
      set[b] += static_cast<int>(stream.bits(static_cast<std::uint64_t>(i)) >> b & 1);
  for (const int count : set) EXPECT_LE(std::abs(count - kDraws / 2.0), tolerance(kSigmas * std::sqrt(kDraws / 4.0)));
}

TEST(RandomStream, NormalHasTheMomentsOfTheStandardNormal) {
  const RandomStream stream(5, "normal");
  double m1 = 0, m2 = 0, m4 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = stream.normal(static_cast<std::uint64_t>(i));
    ASSERT_TRUE(std::isfinite(x));
    m1 += x / kDraws;
    m2 += x * x / kDraws;
    m4 += x * x * x * x / kDraws;
  }
  // Variances of x, x^2, x^4: 1, 2, 96.
  EXPECT_LE(std::abs(m1), tolerance(kSigmas * std::sqrt(1.0 / kDraws)));
  EXPECT_LE(std::abs(m2 - 1), tolerance(kSigmas * std::sqrt(2.0 / kDraws)));
  EXPECT_LE(std::abs(m4 - 3), tolerance(kSigmas * std::sqrt(96.0 / kDraws)));
}

}  // namespace
}  // namespace verisim::random_test

#include "engine/base/pinned_math.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::pinned_math_test {
namespace {

using test::Inputs;
using test::seeds;
using test::tolerance;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far `value` is from the 64-bit mantissa result `exact`, in units of the last place of a double.
double ulps(double value, long double exact) {
  const double rounded = static_cast<double>(exact);
  const double ulp = std::nextafter(std::abs(rounded), kInfinity) - std::abs(rounded);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / static_cast<long double>(ulp));
}

// SLEEF promises 1.0 ulp; the reference, in extended precision, is wrong by at most 2^-11 of one.
constexpr double kUlps = 1.0 + 0x1p-10;

TEST(PinnedMath, IsWithinOneUlpOfExtendedPrecision) {
  for (const std::uint64_t seed : seeds(20000)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const double angle = in.between(-1e4, 1e4), unit = in.between(-1, 1), x = in.between(-20, 20);
    const double positive = std::ldexp(in.between(0.5, 1), static_cast<int>(in.between(-300, 300)));
    using L = long double;
    ASSERT_LE(ulps(pinned::sin(angle), std::sin(L{angle})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::cos(angle), std::cos(L{angle})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::tan(angle), std::tan(L{angle})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::asin(unit), std::asin(L{unit})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::acos(unit), std::acos(L{unit})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::atan2(x, unit), std::atan2(L{x}, L{unit})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::exp(x), std::exp(L{x})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::log(positive), std::log(L{positive})), tolerance(kUlps));
    ASSERT_LE(ulps(pinned::pow(std::abs(x), unit), std::pow(L{std::abs(x)}, L{unit})), tolerance(kUlps));
  }
}

TEST(PinnedMath, GivesTheExactValues) {
  EXPECT_EQ(pinned::sin(0), 0);
  EXPECT_EQ(pinned::cos(0), 1);
  EXPECT_EQ(pinned::tan(0), 0);
  EXPECT_EQ(pinned::asin(0), 0);
  EXPECT_EQ(pinned::acos(1), 0);
  EXPECT_EQ(pinned::atan2(0, 1), 0);
  EXPECT_EQ(pinned::atan2(0, -1), pinned::kPi);
  EXPECT_EQ(pinned::exp(0), 1);
  EXPECT_EQ(pinned::log(1), 0);
  EXPECT_EQ(pinned::pow(2, 10), 1024);
  EXPECT_EQ(pinned::pow(0, 0), 1);
}

TEST(PinnedMath, AnswersTheEdgesAsTheStandardSays) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(pinned::sin(kInfinity)));
  EXPECT_TRUE(std::isnan(pinned::sin(nan)));
  EXPECT_TRUE(std::isnan(pinned::asin(1.5)));
  EXPECT_TRUE(std::isnan(pinned::log(-1)));
  EXPECT_TRUE(std::isnan(pinned::atan2(nan, 1)));
  EXPECT_EQ(pinned::log(0), -kInfinity);
  EXPECT_EQ(pinned::exp(-kInfinity), 0);
  EXPECT_EQ(pinned::exp(1000), kInfinity);
}

// Bits as the pinned library gives them, x86-64 and elsewhere. Another library, or fused multiply-add, changes some:
// then every golden hash changes with them, and this test says why.
TEST(PinnedMath, KeepsItsBits) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
  EXPECT_EQ(bits(pinned::sin(0.5)), 0x3fdeaee8744b05f0u);
  EXPECT_EQ(bits(pinned::sin(1e5)), 0x3fa24daa9c527e96u);
  EXPECT_EQ(bits(pinned::cos(2.5)), 0xbfe9a2f7ef858b7du);
  EXPECT_EQ(bits(pinned::tan(1.25)), 0x4008139943e231a8u);
  EXPECT_EQ(bits(pinned::asin(0.75)), 0x3feb235315c680dcu);
  EXPECT_EQ(bits(pinned::acos(-0.3)), 0x3ffe0200bbc96ad8u);
  EXPECT_EQ(bits(pinned::atan2(1, -3)), 0x40068f095fdf593cu);
  EXPECT_EQ(bits(pinned::exp(-1.75)), 0x3fc63e397e022072u);
  EXPECT_EQ(bits(pinned::log(7.5)), 0x40001e85798eb9a3u);
  EXPECT_EQ(bits(pinned::pow(1.7, -3.2)), 0x3fc76e187c0f9605u);
}

}  // namespace
}  // namespace verisim::pinned_math_test

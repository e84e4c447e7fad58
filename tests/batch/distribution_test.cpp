#include "engine/batch/distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim::batch::distribution_test {
namespace {

double as_number(const std::string& text) {
  return text == "25mm" ? 0.025 : std::stod(text);
}

/// The largest distance between the distribution function of the draws and the closed form (Kolmogorov, Smirnov).
template <typename Cumulative>
double distance(const Distribution& d, std::uint64_t seed, std::size_t n, const Cumulative& cumulative) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(drawn(d, seed, "clearance", i));
  std::sort(values.begin(), values.end());
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double at = cumulative(values[i]);
    most = std::max({most, std::abs(at - static_cast<double>(i) / static_cast<double>(n)),
                     std::abs(at - static_cast<double>(i + 1) / static_cast<double>(n))});
  }
  return most;
}

// Beyond 2.0 / sqrt(n) a sample of the right distribution lies once in 1500 times (Smirnov 1948: 2 exp(-2 * 2.0^2));
// ten seeds of two distributions are tried.
constexpr std::size_t kDraws = 10'000;
const double kFarthest = 2.0 / std::sqrt(static_cast<double>(kDraws));

TEST(Distribution, OfLowToHighIsUniform) {
  const Distribution d = distribution_from("x", "2..6", as_number);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    EXPECT_LT(distance(d, seed, kDraws, [](double x) { return (x - 2) / 4; }), kFarthest) << seed;
    for (std::uint64_t i = 0; i < kDraws; ++i) {
      EXPECT_GE(drawn(d, seed, "clearance", i), 2);
      EXPECT_LT(drawn(d, seed, "clearance", i), 6);
    }
  }
}

TEST(Distribution, NormalIsNormal) {
  const Distribution d = distribution_from("x", "normal:3:0.5", as_number);
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    EXPECT_LT(distance(d, seed, kDraws, [](double x) { return 0.5 * std::erfc(-(x - 3) / (0.5 * std::sqrt(2.0))); }),
              kFarthest)
        << seed;
}

// The alarm: a distribution of another width or middle is farther away than that.
TEST(Distribution, IsToldFromItsNeighbours) {
  const Distribution d = distribution_from("x", "normal:3:0.5", as_number);
  EXPECT_GT(distance(d, 1, kDraws, [](double x) { return 0.5 * std::erfc(-(x - 3.05) / (0.5 * std::sqrt(2.0))); }),
            kFarthest);
  EXPECT_GT(distance(d, 1, kDraws, [](double x) { return 0.5 * std::erfc(-(x - 3) / (0.55 * std::sqrt(2.0))); }),
            kFarthest);
}

// ISO 286: H7 at 25 mm is 0 to +21 um, g6 is -20 to -7 um: six sigma are the zone's width.
TEST(Distribution, OfAZoneIsNormalAboutItsMiddleAndSixSigmaWide) {
  const Distribution h7 = distribution_from("x", "zone:H7:25mm", as_number);
  EXPECT_EQ(h7.kind, Distribution::Kind::normal);
  EXPECT_NEAR(h7.first, 0.0250105, 1e-15);
  EXPECT_NEAR(h7.second, 3.5e-6, 1e-18);
  const Distribution g6 = distribution_from("x", "zone:g6:25mm", as_number);
  EXPECT_NEAR(g6.first, 0.025 - 13.5e-6, 1e-15);
  EXPECT_NEAR(g6.second, 13e-6 / 6, 1e-18);
}

TEST(Distribution, DrawDependsOnSeedNameAndNumberAlone) {
  const Distribution d = distribution_from("x", "uniform:0:1", as_number);
  const double fifth = drawn(d, 7, "clearance", 5);
  (void)drawn(d, 7, "tilt", 3);
  EXPECT_EQ(drawn(d, 7, "clearance", 5), fifth);
  EXPECT_NE(drawn(d, 7, "tilt", 5), fifth);
  EXPECT_NE(drawn(d, 8, "clearance", 5), fifth);
  EXPECT_NE(drawn(d, 7, "clearance", 6), fifth);
}

// Golden: the promise that every machine and every later version draws the same. Written down from the first version.
TEST(Distribution, DrawsAreTheSameBitsForEver) {
  EXPECT_EQ(drawn(distribution_from("x", "0..1", as_number), 1, "clearance", 0), 0.7159785783533829);
  EXPECT_EQ(drawn(distribution_from("x", "normal:0:1", as_number), 1, "clearance", 0), 1.036331161723305);
  EXPECT_EQ(seed_of_repetition(1, 0), 1182839190134574u);
}

TEST(SeedOfRepetition, FitsEveryTableAndDiffers) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t batch = 0; batch < 10; ++batch)
    for (std::uint64_t r = 0; r < 1000; ++r) {
      const std::uint64_t seed = seed_of_repetition(batch, r);
      EXPECT_LT(seed, std::uint64_t{1} << 53);
      seeds.insert(seed);
    }
  EXPECT_EQ(seeds.size(), 10'000u);
}

TEST(Distribution, RefusesWhatIsNone) {
  for (const char* text : {"", "1", "2..1", "1..1", "..2", "1..", "uniform:2:1", "uniform:1", "uniform:1:2:3",
                           "normal:1", "normal:1:-1", "zone:H7", "zone:H77:25mm", "zone:Z7:25mm", "zone:H7:0.5",
                           "zone:H7:0.001", "zone::25mm", "zone:7:25mm", "gauss:1:2"}) {
    try {
      (void)distribution_from("--random x", text, as_number);
      ADD_FAILURE() << text << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), 2) << text;
      EXPECT_TRUE(std::string(error.what()).starts_with("--random x: ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace verisim::batch::distribution_test

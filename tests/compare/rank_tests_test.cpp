#include "engine/compare/rank_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/random.hpp"
#include "tests/support/broken.hpp"

namespace verisim::compare::rank_tests_test {
namespace {

using Values = std::vector<double>;

// Hollander and Wolfe's permeability constants (R's help of wilcox.test): W = 35, p = 0.1272 one-sided.
// SciPy 1.10.1, mannwhitneyu: statistic 35.0, p 0.2544122544122544.
TEST(MannWhitney, ExactIsThePublishedExample) {
  const Values a = {0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
  const Values b = {1.15, 0.88, 0.90, 0.74, 1.21};
  const RankTest test = mann_whitney(a, b);
  EXPECT_EQ(test.statistic, 35);
  EXPECT_NEAR(test.p, 0.2544122544122544, 1e-15);
  EXPECT_EQ(mann_whitney(b, a).p, test.p);
  EXPECT_EQ(mann_whitney(b, a).statistic, 15);
}

// The example of SciPy's own documentation: U = 17, exact p = 1/9.
TEST(MannWhitney, ExactIsSciPysExample) {
  const Values males = {19, 22, 16, 29, 24}, females = {20, 11, 17, 12};
  EXPECT_EQ(mann_whitney(males, females).statistic, 17);
  EXPECT_NEAR(mann_whitney(males, females).p, 1.0 / 9, 1e-15);
}

// With ties, and with more than 8 of each. SciPy 1.10.1: statistic 94.0, p 0.864230511210048.
TEST(MannWhitney, ApproximationIsSciPysWithTies) {
  const Values a = {10.1, 11.3, 9.1, 11.0, 9.7, 9.7, 11.9, 10.2, 10.0, 10.7, 11.1, 10.0, 10.6, 9.0, 9.6};
  const Values b = {10.2, 9.3, 9.1, 9.0, 10.4, 10.4, 10.3, 10.7, 9.3, 10.5, 10.8, 11.4};
  EXPECT_EQ(mann_whitney(a, b).statistic, 94);
  EXPECT_NEAR(mann_whitney(a, b).p, 0.864230511210048, 1e-14);
}

TEST(MannWhitney, EqualValuesTellNothing) {
  const Values same(5, 1.0);
  EXPECT_EQ(mann_whitney(same, same).p, 1);
}

// Critical values of U, two-sided 5 % and 1 %, of Mann and Whitney's table as in Siegel, Nonparametric Statistics
// (1956), table K: the largest U at which p is still at most alpha.
TEST(UProbabilities, HasTheTablesCriticalValues) {
  struct Row {
    std::size_t m, n;
    double tail;
    std::size_t critical;
  };
  for (const Row& row :
       {Row{5, 5, 0.025, 2}, Row{5, 5, 0.005, 0}, Row{8, 8, 0.025, 13}, Row{10, 10, 0.025, 23}, Row{10, 10, 0.005, 16},
        Row{20, 20, 0.025, 127}, Row{20, 20, 0.005, 105}, Row{9, 15, 0.025, 34}}) {
    const Values below = u_probabilities(row.m, row.n);
    EXPECT_LE(below[row.critical], row.tail) << row.m << " " << row.n;
    EXPECT_GT(below[row.critical + 1], row.tail) << row.m << " " << row.n;
    EXPECT_EQ(u_probabilities(row.n, row.m), below);
  }
}

// By counting all choices of m places: what the recursion is short for.
TEST(UProbabilities, IsWhatCountingAllOrdersGives) {
  for (const auto& [m, n] : {std::pair<unsigned, unsigned>{1, 1}, {1, 4}, {3, 4}, {5, 3}, {4, 6}}) {
    Values counts(m * n + 1, 0);
    double all = 0;
    for (unsigned places = 0; places < 1U << (m + n); ++places) {
      if (static_cast<unsigned>(__builtin_popcount(places)) != m) continue;
      unsigned u = 0, others = 0;
      for (unsigned i = 0; i < m + n; ++i) {
        if ((places >> i & 1U) != 0)
          u += others;
        else
          ++others;
      }
      ++counts[u];
      ++all;
    }
    double sum = 0;
    const Values below = u_probabilities(m, n);
    for (std::size_t u = 0; u < counts.size(); ++u)
      EXPECT_NEAR(below[u], (sum += counts[u]) / all, 1e-14) << m << n << u;
  }
}

// Hollander and Wolfe's depression scale (R's help of wilcox.test): V = 40, p = 0.01953 one-sided. SciPy 1.10.1:
// 0.0390625.
TEST(SignedRank, ExactIsThePublishedExample) {
  const Values x = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const Values y = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  Values d;
  for (std::size_t i = 0; i < x.size(); ++i) d.push_back(x[i] - y[i]);
  EXPECT_EQ(signed_rank(d).statistic, 40);
  EXPECT_EQ(signed_rank(d).p, 0.0390625);
}

// Critical values of W, two-sided, of Wilcoxon's table (Siegel, table G): the largest smaller sum of ranks that is
// significant.
TEST(WProbabilities, HasTheTablesCriticalValues) {
  struct Row {
    std::size_t n;
    double tail;
    std::size_t critical;
  };
  for (const Row& row : {Row{6, 0.025, 0}, Row{8, 0.025, 3}, Row{10, 0.025, 8}, Row{10, 0.005, 3}, Row{15, 0.025, 25},
                         Row{20, 0.025, 52}, Row{20, 0.005, 37}, Row{25, 0.025, 89}, Row{25, 0.005, 68}}) {
    const Values below = w_probabilities(row.n);
    EXPECT_LE(below[row.critical], row.tail) << row.n;
    EXPECT_GT(below[row.critical + 1], row.tail) << row.n;
  }
}

// Ties and zeros, against all 2^n signs of the same ranks.
TEST(SignedRank, IsExactWithTies) {
  const Values d = {0.5, -0.5, 1.5, 1.5, -0.25, 2, 0, 1.5, -3};
  const Values ranks = {2.5, 2.5, 5, 5, 1, 7, 5, 8};  // of 0.5 0.5 1.5 1.5 0.25 2 1.5 3
  const double positive = 2.5 + 5 + 5 + 7 + 5;
  EXPECT_EQ(signed_rank(d).statistic, positive);
  int as_far = 0;
  for (unsigned signs = 0; signs < 256; ++signs) {
    double sum = 0;
    for (unsigned i = 0; i < 8; ++i) sum += (signs >> i & 1U) != 0 ? ranks[i] : 0;
    as_far += std::abs(sum - 18) >= std::abs(positive - 18) ? 1 : 0;
  }
  EXPECT_NEAR(signed_rank(d).p, as_far / 256.0, 1e-15);
  EXPECT_EQ(signed_rank(Values{0, 0}).p, 1);
}

// One more than are tested exactly: what is left is the shape of the distribution (excess kurtosis of some -0.014).
TEST(SignedRank, ApproximationContinuesTheExactTest) {
  const RandomStream random(1, "rank_tests_test");
  const Values below = w_probabilities(101);
  for (const double shift : {0.0, 0.1, 0.2, 0.3}) {
    Values d;
    for (std::uint64_t i = 0; i < 101; ++i) d.push_back(random.normal(i) + shift);
    const RankTest test = signed_rank(d);
    const auto w = static_cast<std::size_t>(std::min(test.statistic, 101.0 * 102 / 2 - test.statistic));
    EXPECT_NEAR(test.p, 2 * below[w], 0.002) << shift;
  }
}

TEST(LeastP, IsOfSamplesApartFromEachOther) {
  for (const std::size_t n : {1U, 2U, 5U, 9U}) {
    Values a, b, d;
    for (std::size_t i = 0; i < n; ++i) {
      a.push_back(static_cast<double>(i));
      b.push_back(static_cast<double>(100 + i));
      d.push_back(1 + 0.1 * static_cast<double>(i));
    }
    if (n <= 8) {
      EXPECT_NEAR(least_p_of_samples(n, n), mann_whitney(a, b).p, 1e-15);
    }
    EXPECT_NEAR(least_p_of_pairs(n), signed_rank(d).p, 1e-15);
  }
}

// Holm's own step-down by hand: 0.01 x 4, 0.02 x 3, 0.03 x 2, 0.04 x 1, never below one before.
TEST(Holm, IsTheWorkedExample) {
  const Values corrected = holm(Values{0.04, 0.01, 0.03, 0.02});
  const Values wanted = {0.06, 0.04, 0.06, 0.06};
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(corrected[i], wanted[i], 1e-15);
  EXPECT_EQ(holm(Values{0.9, 0.8}), (Values{1, 1}));
}

TEST(RankTestsDeathTest, NeedValues) {
  EXPECT_BROKEN(mann_whitney({}, Values{1}), "!a.empty()");
  EXPECT_BROKEN(mann_whitney(Values{1}, Values{NAN}), "!has_nan(b)");
  EXPECT_BROKEN(signed_rank(Values{NAN}), "!has_nan(differences)");
}

}  // namespace
}  // namespace verisim::compare::rank_tests_test

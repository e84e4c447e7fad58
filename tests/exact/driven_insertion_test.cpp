#include "tests/exact/driven_insertion.hpp"

#include <gtest/gtest.h>

namespace verisim::exact::test {
namespace {

struct Case {
  double clearance;
  double peak;  ///< N
};

/// Peak forces: MuJoCo's with stiff contacts and those of ../shared/reference/exact, which agree.
class DrivenInsertion : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Clearances, DrivenInsertion,
                         ::testing::Values(Case{1e-3, 9.3}, Case{1e-4, 13.3}, Case{2e-5, 13.7}, Case{1e-5, 13.7}));

TEST_P(DrivenInsertion, ReachesTheEndWithTheKnownForceAndHardlyOverlaps) {
  const Outcome o = run({.clearance = GetParam().clearance});
  EXPECT_NEAR(o.bottom, -0.12, 2e-5);
  EXPECT_NEAR(o.force_max, GetParam().peak, 0.06);  // given to a tenth of a newton
  EXPECT_LE(o.overlap_max, 0.0125 * GetParam().clearance);
}

}  // namespace
}  // namespace verisim::exact::test

// R4 of ORACLES: the regressions of table 7.1, from its rows as printed.
#include <gtest/gtest.h>

#include "engine/constraint/recognition_table.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::recognition_times_test {
namespace {

using test::tolerance;

// Printed to four digits: 0.7075 and 0.8517; the third is ours, 0.901.
TEST(PublishedRecognitionRows, GiveThePublishedRegressions) {
  const RecognitionFits fits = fit(published_recognition_rows());
  EXPECT_NEAR(fits.constraints.r_squared, 0.7075, tolerance(5e-5));
  EXPECT_NEAR(fits.specializations.r_squared, 0.8517, tolerance(5e-5));
  EXPECT_NEAR(fits.symmetric.r_squared, 0.901, tolerance(5e-4));
}

}  // namespace
}  // namespace verisim::recognition_times_test

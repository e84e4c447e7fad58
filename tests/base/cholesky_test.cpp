#include "engine/base/cholesky.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_inputs.hpp"

namespace verisim::cholesky_test {
namespace {

using test::Inputs;
using test::seeds;

Matrix6d positive_definite(Inputs& draw) {
  Matrix6d root;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) root(i, j) = draw.between(-1, 1);
  return root * root.transpose() + Matrix6d::Identity();
}

TEST(Cholesky6, GivesBackWhatTheMatrixWasMultipliedWith) {
  for (const std::uint64_t seed : seeds(50)) {
    Inputs draw(seed);
    const Matrix6d A = positive_definite(draw);
    Vector6d x;
    for (int i = 0; i < 6; ++i) x[i] = draw.between(-1, 1);
    const Cholesky6 factors(A);
    ASSERT_TRUE(factors.is_positive_definite());
    EXPECT_LT((factors.solve(A * x) - x).norm(), 1e-12);
    EXPECT_LT((factors.inverse() * A - Matrix6d::Identity()).norm(), 1e-12);
  }
}

TEST(Cholesky6, SaysThatAMatrixIsNotPositiveDefinite) {
  Inputs draw(1);
  Matrix6d A = positive_definite(draw);
  A(3, 3) = -1;
  EXPECT_FALSE(Cholesky6(A).is_positive_definite());
}

}  // namespace
}  // namespace verisim::cholesky_test

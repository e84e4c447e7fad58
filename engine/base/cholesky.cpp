#include "engine/base/cholesky.hpp"

namespace verisim {

Cholesky6::Cholesky6(const Matrix6d& A) : factors_(A) {}

Vector6d Cholesky6::solve(const Vector6d& b) const {
  return factors_.solve(b);
}

Matrix6d Cholesky6::inverse() const {
  Matrix6d inverse;
  for (Eigen::Index i = 0; i < 6; ++i) inverse.col(i) = solve(Vector6d::Unit(i));
  return inverse;
}

}  // namespace verisim

// Cholesky's decomposition of six by six, compiled in one place: each place costs 4 s of a compile.
#pragma once

#include <Eigen/Cholesky>

#include "engine/base/pose.hpp"

namespace verisim {

/// A = L L'.
class Cholesky6 {
 public:
  explicit Cholesky6(const Matrix6d& A);

  [[nodiscard]] bool is_positive_definite() const { return factors_.info() == Eigen::Success; }

  /// x of A x = b. @pre is_positive_definite()
  [[nodiscard]] Vector6d solve(const Vector6d& b) const;
  [[nodiscard]] Matrix6d inverse() const;

 private:
  Eigen::LLT<Matrix6d> factors_;
};

}  // namespace verisim

// The Newton directions of ConvexStep: of one body, of a few as one dense system, of many as a sparse one.
#include <Eigen/Cholesky>

#include "engine/base/contract.hpp"
#include "engine/exact/convex_step.hpp"

namespace verisim::exact {
namespace {

/// Largest dense matrix of unknowns, on the stack.
constexpr int kUnknownsMax = 6 * ConvexStep::kDenseMax;
using MatrixN = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kUnknownsMax, kUnknownsMax>;
using VectorN = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kUnknownsMax, 1>;

/// Solves A x = b for a symmetric positive definite A whose lower triangle is given, in place of b. Written out: for
/// six unknowns a general routine takes twice as long.
void solve_in_place(double A[6][6], double b[6]) {
  double inverse[6];
  for (int j = 0; j < 6; ++j) {
    double pivot = A[j][j];
    for (int k = 0; k < j; ++k) pivot -= A[j][k] * A[j][k];
    inverse[j] = 1 / std::sqrt(pivot);
    for (int i = j + 1; i < 6; ++i) {
      double sum = A[i][j];
      for (int k = 0; k < j; ++k) sum -= A[i][k] * A[j][k];
      A[i][j] = sum * inverse[j];
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= A[i][k] * b[k];
    b[i] *= inverse[i];
  }
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) b[i] -= A[k][i] * b[k];
    b[i] *= inverse[i];
  }
}

}  // namespace

/// The Newton direction of one body. False if it is zero.
bool ConvexStep::find_direction_of_one(double dt) {
  Body& body = bodies_[0];
  const Vector6d push = body.M * (body.u - body.u0);
  double A[6][6];
  double b[6];
  for (int i = 0; i < 6; ++i) {
    b[i] = -push[i];
    for (int j = 0; j <= i; ++j) A[i][j] = body.M(i, j);
  }
  const double square = dt * dt;
  for (const Row& row : rows_) {
    if (!row.acts()) continue;
    const double* J = row.J.data();
    const double force = dt * row.k * row.z;
    const double stiff = square * row.k;
    for (int i = 0; i < 6; ++i) {
      b[i] -= force * J[i];
      const double scaled = stiff * J[i];
      for (int j = 0; j <= i; ++j) A[i][j] += scaled * J[j];
    }
  }
  solve_in_place(A, b);
  for (int i = 0; i < 6; ++i) body.direction[i] = b[i];
  return !body.direction.isZero(0);
}

bool ConvexStep::find_direction_dense(double dt) {
  const int n = 6 * static_cast<int>(bodies_.size());
  MatrixN A = MatrixN::Zero(n, n);
  VectorN b(n);
  for (int i = 0; i < n; i += 6) {
    const Body& body = bodies_[at(i / 6)];
    A.block<6, 6>(i, i) = body.M;
    b.segment<6>(i) = body.M * (body.u0 - body.u);
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (!row.acts()) continue;
    const auto& body = rests_[r].body;
    const double stiff = dt * dt * row.k;
    for (std::size_t i = 0; i < 2; ++i) {
      if (body[i] == kFixed) continue;
      const Vector6d& J = jacobian(r, i);
      b.segment<6>(6 * body[i]) -= dt * row.k * row.z * J;
      for (std::size_t j = 0; j < 2; ++j) {
        if (body[j] == kFixed) continue;
        A.block<6, 6>(6 * body[i], 6 * body[j]) += stiff * J * jacobian(r, j).transpose();
      }
    }
  }
  const VectorN x = A.llt().solve(b);
  for (int i = 0; i < n; i += 6) bodies_[at(i / 6)].direction = x.segment<6>(i);
  return !x.isZero(0);
}

/// The pattern of the sparse system grows with the pairs of bodies of which rows act. True if it has grown.
bool ConvexStep::join_acting_runs() {
  bool grown = false;
  for (Run& run : runs_) {
    if (run.joined || run.body[1] == kFixed) continue;
    for (std::size_t r = run.begin; r < run.end && !run.joined; ++r) run.joined = rows_[r].acts();
    grown = grown || run.joined;
  }
  return grown;
}

void ConvexStep::analyze() {
  factor_.begin(bodies_.size());
  for (const Run& run : runs_)
    if (run.joined) factor_.join(at(run.body[0]), at(run.body[1]));
  coupled_ = factor_.analyze();
  blocks_needed_ = std::max(blocks_needed_, factor_.blocks_needed());
  unknowns_.resize(6 * bodies_.size());
  if (coupled_) return;
  factor_.begin(bodies_.size());
  const bool fits = factor_.analyze();  // no blocks at all
  VERISIM_ASSERT(fits);
}

bool ConvexStep::find_direction_sparse(double dt) {
  if (join_acting_runs() || unknowns_.empty()) analyze();
  factor_.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    std::copy_n(body.M.data(), 36, factor_.diagonal(i).begin());
    const Vector6d force = body.M * (body.u0 - body.u);
    std::copy_n(force.data(), 6, &unknowns_[6 * i]);
  }
  for (Run& run : runs_) add_run(run, dt);
  factor_.factor();
  factor_.solve(unknowns_);
  bool any = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].direction = Eigen::Map<const Vector6d>(&unknowns_[6 * i]);
    any = any || !bodies_[i].direction.isZero(0);
  }
  return any;
}

/// Sums the stiffness of the rows of two bodies that act. Their Jacobians differ by the bodies' centres alone: that of
/// the second is -T times that of the first, T = (1 0; [d]x 1), where d leads from the second's centre to the first's.
/// So only one matrix is summed.
void ConvexStep::sum_stiffness(Run& run, double dt) {
  double H[6][6] = {};  // lower triangle
  for (std::size_t r = run.begin; r < run.end; ++r) {
    const Row& row = rows_[r];
    if (!row.summed) continue;
    const double* J = row.J.data();
    const double stiff = dt * dt * row.k;
    for (int i = 0; i < 6; ++i) {
      const double scaled = stiff * J[i];
      for (int j = 0; j <= i; ++j) H[i][j] += scaled * J[j];
    }
  }
  Matrix6d& of_first = run.of_first;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) of_first(i, j) = of_first(j, i) = H[i][j];
  run.has_sum = true;
  if (run.body[1] == kFixed) return;
  const Vector3d d = bodies_[at(run.body[0])].p_WC - bodies_[at(run.body[1])].p_WC;
  Matrix6d& across = run.across;  // T H
  across = of_first;
  for (int j = 0; j < 6; ++j)
    across.block<3, 1>(3, j) += d.cross(Vector3d(of_first(0, j), of_first(1, j), of_first(2, j)));
  Matrix6d& of_second = run.of_second;  // T H T^T
  of_second = across;
  for (int i = 0; i < 6; ++i)
    of_second.block<1, 3>(i, 3) += d.cross(Vector3d(across(i, 0), across(i, 1), across(i, 2))).transpose();
}

/// Adds the rows of two bodies to the sparse system. Their stiffness is summed again only if others act than the last
/// time: towards the minimum few pairs change.
void ConvexStep::add_run(Run& run, double dt) {
  Vector6d b = Vector6d::Zero();
  bool acts = false;
  for (std::size_t r = run.begin; r < run.end; ++r) {
    Row& row = rows_[r];
    const bool row_acts = row.acts();
    run.has_sum = run.has_sum && row.summed == row_acts;
    row.summed = row_acts;
    if (!row_acts) continue;
    acts = true;
    b += dt * row.k * row.z * row.J;
  }
  if (!acts) return;
  if (!run.has_sum) sum_stiffness(run, dt);
  const std::size_t first = at(run.body[0]);
  const auto add = [](BlockCholesky::Block& to, const Matrix6d& from) { Eigen::Map<Matrix6d>(to.data()) += from; };
  add(factor_.diagonal(first), run.of_first);
  Eigen::Map<Vector6d>(&unknowns_[6 * first]) -= b;
  if (run.body[1] == kFixed) return;

  const std::size_t second = at(run.body[1]);
  const Vector3d d = bodies_[first].p_WC - bodies_[second].p_WC;
  add(factor_.diagonal(second), run.of_second);
  b.tail<3>() += d.cross(b.head<3>());
  Eigen::Map<Vector6d>(&unknowns_[6 * second]) += b;
  if (!coupled_) return;
  BlockCholesky::Block& between = factor_.off_diagonal(first, second);
  if (factor_.is_later(second, first)) {
    Eigen::Map<Matrix6d>(between.data()) -= run.across;
  } else {
    Eigen::Map<Matrix6d>(between.data()) -= run.across.transpose();
  }
}

}  // namespace verisim::exact

#include "engine/wii/validation_figures.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace verisim::wii {
namespace {

constexpr double kBlindAfter = 0.1;        // s
constexpr double kChiSquare95 = 7.814728;  // three degrees of freedom
constexpr double kNormal975 = 1.959964;
constexpr double kCorrelationMin = 0.05;  // of the autocorrelation: below it lags no longer count

ErrorFigures figures_of(const std::vector<Vector3d>& errors, double unit) {
  ErrorFigures f;
  if (errors.empty()) return f;
  std::vector<double> norms;
  Vector3d squares = Vector3d::Zero();
  for (const Vector3d& e : errors) {
    norms.push_back(e.norm() * unit);
    squares += e.cwiseAbs2();
  }
  const auto n = static_cast<double>(errors.size());
  std::sort(norms.begin(), norms.end());
  f.rms = std::sqrt(squares.sum() / n) * unit;
  f.rms_axis = (squares / n).cwiseSqrt() * unit;
  f.p95 = norms[static_cast<std::size_t>(0.95 * (n - 1))];
  f.max = norms.back();
  return f;
}

double mean_of(const std::vector<double>& x) {
  return x.empty() ? 0 : std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// How many independent samples a correlated series is worth: n / (1 + 2 sum of autocorrelations).
double independent_samples(const std::vector<double>& x) {
  const double mean = mean_of(x);
  double variance = 0;
  for (const double v : x) variance += (v - mean) * (v - mean);
  if (!(variance > 0)) return 1;
  double sum = 1;
  for (std::size_t lag = 1; lag < x.size() / 4; ++lag) {
    double c = 0;
    for (std::size_t i = lag; i < x.size(); ++i) c += (x[i] - mean) * (x[i - lag] - mean);
    if (c / variance < kCorrelationMin) break;
    sum += 2 * c / variance;
  }
  return std::max(1.0, static_cast<double>(x.size()) / sum);
}

/// The point of chi-square(n) / n at `z` standard deviations of the normal distribution, by Wilson and Hilferty (1931).
double chi_square_point(double n, double z) {
  const double cube_root = std::max(0.0, 1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n)));
  return cube_root * cube_root * cube_root;
}

/// The mean of a series of normalised squares, and what it may be by chance if they are chi-square(3) / 3.
struct Consistency {
  double mean, lower, upper;
};
Consistency consistency_of(const std::vector<double>& nees) {
  const double mean = mean_of(nees);
  if (std::isnan(mean)) return {mean, mean, mean};
  const double samples = 3 * independent_samples(nees);
  return {mean, chi_square_point(samples, -kNormal975), chi_square_point(samples, kNormal975)};
}

}  // namespace

void ValidationFigures::add(const SensedReport& sensed, const Report& report) {
  const double t = sensed.t;
  const bool pair = (sensed.led_in_view & 3U) == 3U;
  if (sensed.led_in_view != 0)
    blind_since_ = -1;
  else if (blind_since_ < 0)
    blind_since_ = t;
  if (blind_since_ >= 0 && t - blind_since_ > kBlindAfter) {
    ++blind_;
    valid_blind_ += report.valid ? 1 : 0;
  }
  if (pair && !had_pair_) pair_back_ = t;
  if (!pair) pair_back_ = -1;
  had_pair_ = pair;
  if (pair && report.valid && pair_back_ >= 0) {
    counts_.longest_return = std::max(counts_.longest_return, t - pair_back_);
    pair_back_ = -1;
  }
  ++counts_.reports;
  pair_in_view_ += pair ? 1 : 0;
  valid_in_view_ += pair && report.valid ? 1 : 0;
  counts_.reacquired += report.reacquired ? 1 : 0;

  const bool moving = had_truth_ && t > last_t_;
  const Vector3d velocity =
      moving ? Vector3d((sensed.X_LH.position - last_truth_) / (t - last_t_)) : Vector3d(Vector3d::Zero());
  if (report.valid) add_valid(sensed, report, velocity);
  had_truth_ = true;
  last_t_ = t;
  last_truth_ = sensed.X_LH.position;
}

void ValidationFigures::add_valid(const SensedReport& sensed, const Report& report, const Vector3d& velocity) {
  const Vector3d e = report.pose.position - sensed.X_LH.position;
  position_errors_.push_back(e);
  orientation_errors_.push_back(
      vector_from_rotation((report.pose.rotation * sensed.X_LH.rotation.conjugate()).normalized()));
  const Matrix3d covariance = report.covariance.topLeftCorner<3, 3>();
  nees_.push_back(e.dot(covariance.inverse() * e) / 3);
  const Matrix3d turned = report.covariance.bottomRightCorner<3, 3>();
  orientation_nees_.push_back(orientation_errors_.back().dot(turned.inverse() * orientation_errors_.back()) / 3);
  error_along_velocity_ += e.dot(velocity);
  velocity_square_ += velocity.squaredNorm();
}

ErrorSample error_of(const SensedReport& sensed, const Report& report) {
  ErrorSample sample{sensed.t, report.valid, 0, 0};
  if (!report.valid) return sample;
  sample.error = (report.pose.position - sensed.X_LH.position).norm();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(report.covariance.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  sample.bound_95 = std::sqrt(kChiSquare95 * std::max(0.0, axes.eigenvalues().maxCoeff()));
  return sample;
}

ValidationRow ValidationFigures::result() const {
  ValidationRow row = counts_;
  row.valid = static_cast<int>(position_errors_.size());
  row.position = figures_of(position_errors_, 1);
  row.orientation = figures_of(orientation_errors_, 1 / kDegree);
  row.availability = pair_in_view_ > 0 ? static_cast<double>(valid_in_view_) / pair_in_view_ : 1;
  row.false_validity = blind_ > 0 ? static_cast<double>(valid_blind_) / blind_ : 0;
  row.latency = velocity_square_ > 0 ? -error_along_velocity_ / velocity_square_ : 0;
  const Consistency position = consistency_of(nees_);
  row.nees = position.mean;
  row.nees_lower = position.lower;
  row.nees_upper = position.upper;
  const auto inside = std::count_if(nees_.begin(), nees_.end(), [](double n) { return 3 * n <= kChiSquare95; });
  row.within_95 = nees_.empty() ? 0 : static_cast<double>(inside) / static_cast<double>(nees_.size());
  if (std::isnan(row.nees)) row.within_95 = row.nees;  // no covariance
  row.consistent = row.nees <= row.nees_upper;
  const Consistency orientation = consistency_of(orientation_nees_);
  row.orientation_nees = orientation.mean;
  row.orientation_nees_lower = orientation.lower;
  row.orientation_nees_upper = orientation.upper;
  return row;
}

}  // namespace verisim::wii

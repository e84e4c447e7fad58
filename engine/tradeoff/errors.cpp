#include "engine/tradeoff/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::tradeoff {
namespace {

/// Sums over all windows and bodies.
struct Differences {
  double force_squares = 0, torque_squares = 0, true_squares = 0;
  double force_max = 0, torque_max = 0;
  std::size_t windows = 0;
};

Vector6d window_of(const std::vector<Vector6d>& wrench, std::size_t window) {
  return window < wrench.size() ? wrench[window] : Vector6d::Zero().eval();
}

Differences differences_of(const Motion& truth, const Motion& setting) {
  VERISIM_ASSERT(truth.bodies.size() == setting.bodies.size());
  Differences d;
  for (std::size_t b = 0; b < truth.bodies.size(); ++b) {
    VERISIM_ASSERT(truth.bodies[b].name == setting.bodies[b].name);
    const std::vector<Vector6d>& of_truth = truth.bodies[b].wrench;
    const std::vector<Vector6d>& of_setting = setting.bodies[b].wrench;
    const std::size_t windows = std::max(of_truth.size(), of_setting.size());
    for (std::size_t w = 0; w < windows; ++w) {
      const Vector6d truly = window_of(of_truth, w);
      const Vector6d off = window_of(of_setting, w) - truly;
      d.force_squares += off.head<3>().squaredNorm();
      d.torque_squares += off.tail<3>().squaredNorm();
      d.true_squares += truly.head<3>().squaredNorm();
      d.force_max = std::max(d.force_max, off.head<3>().norm());
      d.torque_max = std::max(d.torque_max, off.tail<3>().norm());
    }
    d.windows += windows;
  }
  return d;
}

double rms(double squares, std::size_t count) {
  return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace

void WindowMeans::add(double begin, double end, const Vector6d& wrench) {
  VERISIM_ASSERT(begin >= 0);
  VERISIM_ASSERT(begin < end);
  // A step that ends within a rounding of a window's end does not reach into the next one.
  const double slack = 1e-9 * kWindow;
  auto window = static_cast<std::size_t>((begin + slack) / kWindow);
  for (double from = begin; from < end - slack; ++window) {
    const double to = std::min(end, static_cast<double>(window + 1) * kWindow);
    if (means_.size() <= window) means_.resize(window + 1, Vector6d::Zero());
    means_[window] += std::max(0.0, to - from) / kWindow * wrench;
    from = std::max(from, to);
  }
}

Errors errors_of(const Motion& truth, const Motion& setting, bool flipped) {
  const Differences d = differences_of(truth, setting);
  Errors errors;
  const auto say = [&](Kind kind, double value) { errors[index_of(kind)] = value; };
  if (d.true_squares > 0) say(Kind::wrench, std::sqrt(d.force_squares / d.true_squares));
  say(Kind::force, rms(d.force_squares, d.windows));
  say(Kind::force_max, d.force_max);
  say(Kind::torque, rms(d.torque_squares, d.windows));
  say(Kind::torque_max, d.torque_max);
  double position = 0, rotation = 0;
  for (std::size_t b = 0; b < truth.bodies.size(); ++b) {
    const Pose& truly = truth.bodies[b].end;
    const Pose& found = setting.bodies[b].end;
    position = std::max(position, (found.position - truly.position).norm());
    rotation = std::max(rotation, vector_from_rotation(found.rotation * truly.rotation.conjugate()).norm());
  }
  say(Kind::position, position);
  say(Kind::rotation, rotation);
  say(Kind::overlap, setting.overlap);
  say(Kind::work, setting.work);
  say(Kind::flips, flipped ? 1 : 0);
  return errors;
}

double force_difference(const Motion& a, const Motion& b) {
  const Differences d = differences_of(a, b);
  return rms(d.force_squares, d.windows);
}

Convergence convergence_of(double coarse, double fine, double ratio) {
  VERISIM_ASSERT(std::isfinite(coarse));
  VERISIM_ASSERT(std::isfinite(fine));
  VERISIM_ASSERT(coarse >= 0);
  VERISIM_ASSERT(fine >= 0);
  VERISIM_ASSERT(ratio > 1);
  constexpr double kLeastOrder = 0.5;
  Convergence c{.coarse = coarse, .fine = fine, .order = 0, .converges = false, .error = fine};
  if (fine == 0) {
    c.order = std::numeric_limits<double>::infinity();
    c.converges = true;
    return c;
  }
  if (coarse == 0) {
    c.order = -std::numeric_limits<double>::infinity();
    return c;
  }
  c.order = pinned::log(coarse / fine) / pinned::log(ratio);
  c.converges = c.order > kLeastOrder;
  if (c.converges) c.error = fine / (pinned::pow(ratio, c.order) - 1);
  return c;
}

}  // namespace verisim::tradeoff

#include "engine/geometry/recover/fit_ambiguity.hpp"

#include <algorithm>
#include <vector>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

using pinned::kFullTurn;

/// Angles on a circle that are at least `apart` from each other [rad], ascending, the widest gap before the first.
std::vector<double> distinct_angles(std::vector<double> angles, double apart) {
  std::ranges::sort(angles);
  std::vector<double> different;
  for (const double angle : angles) {
    if (different.empty() || angle - different.back() > apart) different.push_back(angle);
  }
  if (different.size() < 2) return different;
  if (different.front() + kFullTurn - different.back() <= apart) different.pop_back();
  std::size_t first = 0;
  double widest = different.front() + kFullTurn - different.back();
  for (std::size_t i = 1; i < different.size(); ++i) {
    if (different[i] - different[i - 1] <= widest) continue;
    widest = different[i] - different[i - 1];
    first = i;
  }
  std::rotate(different.begin(), different.begin() + static_cast<std::ptrdiff_t>(first), different.end());
  for (std::size_t i = 1; i < different.size(); ++i) {
    if (different[i] < different[i - 1]) different[i] += kFullTurn;
  }
  return different;
}

/// True for five different places around a circle, or four at equal steps (places_min says how many).
bool determine_circle(const std::vector<double>& angles, double apart, const RecoverThresholds& thresholds) {
  const std::vector<double> at = distinct_angles(angles, apart);
  if (at.size() >= thresholds.places_min) return true;
  if (at.size() + 1 < thresholds.places_min) return false;
  const double mean = (at.back() - at.front()) / static_cast<double>(at.size() - 1);
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (std::abs(at[i] - at[i - 1] - mean) > thresholds.equal_step * mean) return false;
  }
  return true;
}

}  // namespace

bool is_unambiguous(const SurfaceValue& s, std::span<const Vector3d> points, double tolerance,
                    const RecoverThresholds& thresholds) {
  VERISIM_ASSERT(is_positive(tolerance));
  const double noise = thresholds.noise * tolerance;
  const double sagitta_min = thresholds.sagitta_min * tolerance;
  if (s.kind == Kind::plane) return true;
  if (s.kind == Kind::torus && std::abs(s.a) < sagitta_min) return false;  // a sphere, about any axis
  if (points.size() < thresholds.points_min[static_cast<std::size_t>(s.kind)]) return false;
  const SurfaceValue flat = plane_through(points);
  const bool is_curved =
      std::ranges::any_of(points, [&](const Vector3d& p) { return std::abs(flat.distance(p)) > sagitta_min; });
  if (!is_curved) return false;
  const Vector3d x = s.axis.unitOrthogonal(), y = s.axis.cross(x);
  std::vector<double> around, along;
  double largest = 0;
  for (const Vector3d& p : points) {
    const Profile f = profile_of(p, s.point, s.axis);
    largest = std::max(largest, f.rho);
    if (s.kind == Kind::torus) along.push_back(pinned::atan2(f.height, f.rho - s.a));
    if (s.kind == Kind::sphere) along.push_back(pinned::atan2(f.height, f.rho));
    if (f.rho > noise) around.push_back(pinned::atan2(f.outward.dot(y), f.outward.dot(x)));
  }
  const double across_radius = s.kind == Kind::torus ? s.b : s.a;
  const auto apart = [&](double radius) { return noise / std::max(radius, tolerance); };
  if (!determine_circle(around, apart(largest), thresholds)) return false;
  if (s.kind == Kind::cylinder || s.kind == Kind::cone) return true;
  return determine_circle(along, apart(across_radius), thresholds);
}

}  // namespace verisim::recover

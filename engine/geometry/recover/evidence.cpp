#include "engine/geometry/recover/evidence.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

constexpr std::size_t kEnough = 5;
/// Of each kind: through fewer it passes by chance, having 3, 5, 6, 4 and 7 parameters and a whole mesh to choose from.
constexpr std::array<std::size_t, 5> kFewest = {3, 8, 8, 9, 14};
constexpr double kFullTurn = 2 * pinned::kPi;

/// Places on a circle that are no nearer to each other than `apart`, ascending, the widest gap before the first.
std::vector<double> places(std::vector<double> angles, double apart) {
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

bool make_a_circle(const std::vector<double>& angles, double apart, double equal_step) {
  const std::vector<double> at = places(angles, apart);
  if (at.size() >= kEnough) return true;
  if (at.size() + 1 < kEnough) return false;
  const double mean = (at.back() - at.front()) / static_cast<double>(at.size() - 1);
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (std::abs(at[i] - at[i - 1] - mean) > equal_step * mean) return false;
  }
  return true;
}

}  // namespace

std::size_t fewest_points(Kind kind) {
  return kFewest[static_cast<std::size_t>(kind)];
}

bool is_evident(const SurfaceValue& s, std::span<const Vector3d> points, double tolerance,
                const RecoverThresholds& thresholds) {
  const double bulge = thresholds.bulge * tolerance;
  if (s.kind == Kind::plane) return true;
  if (s.kind == Kind::torus && std::abs(s.a) < bulge) return false;  // a sphere, about any axis
  if (points.size() < fewest_points(s.kind)) return false;
  const SurfaceValue flat = plane_through(points);
  const bool bulges =
      std::ranges::any_of(points, [&](const Vector3d& p) { return std::abs(flat.distance(p)) > bulge; });
  if (!bulges) return false;
  const Vector3d x = s.axis.unitOrthogonal(), y = s.axis.cross(x);
  std::vector<double> around, along;
  double largest = 0;
  for (const Vector3d& p : points) {
    const Profile f = profile_of(p, s.point, s.axis);
    largest = std::max(largest, f.rho);
    if (s.kind == Kind::torus) along.push_back(pinned::atan2(f.height, f.rho - s.a));
    if (s.kind == Kind::sphere) along.push_back(pinned::atan2(f.height, f.rho));
    if (f.rho > 4 * tolerance) around.push_back(pinned::atan2(f.outward.dot(y), f.outward.dot(x)));
  }
  const double across_radius = s.kind == Kind::torus ? s.b : s.a;
  const auto apart = [&](double radius) { return 4 * tolerance / std::max(radius, tolerance); };
  if (!make_a_circle(around, apart(largest), thresholds.equal_step)) return false;
  if (s.kind == Kind::cylinder || s.kind == Kind::cone) return true;
  return make_a_circle(along, apart(across_radius), thresholds.equal_step);
}

}  // namespace verisim::recover

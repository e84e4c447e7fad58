#include "engine/voxel/trim.hpp"

#include <algorithm>
#include <cmath>

namespace verisim {

namespace {

/// Grows with the angle of (x, y) from -x, from -2 to 2.
double turn_from_behind(double x, double y) {
  return 2 - turn_of(-x, y);
}

double distance_from_axis(const Vector3d& p) {
  return p.head<2>().norm();
}

double cross(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Does a turn about z from direction a, counter-clockwise, meet c before b?
bool meets_before(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const bool b_in_first_half = cross(a, b) > 0;
  const bool c_in_first_half = cross(a, c) > 0;
  if (b_in_first_half != c_in_first_half) return c_in_first_half;
  return cross(c, b) > 0;
}

}  // namespace

FaceTrim::FaceTrim(const GridSurface& surface, std::vector<GridCurve> bounds, const std::vector<Vector3d>& within,
                   double epsilon)
    : surface_(surface),
      bounds_(std::move(bounds)),
      epsilon_(epsilon),
      leg_normal_(surface.kind() == SurfaceKind::plane ? Vector3d::UnitY() : Vector3d::UnitZ()) {
  extents_.reserve(bounds_.size());
  for (const GridCurve& bound : bounds_) extents_.push_back(bound.extent(leg_normal_));
  for (const Vector3d& candidate : within) {
    if (!set_reference(candidate)) continue;
    has_reference_ = std::ranges::all_of(within, [&](const Vector3d& p) { return contains(p).value_or(false); });
    if (has_reference_) return;
  }
}

/// What grows along the second leg.
double FaceTrim::height(const Vector3d& local) const {
  switch (surface_.kind()) {
    case SurfaceKind::plane:
      return local.y();
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
    case SurfaceKind::sphere:
      return local.z();
    case SurfaceKind::torus:
      break;
  }
  return turn_from_behind(distance_from_axis(local) - surface_.meridian().ring, local.z());
}

/// A torus has two circles at one height.
bool FaceTrim::same_branch(const Vector3d& a, const Vector3d& b) const {
  if (surface_.kind() != SurfaceKind::torus) return true;
  const auto is_outer = [&](const Vector3d& p) { return distance_from_axis(p) > surface_.meridian().ring; };
  return is_outer(a) == is_outer(b);
}

bool FaceTrim::set_reference(const Vector3d& local) {
  const bool flat = surface_.kind() == SurfaceKind::plane;
  const double rho = distance_from_axis(local);
  if (!flat && rho <= epsilon_) return false;
  const Vector3d outward = flat ? Vector3d(0, 0, 0) : Vector3d(local.x() / rho, local.y() / rho, 0);
  const Vector3d normal = flat ? Vector3d(Vector3d::UnitX()) : Vector3d(-outward.y(), outward.x(), 0);
  std::vector<PlaneCrossing> crossings;
  for (const GridCurve& bound : bounds_) bound.cross(normal, flat ? local.x() : 0, epsilon_, crossings);
  meridian_.clear();
  for (const PlaneCrossing& crossing : crossings) {
    if (!flat && crossing.point.dot(outward) <= epsilon_) continue;  // the other half of the plane, or the axis
    if (!crossing.certain) return false;
    meridian_.push_back(height(crossing.point));
  }
  std::ranges::sort(meridian_);
  reference_ = local;
  return true;
}

bool FaceTrim::on_first_leg(const Vector3d& from, const Vector3d& crossing) const {
  if (surface_.kind() == SurfaceKind::plane) {
    return (crossing.x() < from.x()) != (crossing.x() < reference_.x());
  }
  return meets_before(from, reference_, crossing);
}

/// @param nudge  by how much the path is moved across the first leg
std::optional<bool> FaceTrim::ask(const Vector3d& local, double nudge) const {
  const double level = leg_normal_.dot(local) + nudge;
  std::size_t crossed = 0;
  std::vector<PlaneCrossing> crossings;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (level < extents_[i][0] - epsilon_ || level > extents_[i][1] + epsilon_) continue;
    bounds_[i].cross(leg_normal_, level, epsilon_, crossings);
  }
  for (const PlaneCrossing& crossing : crossings) {
    if (!crossing.certain) return std::nullopt;
    if (same_branch(local, crossing.point) && on_first_leg(local, crossing.point)) ++crossed;
  }
  Vector3d moved = local;
  moved += nudge * leg_normal_;
  const double from = height(moved), to = height(reference_);
  for (const double at : meridian_) {
    if (std::abs(at - from) <= epsilon_) return std::nullopt;
    if ((at < from) != (at < to)) ++crossed;
  }
  return crossed % 2 == 0;
}

// Bounds that touch the path, or end on it, are passed by at a little distance: no bound is that near to the point.
std::optional<bool> FaceTrim::contains(const Vector3d& local) const {
  constexpr std::array<double, 7> kNudges = {0, 2.5, -2.5, 5.5, -5.5, 13, -13};  // epsilons
  for (const double nudge : kNudges) {
    const std::optional<bool> answer = ask(local, nudge * epsilon_);
    if (answer) return answer;
  }
  return std::nullopt;
}

}  // namespace verisim

#include "engine/voxel/grid_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace verisim {

namespace {

constexpr double kDiagonal = 1.7320508075688772;  // half diagonal of a box per half side
constexpr double kSmallestHalf = 0x1p-22;         // boxes are not halved further: what is undecided here touches
constexpr double kOffSurface = 1e-6;              // voxel: rounding stays far below
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix3d rows(const AnalyticSurface& s) {
  Matrix3d m;
  m << s.x_axis().transpose(), s.y_axis().transpose(), s.axis().transpose();
  return m;
}

double from_axis(const Vector3d& local) {
  return std::sqrt(local.x() * local.x() + local.y() * local.y());
}

template <class Visit>
void for_each_corner(const GridBox& box, Visit visit) {
  for (int i = 0; i < 8; ++i) {
    const auto side = [&](int bit) { return (i >> bit & 1) != 0 ? box.half : -box.half; };
    visit(Vector3d(box.center + Vector3d(side(0), side(1), side(2))));
  }
}

/// Calls visit(middle, axis) for the twelve edges of a box.
template <class Visit>
void for_each_box_edge(const GridBox& box, Visit visit) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 4; ++i) {
      Vector3d middle = box.center;
      middle[(axis + 1) % 3] += (i & 1) != 0 ? box.half : -box.half;
      middle[(axis + 2) % 3] += (i & 2) != 0 ? box.half : -box.half;
      visit(middle, axis);
    }
  }
}

}  // namespace

std::optional<GridSurface> GridSurface::from(const Face& face, const Vector3d& origin, double scale) {
  const std::optional<AnalyticSurface> surface = AnalyticSurface::from(face);
  if (!surface) return std::nullopt;
  return GridSurface(surface->in_grid(origin, scale));
}

GridSurface::GridSurface(const AnalyticSurface& placed)
    : surface_(placed), origin_(placed.point()), axes_(rows(placed)), plane_extent_(axes_.row(2).cwiseAbs().sum()) {}

double GridSurface::value(const Vector3d& local) const {
  return meridian().distance(from_axis(local), local.z());
}

/// Where slope and curvature in a box's middle tell alone whether the surface passes. @param at  the middle's
std::optional<bool> GridSurface::touches_by_slope(const Vector3d& local, double rho, const MeridianAt& at,
                                                  double half) const {
  const double reach = kDiagonal * half;
  const double curvature = meridian().curvature_bound(rho, local.z(), reach);
  if (!(curvature < kInfinity)) return std::nullopt;
  const double bend = 0.5 * curvature * reach * reach;
  const double out = rho > 0 ? at.out / (at.length * rho) : 0;  // on the axis: of a sphere, whose slope is along it
  const Vector3d slope = axes_.transpose() * Vector3d(out * local.x(), out * local.y(), at.up / at.length);
  const double change = half * slope.cwiseAbs().sum();
  if (std::abs(at.distance) > change + bend) return false;
  if (std::abs(at.distance) <= change - bend) return true;
  return std::nullopt;
}

bool GridSurface::touches(const GridBox& box) const {
  const Vector3d local = to_local(box.center);
  if (kind() == SurfaceKind::plane) return std::abs(local.z()) <= box.half * plane_extent_;
  const double rho = from_axis(local);
  const MeridianAt at = meridian().at(rho, local.z());
  if (std::abs(at.distance) > kDiagonal * box.half) return false;
  if (const std::optional<bool> touches = touches_by_slope(local, rho, at, box.half)) return *touches;
  switch (kind()) {
    case SurfaceKind::plane:
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
      return convex_touches(box);
    case SurfaceKind::sphere:
      return sphere_touches(box);
    case SurfaceKind::torus:
      break;
  }
  std::array<bool, 2> signs = {false, false};
  return torus_touches(box, signs);
}

bool GridSurface::sphere_touches(const GridBox& box) const {
  const Vector3d arm = (box.center - origin_).cwiseAbs();
  const double nearest = (arm.array() - box.half).max(0).matrix().norm();
  const double farthest = (arm.array() + box.half).matrix().norm();
  return nearest <= meridian().radius && meridian().radius <= farthest;
}

/// Smallest value of a cylinder's or cone's function on the segment local + t step, |t| <= half. With w the derivative
/// of rho^2 / 2 it is where cos a w = sin a z' rho, or at an end.
double GridSurface::lowest_on_line(const Vector3d& local, const Vector3d& step, double half) const {
  const double a = step.x() * step.x() + step.y() * step.y();
  const double b = local.x() * step.x() + local.y() * step.y();
  const auto at = [&](double t) { return value(local + t * step); };
  double lowest = std::min(at(-half), at(half));
  const double pull = meridian().tangent * step.z();
  const double left = a - pull * pull;
  if (left > 0) {
    const double c = local.x() * local.x() + local.y() * local.y();
    const double offset = std::sqrt(std::max(a * c - b * b, 0.0) / left) * pull;
    const double t = (offset - b) / a;
    if (std::abs(t) < half) lowest = std::min(lowest, at(t));
  }
  return lowest;
}

/// Calls visit(point) where the axis enters or leaves the box.
template <class Visit>
void GridSurface::for_each_axis_entry(const GridBox& box, Visit visit) const {
  const Vector3d along = axes_.row(2).transpose();
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0) continue;
    for (const double side : {-box.half, box.half}) {
      Vector3d p = origin_ + (box.center[axis] + side - origin_[axis]) / along[axis] * along;
      p[axis] = box.center[axis] + side;
      if (box.contains(p)) visit(p, axis);
    }
  }
}

bool GridSurface::convex_touches(const GridBox& box) const {
  bool above = false, below = false;
  for_each_corner(box, [&](const Vector3d& corner) {
    const double here = value(to_local(corner));
    above |= here >= 0;
    below |= here <= 0;
  });
  if (!above) return false;
  if (below) return true;
  for_each_axis_entry(box, [&](const Vector3d& p, int) { below |= value(to_local(p)) <= 0; });
  if (below) return true;
  for_each_box_edge(box, [&](const Vector3d& middle, int axis) {
    below = below || lowest_on_line(to_local(middle), axes_.col(axis), box.half) <= 0;
  });
  return below;
}

/// `signs`: a value below zero, one above, has been seen in the box that was asked for first.
bool GridSurface::torus_touches(const GridBox& box, std::array<bool, 2>& signs) const {
  const Vector3d local = to_local(box.center);
  const double rho = from_axis(local);
  const MeridianAt at = meridian().at(rho, local.z());
  signs[at.distance < 0 ? 0 : 1] = true;
  if (signs[0] && signs[1]) return true;
  if (std::abs(at.distance) > kDiagonal * box.half) return false;
  if (const std::optional<bool> decided = touches_by_slope(local, rho, at, box.half)) return *decided;
  if (box.half < kSmallestHalf) return true;
  bool touches = false;
  for_each_corner({box.center, 0.5 * box.half}, [&](const Vector3d& center) {
    touches = touches || torus_touches({center, 0.5 * box.half}, signs);
  });
  return touches;
}

bool GridSurface::is_one_sheet(const Vector3d& center, double distance) const {
  const auto from_its_axis = [&] { return from_axis(to_local(center)); };
  const double radius = meridian().radius, ring = meridian().ring;
  switch (kind()) {
    case SurfaceKind::plane:
      return true;
    case SurfaceKind::cylinder:
    case SurfaceKind::sphere:
      return radius > distance;
    case SurfaceKind::cone:
      return from_its_axis() > 3 * distance;
    case SurfaceKind::torus:
      break;
  }
  const bool meets_itself = radius >= std::abs(ring);
  if (meets_itself && from_its_axis() <= 3 * distance) return false;  // near its tips
  return radius > distance && (meets_itself || ring - radius > distance);
}

// --- points in every piece ------------------------------------------------------------------------------------------

/// Sign changes between steps of a sixteenth, then halving: a torus meets a line up to four times.
void GridSurface::add_torus_roots(const Vector3d& local, const Vector3d& step, double half,
                                  std::vector<Vector3d>& probes) const {
  constexpr int kSteps = 16;
  constexpr int kHalvings = 40;
  const auto at = [&](double t) { return value(local + t * step); };
  for (int i = 0; i < kSteps; ++i) {
    double from = half * (2.0 * i / kSteps - 1), to = half * (2.0 * (i + 1) / kSteps - 1);
    const bool below = at(from) < 0;
    if (below == (at(to) < 0)) continue;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (from + to);
      ((at(middle) < 0) == below ? from : to) = middle;
    }
    probes.emplace_back(local + 0.5 * (from + to) * step);
  }
}

/// The surface's points on the line through `start` along a grid axis, within the box around start's place on it.
void GridSurface::add_roots(const GridBox& box, const Vector3d& start, int axis, std::vector<Vector3d>& probes) const {
  Vector3d middle = start;
  middle[axis] = box.center[axis];
  const Vector3d local = to_local(middle);
  const Vector3d step = axes_.col(axis);
  const double flat_a = step.x() * step.x() + step.y() * step.y();
  const double flat_b = step.x() * local.x() + step.y() * local.y();
  const double flat_c = local.x() * local.x() + local.y() * local.y();
  double a = 0, b = 0, c = 0;  // a t^2 + 2 b t + c = 0
  const double radius = meridian().radius, cosine = meridian().cosine, sine = meridian().sine;
  switch (kind()) {
    case SurfaceKind::plane:
      b = 0.5 * step.z();
      c = local.z();
      break;
    case SurfaceKind::cylinder:
      a = flat_a, b = flat_b, c = flat_c - radius * radius;
      break;
    case SurfaceKind::sphere:
      a = 1, b = step.dot(local), c = local.squaredNorm() - radius * radius;
      break;
    case SurfaceKind::cone: {
      const double width = cosine * radius + sine * local.z(), widening = sine * step.z();
      a = cosine * cosine * flat_a - widening * widening;
      b = cosine * cosine * flat_b - widening * width;
      c = cosine * cosine * flat_c - width * width;
      break;
    }
    case SurfaceKind::torus:
      return add_torus_roots(local, step, box.half, probes);
  }
  const double under = b * b - a * c;
  if (under < 0) return;
  const double q = -(b + (b < 0 ? -1 : 1) * std::sqrt(under));
  for (const double t : {q / a, c / q}) {  // of a line along the surface: neither is a number
    if (!(std::abs(t) <= box.half)) continue;
    const Vector3d p = local + t * step;
    const bool on_other_nappe = kind() == SurfaceKind::cone && cosine * radius + sine * p.z() < 0;
    if (!on_other_nappe) probes.push_back(p);
  }
}

/// Where a piece lies within a wall of the box without reaching the wall's rim, it has a point whose normal is a grid
/// axis (sphere, torus), surrounds the axis (cylinder, cone), or holds a place where the surface meets its axis.
void GridSurface::add_extremes(const GridBox& box, std::vector<Vector3d>& probes) const {
  const auto add = [&](const Vector3d& local) {
    const bool is_on = std::abs(value(local)) <= kOffSurface;
    if (is_on && box.contains(to_grid(local))) probes.push_back(local);
  };
  const auto add_around_axis = [&] {
    for_each_axis_entry(box, [&](const Vector3d& p, int axis) {
      add_roots(box, p, (axis + 1) % 3, probes);
      add_roots(box, p, (axis + 2) % 3, probes);
    });
  };
  const double radius = meridian().radius, ring = meridian().ring;
  switch (kind()) {
    case SurfaceKind::plane:
      return;
    case SurfaceKind::cylinder:
      return add_around_axis();
    case SurfaceKind::cone:
      add_around_axis();
      return add({0, 0, meridian().apex()});
    case SurfaceKind::sphere:
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {radius, -radius}) add(side * axes_.col(axis));
      }
      return;
    case SurfaceKind::torus:
      break;
  }
  if (radius > std::abs(ring)) {
    for (const double h : {meridian().apex(), -meridian().apex()}) add({0, 0, h});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = axes_.col(axis);
    const double rho = from_axis(direction);
    const Vector3d out = rho > 0 ? Vector3d(direction.x() / rho, direction.y() / rho, 0) : Vector3d(Vector3d::UnitX());
    for (const double core : {-ring, ring}) {
      for (const double side : {radius, -radius}) add(core * out + side * direction);
    }
  }
}

void GridSurface::add_probes(const GridBox& box, std::vector<Vector3d>& probes) const {
  const Vector3d nearest = surface_.foot(box.center);
  if (box.contains(nearest)) probes.push_back(to_local(nearest));
  if (kind() == SurfaceKind::plane && !probes.empty()) return;  // a plane cuts out one piece
  for_each_box_edge(box, [&](const Vector3d& middle, int axis) { add_roots(box, middle, axis, probes); });
  add_extremes(box, probes);
}

}  // namespace verisim

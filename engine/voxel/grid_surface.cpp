#include "engine/voxel/grid_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/pinned_math.hpp"

namespace verisim {

namespace {

constexpr double kDiagonal = 1.7320508075688772;  // half diagonal of a box per half side
constexpr double kSmallestHalf = 0x1p-22;         // boxes are not halved further: what is undecided here touches
constexpr double kOffSurface = 1e-6;              // voxel: rounding stays far below
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix3d rows(const Vector3d& x, const Vector3d& z) {
  Matrix3d m;
  m << x.transpose(), z.cross(x).transpose(), z.transpose();
  return m;
}

double from_axis(const Vector3d& local) {
  return std::sqrt(local.x() * local.x() + local.y() * local.y());
}

/// Unit vector away from the axis; on it, x.
Vector3d radial(const Vector3d& local, double rho) {
  return rho > 0 ? Vector3d(local.x() / rho, local.y() / rho, 0) : Vector3d(Vector3d::UnitX());
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

GridSurface::GridSurface(const Face& face, const Vector3d& origin, double scale) {
  const Surface& surface = face.surface;
  const auto place = [&](Shape shape, const Vector3d& point, const Vector3d& x, const Vector3d& z) {
    shape_ = shape;
    origin_ = scale * (point - origin);
    axes_ = rows(x, z);
  };
  if (const auto* plane = std::get_if<Plane>(&surface)) {
    place(Shape::plane, plane->point, plane->x_axis, plane->normal);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&surface)) {
    place(Shape::cylinder, cylinder->point, cylinder->x_axis, cylinder->direction);
    radius_ = scale * cylinder->radius;
  } else if (const auto* cone = std::get_if<Cone>(&surface)) {
    place(Shape::cone, cone->point, cone->x_axis, cone->direction);
    radius_ = scale * cone->radius;
    sine_ = pinned::sin(cone->half_angle);
    cosine_ = pinned::cos(cone->half_angle);
  } else if (const auto* sphere = std::get_if<Sphere>(&surface)) {
    place(Shape::sphere, sphere->center, sphere->x_axis, sphere->direction);
    radius_ = scale * sphere->radius;
  } else if (const auto* torus = std::get_if<Torus>(&surface)) {
    place(Shape::torus, torus->center, torus->x_axis, torus->direction);
    radius_ = scale * torus->major_radius;
    minor_ = scale * torus->minor_radius;
    const double middle = 0.5 * (face.v_range[0] + face.v_range[1]);
    if (radius_ + minor_ * pinned::cos(middle) < 0) radius_ = -radius_;
  }
  plane_extent_ = axes_.row(2).cwiseAbs().sum();
  const bool is_finite = origin_.allFinite() && axes_.allFinite() && std::isfinite(radius_ + minor_ + sine_ + cosine_);
  const bool fits =
      (radius_ >= 0 || shape_ == Shape::torus) && minor_ >= 0 && (shape_ != Shape::cone || (sine_ > 0 && cosine_ > 0));
  if (!is_finite || !fits) shape_ = Shape::other;
}

double GridSurface::value(const Vector3d& local) const {
  switch (shape_) {
    case Shape::plane:
      return local.z();
    case Shape::cylinder:
      return from_axis(local) - radius_;
    case Shape::cone:
      return cosine_ * (from_axis(local) - radius_) - sine_ * local.z();
    case Shape::sphere:
      return local.norm() - radius_;
    case Shape::torus: {
      const double out = from_axis(local) - radius_;
      return std::sqrt(out * out + local.z() * local.z()) - minor_;
    }
    case Shape::other:
      break;
  }
  return kInfinity;
}

Vector3d GridSurface::gradient(const Vector3d& local) const {
  const double rho = from_axis(local);
  switch (shape_) {
    case Shape::cylinder:
      return radial(local, rho);
    case Shape::cone:
      return cosine_ * radial(local, rho) - sine_ * Vector3d::UnitZ();
    case Shape::sphere: {
      const double length = local.norm();
      return length > 0 ? Vector3d(local / length) : Vector3d(Vector3d::UnitX());
    }
    case Shape::torus: {
      const double out = rho - radius_;
      const double from_core = std::sqrt(out * out + local.z() * local.z());
      if (from_core == 0) return radial(local, rho);
      return (out * radial(local, rho) + local.z() * Vector3d::UnitZ()) / from_core;
    }
    case Shape::plane:
    case Shape::other:
      break;
  }
  return Vector3d::UnitZ();
}

/// Of the second derivative along any direction, within `distance` of the point.
double GridSurface::curvature_bound(const Vector3d& local, double distance) const {
  const auto inverse = [&](double radius) { return radius > distance ? 1 / (radius - distance) : kInfinity; };
  switch (shape_) {
    case Shape::cylinder:
      return inverse(from_axis(local));
    case Shape::cone:
      return cosine_ * inverse(from_axis(local));
    case Shape::sphere:
      return inverse(local.norm());
    case Shape::torus:
      return std::max(inverse(value(local) + minor_), inverse(from_axis(local)));
    case Shape::plane:
    case Shape::other:
      break;
  }
  return 0;
}

bool GridSurface::touches(const GridBox& box) const {
  const Vector3d local = to_local(box.center);
  const double here = value(local);
  if (shape_ == Shape::plane) return std::abs(here) <= box.half * plane_extent_;
  const double reach = kDiagonal * box.half;
  if (!(std::abs(here) <= reach)) return false;  // also for `other`
  const double bend = 0.5 * curvature_bound(local, reach) * reach * reach;
  if (bend < kInfinity) {
    const Vector3d slope = axes_.transpose() * gradient(local);
    const double change = box.half * slope.cwiseAbs().sum();
    if (std::abs(here) > change + bend) return false;
    if (std::abs(here) <= change - bend) return true;
  }
  if (shape_ == Shape::sphere) return sphere_touches(box);
  if (shape_ != Shape::torus) return convex_touches(box);
  std::array<bool, 2> signs = {false, false};
  return torus_touches(box, signs);
}

bool GridSurface::sphere_touches(const GridBox& box) const {
  const Vector3d arm = (box.center - origin_).cwiseAbs();
  const double nearest = (arm.array() - box.half).max(0).matrix().norm();
  const double farthest = (arm.array() + box.half).matrix().norm();
  return nearest <= radius_ && radius_ <= farthest;
}

/// Smallest value of a cylinder's or cone's function on the segment local + t step, |t| <= half. With w the derivative
/// of rho^2 / 2 it is where cos a w = sin a z' rho, or at an end.
double GridSurface::lowest_on_line(const Vector3d& local, const Vector3d& step, double half) const {
  const double a = step.x() * step.x() + step.y() * step.y();
  const double b = local.x() * step.x() + local.y() * step.y();
  const auto at = [&](double t) { return value(local + t * step); };
  double lowest = std::min(at(-half), at(half));
  const double pull = sine_ / cosine_ * step.z();
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
  const double here = value(local);
  signs[here < 0 ? 0 : 1] = true;
  if (signs[0] && signs[1]) return true;
  const double reach = kDiagonal * box.half;
  if (std::abs(here) > reach) return false;
  const double bend = 0.5 * curvature_bound(local, reach) * reach * reach;
  if (bend < kInfinity) {
    const Vector3d slope = axes_.transpose() * gradient(local);
    const double change = box.half * slope.cwiseAbs().sum();
    if (std::abs(here) > change + bend) return false;
    if (std::abs(here) <= change - bend) return true;
  }
  if (box.half < kSmallestHalf) return true;
  bool touches = false;
  for_each_corner({box.center, 0.5 * box.half}, [&](const Vector3d& center) {
    touches = touches || torus_touches({center, 0.5 * box.half}, signs);
  });
  return touches;
}

/// A cone's height where it meets its axis; of a torus that meets itself, half the distance of the two places.
double GridSurface::axis_meeting() const {
  if (shape_ == Shape::cone) return -radius_ * cosine_ / sine_;
  return std::sqrt(std::max(minor_ * minor_ - radius_ * radius_, 0.0));
}

bool GridSurface::is_one_sheet(const Vector3d& center, double distance) const {
  switch (shape_) {
    case Shape::plane:
      return true;
    case Shape::cylinder:
    case Shape::sphere:
      return radius_ > distance;
    case Shape::cone:
      return from_axis(to_local(center)) > 3 * distance;
    case Shape::torus:
      if (minor_ >= std::abs(radius_) && from_axis(to_local(center)) <= 3 * distance) return false;  // near its tips
      return minor_ > distance && (minor_ >= std::abs(radius_) || radius_ - minor_ > distance);
    case Shape::other:
      break;
  }
  return false;
}

Vector3d GridSurface::projected(const Vector3d& local) const {
  Vector3d foot = local - value(local) * gradient(local);
  if (shape_ == Shape::cone && foot.z() < axis_meeting()) return {0, 0, axis_meeting()};
  if (shape_ == Shape::torus && std::abs(value(foot)) > kOffSurface) {  // beyond the axis, where it meets itself
    return {0, 0, local.z() < 0 ? -axis_meeting() : axis_meeting()};
  }
  return foot;
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
  if (shape_ == Shape::torus) return add_torus_roots(local, step, box.half, probes);
  const double flat_a = step.x() * step.x() + step.y() * step.y();
  const double flat_b = step.x() * local.x() + step.y() * local.y();
  const double flat_c = local.x() * local.x() + local.y() * local.y();
  double a = 0, b = 0, c = 0;  // a t^2 + 2 b t + c = 0
  if (shape_ == Shape::plane) {
    b = 0.5 * step.z();
    c = local.z();
  } else if (shape_ == Shape::cylinder) {
    a = flat_a, b = flat_b, c = flat_c - radius_ * radius_;
  } else if (shape_ == Shape::sphere) {
    a = 1, b = step.dot(local), c = local.squaredNorm() - radius_ * radius_;
  } else {
    const double width = cosine_ * radius_ + sine_ * local.z(), widening = sine_ * step.z();
    a = cosine_ * cosine_ * flat_a - widening * widening;
    b = cosine_ * cosine_ * flat_b - widening * width;
    c = cosine_ * cosine_ * flat_c - width * width;
  }
  const double under = b * b - a * c;
  if (under < 0) return;
  const double q = -(b + (b < 0 ? -1 : 1) * std::sqrt(under));
  for (const double t : {q / a, c / q}) {  // of a line along the surface: neither is a number
    if (!(std::abs(t) <= box.half)) continue;
    const Vector3d p = local + t * step;
    const bool on_other_nappe = shape_ == Shape::cone && cosine_ * radius_ + sine_ * p.z() < 0;
    if (!on_other_nappe) probes.push_back(p);
  }
}

/// Where a piece lies within a wall of the box without reaching the wall's rim, it has a point whose normal is a grid
/// axis (sphere, torus), surrounds the axis (cylinder, cone), or holds a place where the surface meets its axis.
void GridSurface::add_extremes(const GridBox& box, std::vector<Vector3d>& probes) const {
  const auto add = [&](const Vector3d& local) {
    const bool is_on = std::abs(value(local)) <= kOffSurface;
    if (is_on && box.contains(origin_ + axes_.transpose() * local)) probes.push_back(local);
  };
  if (shape_ == Shape::cylinder || shape_ == Shape::cone) {
    for_each_axis_entry(box, [&](const Vector3d& p, int axis) {
      add_roots(box, p, (axis + 1) % 3, probes);
      add_roots(box, p, (axis + 2) % 3, probes);
    });
    if (shape_ == Shape::cone) add({0, 0, axis_meeting()});
    return;
  }
  if (shape_ == Shape::torus && minor_ > std::abs(radius_)) {
    add({0, 0, axis_meeting()});
    add({0, 0, -axis_meeting()});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = axes_.col(axis);
    if (shape_ == Shape::sphere) {
      add(radius_ * direction);
      add(-radius_ * direction);
    } else if (shape_ == Shape::torus) {
      const Vector3d out = radius_ * radial(direction, from_axis(direction));
      for (const double core : {-1.0, 1.0}) {
        add(core * out + minor_ * direction);
        add(core * out - minor_ * direction);
      }
    }
  }
}

void GridSurface::add_probes(const GridBox& box, std::vector<Vector3d>& probes) const {
  const Vector3d nearest = projected(to_local(box.center));
  if (box.contains(origin_ + axes_.transpose() * nearest)) probes.push_back(nearest);
  if (shape_ == Shape::plane && !probes.empty()) return;  // a plane cuts out one piece
  for_each_box_edge(box, [&](const Vector3d& middle, int axis) { add_roots(box, middle, axis, probes); });
  if (shape_ != Shape::plane) add_extremes(box, probes);
}

}  // namespace verisim

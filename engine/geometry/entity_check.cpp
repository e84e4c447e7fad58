#include "engine/geometry/entity_check.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

using Fault = std::optional<std::string>;

constexpr double kUnit = 1e-6;  // a direction's length, and the cosine of a right angle, may be off by this

Fault fault_of_place(const char* name, const Vector3d& p) {
  if (p.allFinite()) return std::nullopt;
  return fmt::format("has a {} that is not finite; give all of its coordinates", name);
}

Fault fault_of_direction(const char* name, const Vector3d& v) {
  if (std::abs(v.norm() - 1) <= kUnit) return std::nullopt;
  if (!v.allFinite()) return fmt::format("has a {} that is not finite; give all of its components", name);
  return fmt::format("has a {} of length {} but it must be of length 1", name, v.norm());
}

Fault fault_of_axes(const char* name, const Vector3d& axis, const Vector3d& x_axis) {
  if (Fault fault = fault_of_direction(name, axis)) return fault;
  if (Fault fault = fault_of_direction("x axis", x_axis)) return fault;
  if (std::abs(axis.dot(x_axis)) <= kUnit) return std::nullopt;
  return fmt::format("has an x axis that is not square to its {}; give one that is", name);
}

Fault fault_of_radius(const char* name, double radius, bool may_be_zero = false) {
  if (!std::isfinite(radius)) return fmt::format("has a {} that is not finite; give a number", name);
  if (radius > 0 || (may_be_zero && radius == 0)) return std::nullopt;
  return fmt::format("has a {} of {} m but it must be {}", name, radius, may_be_zero ? "0 or more" : "above 0");
}

Fault fault_of_half_angle(double angle) {
  if (!std::isfinite(angle)) return "has a half angle that is not finite; give a number";
  if (angle > 0 && angle < 0.5 * pinned::kPi) return std::nullopt;
  return fmt::format("has a half angle of {} rad but it must be above 0 and below pi/2, 90 degrees", angle);
}

/// The first fault of several, in the order in which they are given.
template <typename... Faults>
Fault first_of(Faults... faults) {
  Fault first;
  static_cast<void>(((first = std::move(faults)) || ...));
  return first;
}

}  // namespace

std::optional<std::string> fault_of(const Surface& surface) {
  return std::visit(
      Overloaded{[](const Plane& s) {
                   return first_of(fault_of_place("point", s.point), fault_of_axes("normal", s.normal, s.x_axis));
                 },
                 [](const Cylinder& s) {
                   return first_of(fault_of_place("center", s.point), fault_of_axes("normal", s.direction, s.x_axis),
                                   fault_of_radius("radius", s.radius));
                 },
                 [](const Cone& s) {
                   return first_of(fault_of_place("center", s.point), fault_of_axes("normal", s.direction, s.x_axis),
                                   fault_of_radius("radius", s.radius, true), fault_of_half_angle(s.half_angle));
                 },
                 [](const Sphere& s) {
                   return first_of(fault_of_place("center", s.center), fault_of_axes("normal", s.direction, s.x_axis),
                                   fault_of_radius("radius", s.radius));
                 },
                 [](const Torus& s) {
                   return first_of(fault_of_place("center", s.center), fault_of_axes("normal", s.direction, s.x_axis),
                                   fault_of_radius("major radius", s.major_radius),
                                   fault_of_radius("minor radius", s.minor_radius));
                 },
                 [](const OtherSurface&) { return Fault(); }},
      surface);
}

std::optional<std::string> fault_of(const Curve& curve) {
  return std::visit(
      Overloaded{[](const Line& c) {
                   return first_of(fault_of_place("point", c.point), fault_of_direction("direction", c.direction));
                 },
                 [](const Circle& c) {
                   return first_of(fault_of_place("center", c.center), fault_of_axes("normal", c.normal, c.x_axis),
                                   fault_of_radius("radius", c.radius));
                 },
                 [](const Ellipse& c) {
                   return first_of(fault_of_place("center", c.center), fault_of_axes("normal", c.normal, c.x_axis),
                                   fault_of_radius("major radius", c.major_radius),
                                   fault_of_radius("minor radius", c.minor_radius));
                 },
                 [](const OtherCurve&) { return Fault(); }},
      curve);
}

}  // namespace verisim

// A piece of a solid's face to second order, and what a divider is on it at most and at least. Private to this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "engine/base/pinned_math.hpp"
#include "engine/ruler/csg.hpp"
#include "engine/ruler/polygon.hpp"

namespace verisim::ruler {

struct Piece {
  std::uint32_t face = 0;
  double u = 0, v = 0, half_u = 0, half_v = 0;  ///< middle and half sizes of its parameters
  double limit = 0;                             ///< no point of it is deeper
  std::uint32_t number = 0;
  bool operator<(const Piece& other) const {  // the deepest first; of equals the older one
    return limit != other.limit ? limit < other.limit : number > other.number;
  }
};

/// What a patch of a surface of revolution is around its axis; s goes around it, t along the meridian.
struct Round {
  Vector3d origin, axis;
  double half_u = 0;        ///< rad, of the angle s
  double rho_min = 0;       ///< m, least distance from the axis
  double speed_v = 0;       ///< m, the derivative along t, at most
  double bend_v = 0;        ///< m, the second one, at most; of an arc the third is bend_v^2 / speed_v
  bool has_centre = false;  ///< a sphere's, at the origin
};

/// A piece as p(s, t), s and t in [-1, 1], to second order: middle + s a + t b + (s^2 aa + 2 s t ab + t^2 bb) / 2.
/// Along any straight way from the middle to a point of the square, over a parameter from 0 to 1, no derivative is
/// longer than `first`, `second` and `third` [m].
struct Patch {
  Vector3d middle, a, b;
  Vector3d aa = Vector3d::Zero(), ab = Vector3d::Zero(), bb = Vector3d::Zero();
  double first = 0, second = 0, third = 0;
  Vector3d normal = Vector3d::Zero();  ///< unit, of a patch that bends within a plane; else zero
  std::optional<Round> round{};
  [[nodiscard]] double radius() const { return first; }
  [[nodiscard]] double bent() const { return 0.5 * second; }
};

[[nodiscard]] inline Patch patch_of(const Csg& solid, const Piece& piece) {
  const Face& face = solid.faces()[piece.face];
  const Divider& d = solid.dividers()[face.divider];
  const double u = piece.u, v = piece.v, hu = piece.half_u, hv = piece.half_v;
  if (d.kind == Divider::Kind::plane && !face.is_polar)
    return {.middle = face.origin + u * face.x + v * face.y,
            .a = hu * face.x,
            .b = hv * face.y,
            .first = hypotenuse(hu, hv)};
  const Vector3d out = pinned::cos(u) * face.x + pinned::sin(u) * face.y;
  const Vector3d on = pinned::cos(u) * face.y - pinned::sin(u) * face.x;
  const double r = d.radius;
  switch (d.kind) {
    case Divider::Kind::plane: {
      const double far = v + hv;  // m, from the middle
      return {.middle = face.origin + v * out,
              .a = hu * v * on,
              .b = hv * out,
              .aa = -v * hu * hu * out,
              .ab = hu * hv * on,
              .first = hypotenuse(far * hu, hv),
              .second = 2 * hv * hu + far * hu * hu,
              .third = 3 * hv * hu * hu + far * hu * hu * hu,
              .normal = face.z,
              .round = Round{face.origin, face.z, hu, v - hv, hv, 0}};
    }
    case Divider::Kind::cylinder:
      return {.middle = face.origin + r * out + v * face.z,
              .a = hu * r * on,
              .b = hv * face.z,
              .aa = -r * hu * hu * out,
              .first = hypotenuse(r * hu, hv),
              .second = r * hu * hu,
              .third = r * hu * hu * hu,
              .round = Round{face.origin, face.z, hu, r, hv, 0}};
    case Divider::Kind::cone: {
      const double far = (v + hv) * d.sine;  // m, largest radius
      const Vector3d along = d.sine * out + d.cosine * face.z;
      return {.middle = face.origin + v * along,
              .a = hu * v * d.sine * on,
              .b = hv * along,
              .aa = -v * d.sine * hu * hu * out,
              .ab = hu * hv * d.sine * on,
              .first = hypotenuse(far * hu, hv),
              .second = 2 * hv * hu * d.sine + far * hu * hu,
              .third = 3 * hv * hu * hu * d.sine + far * hu * hu * hu,
              .round = Round{face.origin, face.z, hu, (v - hv) * d.sine, hv, 0}};
    }
    case Divider::Kind::torus: {
      const double c = pinned::cos(v), s = pinned::sin(v);
      const double c_max = std::min(1.0, std::abs(c) + hv), s_max = std::min(1.0, std::abs(s) + hv);
      const double far = d.ring + r * std::min(1.0, c + hv), rho = d.ring + r * c;  // m, from the axis
      const Vector3d normal = c * out + s * face.z;
      return {.middle = face.origin + d.ring * out + r * normal,
              .a = hu * rho * on,
              .b = hv * r * (c * face.z - s * out),
              .aa = -rho * hu * hu * out,
              .ab = -r * s * hu * hv * on,
              .bb = -r * hv * hv * normal,
              .first = hypotenuse(far * hu, r * hv),
              .second = far * hu * hu + r * (2 * s_max * hu * hv + hv * hv),
              .third = far * hu * hu * hu + r * (3 * s_max * hu * hu * hv + 3 * c_max * hu * hv * hv + hv * hv * hv),
              .round = Round{face.origin, face.z, hu, d.ring + r * std::max(-1.0, c - hv), r * hv, r * hv * hv}};
    }
    default: {
      const double c = pinned::cos(v), s = pinned::sin(v);
      const double c_max = std::min(1.0, c + hv), s_max = std::min(1.0, std::abs(s) + hv);
      const Vector3d normal = c * out + s * face.z;
      return {.middle = face.origin + r * normal,
              .a = hu * r * c * on,
              .b = hv * r * (c * face.z - s * out),
              .aa = -r * c * hu * hu * out,
              .ab = -r * s * hu * hv * on,
              .bb = -r * hv * hv * normal,
              .first = r * hypotenuse(c_max * hu, hv),
              .second = r * (c_max * hu * hu + 2 * s_max * hu * hv + hv * hv),
              .third = r * (c_max * hu * hu * hu + 3 * s_max * hu * hu * hv + 3 * c_max * hu * hv * hv + hv * hv * hv),
              .round = Round{face.origin, face.z, hu, r * std::max(0.0, c - hv), r * hv, r * hv * hv, true}};
    }
  }
}

/// A divider's value on a patch, times a sign: no more than linear + above, no less than linear - below.
struct Model {
  Linear linear;
  double above = 0, below = 0;
  [[nodiscard]] Model operator-() const { return {{-linear.at, -linear.du, -linear.dv}, below, above}; }
};

/// Of a plane on a patch of a plane: how the patch bends matters as far as it goes across the other.
[[nodiscard]] inline Model model_of_planes(const Divider& divider, const Patch& patch, Model model) {
  const double slope = patch.normal.cross(divider.axis).norm();
  model.above = model.below = slope * patch.bent();
  return model;
}

[[nodiscard]] inline Model model_of(const Divider& divider, const Patch& patch, double sign) {
  const Local local = local_at(divider, patch.middle);
  Model model{{sign * local.value, sign * local.gradient.dot(patch.a), sign * local.gradient.dot(patch.b)}};
  const bool is_plane = divider.kind == Divider::Kind::plane;
  if (is_plane && patch.normal != Vector3d::Zero()) return model_of_planes(divider, patch, model);
  const double wide = is_plane ? 0 : across(divider, patch.a) + across(divider, patch.b) + patch.bent();
  // Value and linear model each change by no more than the way.
  model.above = model.below = 2 * patch.first;
  const double least_radius = local.bend_radius - wide;
  if (least_radius <= 0) return model;
  const double second = (is_plane ? 0 : 0.5 * wide * wide / least_radius) + patch.bent();
  model.above = model.below = std::min(model.above, second);
  // The second derivatives as they are, and a bound of the third along any way p from the middle, by the chain rule:
  // D3g(p', p', p') + 3 D2g(p', p'') + Dg(p''').
  const auto twice = [&](const Vector3d& a, const Vector3d& b, const Vector3d& ab) {
    return sign * (local.gradient.dot(ab) + bend(divider, patch.middle, local, a, b));
  };
  const double aa = twice(patch.a, patch.a, patch.aa), ab = twice(patch.a, patch.b, patch.ab),
               bb = twice(patch.b, patch.b, patch.bb);
  const double speed = is_plane ? 0 : wide + patch.bent();  // of p across the axis, at most
  const double ways = is_plane ? 0 : speed / least_radius;
  const double third = (third_factor(divider) * ways * ways * speed + 3 * ways * patch.second + patch.third) / 6;
  model.above = std::min(model.above, 0.5 * std::max(0.0, aa) + 0.5 * std::max(0.0, bb) + std::abs(ab) + third);
  model.below = std::min(model.below, 0.5 * std::max(0.0, -aa) + 0.5 * std::max(0.0, -bb) + std::abs(ab) + third);
  return model;
}

}  // namespace verisim::ruler

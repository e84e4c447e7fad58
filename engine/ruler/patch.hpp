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

/// Directions from a face's axis at the middle of a piece: out, and on around it.
struct Around {
  Vector3d out, on;
};

/// Of a cone from its apex; of half a right angle twice, a plane in polar coordinates.
[[nodiscard]] inline Patch cone_patch(const Face& face, const Piece& piece, const Around& at, double sine,
                                      double cosine) {
  const double v = piece.v, hu = piece.half_u, hv = piece.half_v;
  const double far = (v + hv) * sine;  // m, largest radius
  const Vector3d along = sine * at.out + cosine * face.z;
  return {.middle = face.origin + v * along,
          .a = hu * v * sine * at.on,
          .b = hv * along,
          .aa = -v * sine * hu * hu * at.out,
          .ab = hu * hv * sine * at.on,
          .first = hypotenuse(far * hu, hv),
          .second = 2 * hv * hu * sine + far * hu * hu,
          .third = 3 * hv * hu * hu * sine + far * hu * hu * hu,
          .normal = face.is_polar ? face.z : Vector3d(Vector3d::Zero()),
          .round = Round{face.origin, face.z, hu, (v - hv) * sine, hv, 0}};
}

/// Of a torus; of one without a ring, a sphere.
[[nodiscard]] inline Patch tube_patch(const Face& face, const Piece& piece, const Around& at, double ring, double r) {
  const double v = piece.v, hu = piece.half_u, hv = piece.half_v;
  const double c = pinned::cos(v), s = pinned::sin(v);
  const double c_max = std::min(1.0, std::abs(c) + hv), s_max = std::min(1.0, std::abs(s) + hv);
  const double far = ring + r * std::min(1.0, c + hv), rho = ring + r * c;  // m, from the axis
  const double rho_min = std::max(0.0, ring + r * std::max(-1.0, c - hv));
  const Vector3d normal = c * at.out + s * face.z;
  return {.middle = face.origin + ring * at.out + r * normal,
          .a = hu * rho * at.on,
          .b = hv * r * (c * face.z - s * at.out),
          .aa = -rho * hu * hu * at.out,
          .ab = -r * s * hu * hv * at.on,
          .bb = -r * hv * hv * normal,
          .first = hypotenuse(far * hu, r * hv),
          .second = far * hu * hu + r * (2 * s_max * hu * hv + hv * hv),
          .third = far * hu * hu * hu + r * (3 * s_max * hu * hu * hv + 3 * c_max * hu * hv * hv + hv * hv * hv),
          .round = Round{face.origin, face.z, hu, rho_min, r * hv, r * hv * hv, ring == 0}};
}

[[nodiscard]] inline Patch patch_of(const Csg& solid, const Piece& piece) {
  const Face& face = solid.faces()[piece.face];
  const Divider& d = solid.dividers()[face.divider];
  const double u = piece.u, v = piece.v, hu = piece.half_u, hv = piece.half_v;
  const Around at{pinned::cos(u) * face.x + pinned::sin(u) * face.y, pinned::cos(u) * face.y - pinned::sin(u) * face.x};
  switch (d.kind) {
    case Divider::Kind::plane:
      if (face.is_polar) return cone_patch(face, piece, at, 1, 0);
      return {.middle = face.origin + u * face.x + v * face.y,
              .a = hu * face.x,
              .b = hv * face.y,
              .first = hypotenuse(hu, hv)};
    case Divider::Kind::cylinder:
      return {.middle = face.origin + d.radius * at.out + v * face.z,
              .a = hu * d.radius * at.on,
              .b = hv * face.z,
              .aa = -d.radius * hu * hu * at.out,
              .first = hypotenuse(d.radius * hu, hv),
              .second = d.radius * hu * hu,
              .third = d.radius * hu * hu * hu,
              .round = Round{face.origin, face.z, hu, d.radius, hv, 0}};
    case Divider::Kind::cone:
      return cone_patch(face, piece, at, d.sine, d.cosine);
    case Divider::Kind::sphere:
      return tube_patch(face, piece, at, 0, d.radius);
    case Divider::Kind::torus:
      break;
  }
  return tube_patch(face, piece, at, d.ring, d.radius);
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

// A round divider on a round patch that has nearly the same axis: a pin in its bore, a ball in its bowl, a rim at a
// hole. There the plain model's remainder, of the third order in the patch's angle, is far more than the surfaces are
// apart, for what they differ in is small all around. Private to this folder.
//
// Let M be a small motion that brings the divider B onto the patch's axis: g_B(x) = g_B'(M x), and M x = x + d(x) with
// |d| <= e. With B' coaxial, g_B'(p(s, t)) does not depend on the angle s, and
//   g_B(p) = g_B'(p) + grad g_B'(p) d(p) + rest,  |rest| <= e^2 / (2 (m - e)), m the least radius in which B' bends,
// where the middle term is linear in s and t but for e times the square of the angles.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/ruler/patch.hpp"

namespace verisim::ruler {

/// A divider's value on a patch, as Model says; nothing where the axes are not near each other.
class Coaxial {
 public:
  Coaxial(const Divider& divider, const Patch& patch) : patch_(patch), moved_(divider) {
    if (!patch.round || divider.kind == Divider::Kind::plane) return;
    if (!move(divider)) return;
    local_ = local_at(moved_, patch.middle);
    // Along the meridian alone the distance to a centre or a ring changes.
    const bool has_centre = moved_.kind == Divider::Kind::sphere || moved_.kind == Divider::Kind::torus;
    const double from_centre = moved_.kind == Divider::Kind::torus ? local_.value + moved_.radius : local_.bend_radius;
    least_radius_ = patch.round->rho_min;
    if (has_centre) {
      const double least = from_centre - patch.round->speed_v;
      if (least <= 0) return;
      least_radius_ = moved_.kind == Divider::Kind::sphere ? least : std::min(least_radius_, least);
      centre_ = least;
      turn_ = patch.round->speed_v / least;
      turn_rate_ = patch.round->bend_v / least + turn_ * turn_;
    }
    is_near_ = way_ < 0.5 * least_radius_;
  }

  [[nodiscard]] std::optional<Model> model() const {
    if (!is_near_) return {};
    const Vector3d& gradient = local_.gradient;
    const Vector3d d = shift_of(patch_.middle) - patch_.middle;
    const Vector3d d_s = turned(patch_.a) - patch_.a, d_t = turned(patch_.b) - patch_.b;
    const auto bent = [&](const Vector3d& a, const Vector3d& b) { return bend(moved_, patch_.middle, local_, a, b); };
    Model model;
    model.linear = {local_.value + gradient.dot(d), bent(patch_.a, d) + gradient.dot(d_s),
                    gradient.dot(patch_.b) + bent(patch_.b, d) + gradient.dot(d_t)};
    const double around = patch_.round->half_u + turn_;  // rad, that the gradient turns
    const double cross =
        0.5 * (way_ * (around * around + turn_rate_) + 2 * around * angle_ * patch_.first + angle_ * patch_.second);
    const double rest = 0.5 * way_ * way_ / (least_radius_ - way_);
    const auto [up, down] = along_meridian();
    model.above = up + cross + rest;
    model.below = down + cross + rest;
    return model;
  }

 private:
  /// Sets the motion, and how far it takes the patch's points. False: the axes are not near each other.
  bool move(const Divider& divider) {
    const Vector3d& z = patch_.round->axis;
    const Vector3d& origin = patch_.round->origin;
    Vector3d near = divider.point;
    if (divider.kind == Divider::Kind::sphere) {
      moved_.axis = z;
    } else {
      const double cosine = divider.axis.dot(z);
      moved_.axis = cosine < 0 ? Vector3d(-z) : z;
      angle_ = (divider.axis - moved_.axis).norm();
      if (angle_ > 0.2) return false;
      rotation_ = turn_between(divider.axis, moved_.axis);
      near += divider.axis.dot(patch_.middle - divider.point) * divider.axis;
    }
    from_ = near;
    // A centre goes to the patch's own one, where that has one; what lies on an axis stays as high as it is.
    const bool has_centres = patch_.round->has_centre && divider.kind == Divider::Kind::sphere;
    to_ = has_centres ? origin : Vector3d(origin + z.dot(near - origin) * z);
    moved_.point = shift_of(divider.point);
    way_ = (to_ - from_).norm() + angle_ * ((patch_.middle - from_).norm() + patch_.first);
    return true;
  }
  [[nodiscard]] Vector3d turned(const Vector3d& x) const { return rotation_ * x; }
  [[nodiscard]] Vector3d shift_of(const Vector3d& x) const { return to_ + turned(x - from_); }

  /// What g_B' is above its linear model along the meridian, and below.
  [[nodiscard]] std::pair<double, double> along_meridian() const {
    const bool has_centre = moved_.kind == Divider::Kind::sphere || moved_.kind == Divider::Kind::torus;
    if (!has_centre && patch_.round->bend_v == 0) return {0, 0};
    if (patch_.round->has_centre && moved_.kind == Divider::Kind::sphere && to_ == patch_.round->origin) return {0, 0};
    const double v = patch_.round->speed_v, vv = patch_.round->bend_v;
    const double second = local_.gradient.dot(patch_.bb) + bend(moved_, patch_.middle, local_, patch_.b, patch_.b);
    // Of the third order: 1.1548 v^3/m^2 + 3 v vv/m + vvv, with the meridian's angle as the parameter of a round patch.
    const double vvv = v > 0 ? vv * vv / v : 0, m = centre_;
    const double third = (1.1548 * v * v * v / (m * m) + 3 * v * vv / m + vvv) / 6;
    return {0.5 * std::max(0.0, second) + third, 0.5 * std::max(0.0, -second) + third};
  }

  static constexpr double kFar = 1e30;  // m: no bend
  const Patch& patch_;
  Divider moved_;
  Local local_{};
  Quaterniond rotation_ = Quaterniond::Identity();
  Vector3d from_ = Vector3d::Zero(), to_ = Vector3d::Zero();
  double angle_ = 0, way_ = 0;       ///< of the motion [rad; m, of the patch's points]
  double turn_ = 0, turn_rate_ = 0;  ///< of the gradient along the meridian [rad]
  double least_radius_ = 0;
  double centre_ = kFar;  ///< m, from it or from the ring at least, where there is one
  bool is_near_ = false;
};

/// A divider's value on a patch, times a sign, by the better one of the two models.
[[nodiscard]] inline Model best_model_of(const Divider& divider, const Patch& patch) {
  const Model plain = model_of(divider, patch, 1);
  const std::optional<Model> coaxial = Coaxial(divider, patch).model();
  return coaxial && coaxial->above + coaxial->below < plain.above + plain.below ? *coaxial : plain;
}

}  // namespace verisim::ruler

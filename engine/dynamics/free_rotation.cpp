#include "engine/dynamics/free_rotation.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

/// A turn of the body about its own axes, and L as the body sees it.
struct Turning {
  const Matrix3d& axes_B;  ///< of inertia, right-handed
  Vector3d L;              ///< components along them
  Quaterniond turn_B = Quaterniond::Identity();

  /// About axis i by rate L_i dt; L turns backwards.
  void turn(int i, double rate, double dt) {
    const double half_angle = 0.5 * dt * rate * L[i];
    const double c = pinned::cos(half_angle);
    const double s = pinned::sin(half_angle);
    const Vector3d axis = s * axes_B.col(i);
    turn_B = turn_B * Quaterniond(c, axis.x(), axis.y(), axis.z());
    const double cosine = c * c - s * s;
    const double sine = 2 * s * c;
    double& next = L[(i + 1) % 3];
    double& last = L[(i + 2) % 3];
    const double next_before = next;
    next = cosine * next_before + sine * last;
    last = cosine * last - sine * next_before;
  }
};

/// Into how many parts a step is divided in which a body turns by at most `angle` [rad].
double turns_of(double angle) {
  constexpr double kAngle = 0.5, kMost = 256;
  return angle > kAngle ? std::min(kMost, std::ceil(angle / kAngle)) : 1;
}

}  // namespace

Quaterniond turned_freely(const RigidBody& body, const Vector3d& L_W, double dt) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_unit(body.R_WB));
  const Vector3d& I = body.principal_moments;
  VERISIM_ASSERT(I[0] > 0);
  const double turns = turns_of(L_W.norm() / I[0] * dt);
  Turning body_axes{body.principal_axes_B, body.principal_axes_B.transpose() * (body.R_WB.conjugate() * L_W)};
  const double part = dt / turns;
  for (double i = 0; i < turns; ++i) {
    body_axes.turn(0, 1 / I[0] - 1 / I[1], part / 2);
    body_axes.turn(2, 1 / I[2] - 1 / I[1], part);
    body_axes.turn(0, 1 / I[0] - 1 / I[1], part / 2);
  }
  return (rotation_from_vector(dt / I[1] * L_W) * body.R_WB * body_axes.turn_B).normalized();
}

}  // namespace verisim

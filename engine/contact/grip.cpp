#include "engine/contact/grip.hpp"

#include <algorithm>
#include <cmath>

namespace verisim {
namespace {

constexpr double kPart = 0.05;  ///< of the contact's stability budget; the penalty leaves a fifth of it (penalty.hpp)
constexpr double kDampingRatio = 0.5;

}  // namespace

void Grip::follow(const Patch& patch) {
  stretched_ = {held_.slid + patch.slid, held_.turned + patch.turned};
  held_ = stretched_;
}

Grip::Matrices Grip::hold(const Now& now, Wrench& pressure) {
  const double pressing = pressure.force.norm();
  if (!(pressing > 0) || !std::isfinite(pressing)) {
    held_ = {};
    return {};
  }
  const Vector3d n = pressure.force / pressing;
  const double reach = std::sqrt(now.radius * now.radius + now.arm.squaredNorm());
  Matrix6d J = Matrix6d::Zero();  // of the velocity across n, and of what turns
  J.topLeftCorner<3, 3>() = Matrix3d::Identity() - n * n.transpose();
  J.topRightCorner<3, 3>() = -J.topLeftCorner<3, 3>() * skew(now.arm);
  J.bottomRightCorner<3, 3>().diagonal().setConstant(reach);
  const double mobility = (J * now.mobility * J.transpose()).trace();  // a bound
  if (!(mobility > 0)) return {};

  // As the penalty's stability rule: y^2 + 4 zeta y is the part, y = dt sqrt(k mobility).
  const double y = std::sqrt(4 * kDampingRatio * kDampingRatio + kPart * now.budget) - 2 * kDampingRatio;
  Matrices held;
  held.stiffness = y * y / (now.dt * now.dt * mobility);
  held.damping = 2 * kDampingRatio * y / (now.dt * mobility);
  Vector6d twist, stretch;
  twist << now.velocity.linear, now.velocity.angular;
  stretch << stretched_.slid - stretched_.slid.dot(n) * n, reach * stretched_.turned;
  const Vector6d slip = J * twist;
  const double fast = slip.norm() / kFast;
  const double limit = kGrip * pressing / (1 + fast * fast);
  stretch *= std::min(1.0, limit / (held.stiffness * stretch.norm()));  // it slips
  held_.slid = stretch.head<3>();
  held_.turned = reach > 0 ? Vector3d(stretch.tail<3>() / reach) : Vector3d::Zero();
  Vector6d force = -held.stiffness * stretch - held.damping * slip;
  if (const double size = force.norm(); size > limit) {
    force *= limit / size;
    held = {};
  } else {
    held.across = J.transpose() * J;
  }
  const Vector6d wrench = J.transpose() * force;
  pressure += {wrench.head<3>(), wrench.tail<3>()};
  return held;
}

}  // namespace verisim

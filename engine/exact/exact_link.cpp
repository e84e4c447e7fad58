#include "engine/exact/exact_link.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/exact/search.hpp"

namespace verisim::exact {
namespace {

Vector3d velocity_at(const BodyMotion& body, const Twist& twist, const Vector3d& p_W) {
  return twist.linear + twist.angular.cross(p_W - body.p_WC);
}

/// Where a body is after a step: its centre of mass goes straight on, and the body turns about it.
Pose after(const BodyMotion& body, const Twist& twist, double dt) {
  const Quaterniond turn = rotation_from_vector(dt * twist.angular);
  return {body.p_WC + dt * twist.linear + turn * (body.X_WB.position - body.p_WC), turn * body.X_WB.rotation};
}

Placement placement(const Pose& X_WM, const Pose& X_WB) {
  const Pose X_BM = X_WB.inverse() * X_WM;
  return {X_BM.rotation.toRotationMatrix(), X_BM.position};
}

RelativeMotion relative_motion(const BodyMotion& mover, const BodyMotion& base, double dt, double margin,
                               double overlap, double size, bool mover_is_second, const SearchThresholds& thresholds) {
  RelativeMotion motion;
  motion.now = placement(mover.X_WB, base.X_WB);
  const Quaterniond to_base = base.X_WB.rotation.conjugate();
  const Vector3d& origin = base.X_WB.position;
  const auto against = [&](const Twist& of_mover, const Twist& of_base) {
    return Twist{to_base * (velocity_at(mover, of_mover, origin) - velocity_at(base, of_base, origin)),
                 to_base * (of_mover.angular - of_base.angular)};
  };
  motion.free_twist = against(mover.twist, base.twist);
  motion.last_twist = against(mover.last_twist, base.last_twist);
  motion.during = against(mover.taken(), base.taken());
  motion.R_WB = base.X_WB.rotation.toRotationMatrix();
  motion.p_WB = base.X_WB.position;
  motion.dt = dt;
  motion.margin = margin;
  motion.size = size;
  motion.overlap = overlap;
  motion.mover_is_second = mover_is_second;
  motion.is_found_again = mover.is_found_again || base.is_found_again;
  motion.thresholds = thresholds;
  motion.of_mover = &mover;
  motion.of_base = &base;
  return motion;
}

bool is_finite(const BodyMotion& body) {
  return std::isfinite(body.X_WB.position.sum() + body.X_WB.rotation.coeffs().sum() + body.twist.linear.sum() +
                       body.twist.angular.sum() + body.last_twist.linear.sum() + body.last_twist.angular.sum() +
                       body.taken().linear.sum() + body.taken().angular.sum());
}

}  // namespace

const Placement& RelativeMotion::placed_once(std::optional<Placement>& placement, const Twist& mover,
                                             const Twist& base) const {
  if (!placement) placement = exact::placement(exact::after(*of_mover, mover, dt), exact::after(*of_base, base, dt));
  return *placement;
}

Placement RelativeMotion::after_part(double part) const {
  return placement(exact::after(*of_mover, of_mover->taken(), part * dt),
                   exact::after(*of_base, of_base->taken(), part * dt));
}

ExactLink::ExactLink(std::shared_ptr<const ExactBody> first, std::shared_ptr<const ExactBody> second,
                     std::size_t rows_max, const SearchThresholds& thresholds)
    : first_(std::move(first)), second_(std::move(second)), rows_(rows_max), thresholds_(thresholds) {
  VERISIM_ASSERT(thresholds.own_face_full < thresholds.own_face_none);
  VERISIM_ASSERT(thresholds.cone_full < thresholds.cone_none);
  VERISIM_ASSERT(first_ != nullptr);
  VERISIM_ASSERT(second_ != nullptr);
  size_ = std::numeric_limits<double>::infinity();
  for (const auto& body : {first_, second_})
    if (!body->block_tree.nodes.empty()) size_ = std::min(size_, body->block_tree.nodes[0].half.norm());
  // Each step down either tree leaves one pair behind; the trees halve their items.
  constexpr std::size_t kDepthMax = 64;
  stack_.reserve(2 * kDepthMax);
}

void ExactLink::find(const BodyMotion& first, const BodyMotion& second, double dt, double margin, double overlap) {
  rows_.clear();
  cost_ = {};
  depth_max_ = 0;
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(!(margin < 0));  // of a run that diverges it may be no number at all
  VERISIM_ASSERT(!(overlap < 0));
  if (!is_finite(first) || !is_finite(second)) return;
  VERISIM_ASSERT(is_unit(first.X_WB.rotation));
  VERISIM_ASSERT(is_unit(second.X_WB.rotation));
  const RelativeMotion of_second = relative_motion(second, first, dt, margin, overlap, size_, true, thresholds_);
  const RelativeMotion of_first = relative_motion(first, second, dt, margin, overlap, size_, false, thresholds_);
  const double a = search(*second_, *first_, of_second, stack_, rows_, cost_);
  const double b = search(*first_, *second_, of_first, stack_, rows_, cost_);
  depth_max_ = std::max(a, b);
}

}  // namespace verisim::exact

#include "engine/contact/collision_link.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Fraction of the budget that is used: the rule assumes a constant W, but W changes within a step.
constexpr double kSafety = 0.8;

/// Upper bound of the largest eigenvalue of M^-1 W: the Frobenius norm of M^-1/2 W M^-1/2 = sqrt(trace((M^-1 W)^2)).
double bound_of(const Matrix6d& inverse_mass, const Matrix6d& W) {
  const Matrix6d P = inverse_mass * W;
  return std::sqrt(std::max(0.0, P.cwiseProduct(P.transpose()).sum()));
}

/// J of a contact about another point: torque arms grow by `shift` (new arm = old arm + shift), so J' = T J.
Matrix6d shift_of_arm(const Vector3d& shift) {
  Matrix6d T = Matrix6d::Identity();
  T.bottomLeftCorner<3, 3>() = skew(shift);
  return T;
}

Matrix6d rotated(const Matrix6d& W, const Matrix3d& R) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = R;
  both.bottomRightCorner<3, 3>() = R;
  return both * W * both.transpose();
}

/// The twist of a body, taken at another point.
Vector6d twist_at(const LinkBody& body, const Vector3d& p_W) {
  Vector6d u;
  u << body.twist.linear + body.twist.angular.cross(p_W - body.p_WC), body.twist.angular;
  return u;
}

/// Does each cluster begin where the one before ends, from the first point to the last?
bool are_covered(const Pointshell& shell) {
  std::uint32_t end = 0;
  for (const Pointshell::Cluster& cluster : shell.clusters) {
    if (cluster.begin != end || cluster.end < cluster.begin) return false;
    end = cluster.end;
  }
  return end == shell.size();
}

}  // namespace

CollisionLink::CollisionLink(const VoxelBody& first, const VoxelBody& second)
    : first_is_map_(second.shell.size() <= first.shell.size()) {
  VERISIM_ASSERT(is_positive(first.voxmap.voxel_size));
  VERISIM_ASSERT(is_positive(second.voxmap.voxel_size));
  map_ = first_is_map_ ? &first.voxmap : &second.voxmap;
  shell_ = first_is_map_ ? &second.shell : &first.shell;
  VERISIM_ASSERT(are_covered(*shell_));
  contacts_ = ContactList(shell_->size());
  depth_before_.resize(shell_->size());
  met_in_.resize(shell_->size());
}

void CollisionLink::find_by_triangles(const MeshTree& first, const MeshTree& second) {
  map_mesh_ = first_is_map_ ? &first : &second;
  points_mesh_ = first_is_map_ ? &second : &first;
  contacts_ = ContactList(kMeshContactsMax);
}

void CollisionLink::clear() {
  contacts_.size = 0;
  depth_max_ = deepest_ = stiffness_ = 0;
}

void CollisionLink::query(const Pose& X_W1, const Pose& X_W2, QueryCost& cost) {
  clear();
  const Pose& X_WM = first_is_map_ ? X_W1 : X_W2;
  const Pose& X_WP = first_is_map_ ? X_W2 : X_W1;
  const Pose X_MP = X_WM.inverse() * X_WP;
  if (map_mesh_ != nullptr)
    verisim::query(*map_mesh_, *points_mesh_, X_MP, map_->origin, contacts_, cost);
  else
    verisim::query(*map_, *shell_, X_MP, contacts_, cost);
  ++queries_;
  X_MP_before_ = X_MP_;
  X_MP_ = X_MP;
}

void CollisionLink::follow_motion() {
  if (map_mesh_ != nullptr) return;
  const bool moved_before = queries_ > 1;
  const double softer = stiffness_ > 0 ? stiffness_before_ / stiffness_ : 0;  // the forces go on as they were
  const Pose back = X_MP_before_ * X_MP_.inverse();                           // to where B's points were
  const Matrix3d turned = Matrix3d::Identity() - back.rotation.toRotationMatrix();
  const Vector3d moved = turned * map_->origin - back.position;
  ContactList& c = contacts_;
  for (std::uint32_t i = 0; i < c.size; ++i) {
    const std::uint32_t p = c.point[i];
    const double depth = c.depth[i];
    const double began = moved_before && met_in_[p] + 1 == queries_ ? depth_before_[p] * softer : 0;
    double way_in = 0;
    if (moved_before) {
      const Vector3d way = turned.lazyProduct(Vector3d(c.x[i], c.y[i], c.z[i])) + moved;  // compiled in place, unlike *
      way_in = -(c.nx[i] * way.x() + c.ny[i] * way.y() + c.nz[i] * way.z());
    }
    deepest_ = std::max(deepest_, depth);
    depth_before_[p] = c.depth[i] = static_cast<float>(std::clamp(began + way_in, 0.0, depth));
    met_in_[p] = queries_;
  }
  stiffness_before_ = stiffness_;
}

void CollisionLink::choose_stiffness(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters,
                                     double dt) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_not_negative(parameters.stiffness_max));
  VERISIM_ASSERT(is_not_negative(parameters.damping_ratio));
  VERISIM_ASSERT(is_symmetric(first.inverse_mass));
  VERISIM_ASSERT(is_symmetric(second.inverse_mass));
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  const Matrix3d R_MW = map.X_WB.rotation.toRotationMatrix().transpose();
  about_ = R_MW * (points.p_WC - map.X_WB.position) - map_->origin;
  W_ = contact_matrix(contacts_, about_);

  const Matrix6d W_points = rotated(W_, R_MW.transpose());
  const Matrix6d T = shift_of_arm(points.p_WC - map.p_WC);
  const double lambda =
      bound_of(points.inverse_mass, W_points) + bound_of(map.inverse_mass, T * W_points * T.transpose());
  const double zeta = parameters.damping_ratio;
  stiffness_ = parameters.stiffness_max;
  if (parameters.stabilize && lambda > 0) {
    double budget = 4;
    if (!points.inverse_mass.isZero(0)) budget = std::min(budget, points.budget);
    if (!map.inverse_mass.isZero(0)) budget = std::min(budget, map.budget);
    VERISIM_ASSERT(budget > 0);
    // With y = dt sqrt(k lambda) and b = 2 zeta sqrt(k / lambda), k dt^2 lambda + 2 b dt lambda is y^2 + 4 zeta y.
    const double y = std::sqrt(4 * zeta * zeta + kSafety * budget) - 2 * zeta;
    stiffness_ = std::min(stiffness_, y * y / (dt * dt * lambda));
  }
  damping_ = lambda > 0 ? 2 * zeta * std::sqrt(stiffness_ / lambda) : 0;
}

Twist CollisionLink::relative_twist(const LinkBody& first, const LinkBody& second) const {
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  const Matrix3d R_MW = map.X_WB.rotation.toRotationMatrix().transpose();
  const Vector6d relative = twist_at(points, points.p_WC) - twist_at(map, points.p_WC);
  return {R_MW * relative.head<3>(), R_MW * relative.tail<3>()};
}

void CollisionLink::respond(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters,
                            double dt) {
  if (contacts_.size == 0) return;
  choose_stiffness(first, second, parameters, dt);
  if (parameters.from_touch) follow_motion();
  apply_penalty(contacts_, about_, relative_twist(first, second), stiffness_, damping_);
}

void CollisionLink::sum_up(const LinkBody& first, const LinkBody& second, bool with_matrices, LinkSides& sides) {
  sides = LinkSides();
  if (contacts_.size == 0) return;
  give_to_both(first, second, sum(contacts_, about_), with_matrices, sides);
}

void CollisionLink::respond_at_once(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters,
                                    double dt, LinkSides& sides) {
  sides = LinkSides();
  if (contacts_.size == 0) return;
  choose_stiffness(first, second, parameters, dt);
  if (parameters.from_touch) follow_motion();
  const Twist relative = relative_twist(first, second);
  give_to_both(first, second, penalty_sum(contacts_, about_, relative, stiffness_, damping_), true, sides);
}

void CollisionLink::give_to_both(const LinkBody& first, const LinkBody& second, const ContactSum& total,
                                 bool with_matrices, LinkSides& sides) {
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  LinkSide& on_points = first_is_map_ ? sides.second : sides.first;
  LinkSide& on_map = first_is_map_ ? sides.first : sides.second;
  const Matrix3d R_WM = map.X_WB.rotation.toRotationMatrix();
  const Vector3d arm = points.p_WC - map.p_WC;

  depth_max_ = std::max(total.depth_max, deepest_);
  on_points.wrench = {R_WM * total.wrench.force, R_WM * total.wrench.torque};
  on_map.wrench = reaction(on_points.wrench, points.p_WC, map.p_WC);
  if (!with_matrices) return;

  const Matrix6d W_points = rotated(W_, R_WM);
  const Matrix6d T = shift_of_arm(arm);
  const Matrix6d W_map = T * W_points * T.transpose();
  on_points.stiffness = stiffness_ * W_points;
  on_points.damping = damping_ * W_points;
  on_points.drift = on_points.stiffness * twist_at(map, points.p_WC);
  on_map.stiffness = stiffness_ * W_map;
  on_map.damping = damping_ * W_map;
  on_map.drift = on_map.stiffness * twist_at(points, map.p_WC);
}

}  // namespace verisim

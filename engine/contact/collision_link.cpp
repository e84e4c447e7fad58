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

/// The smaller of the parts of the stability budget that the bodies have which move.
double budget_of(const LinkBody& first, const LinkBody& second) {
  double budget = kStabilityBudget;
  for (const LinkBody* body : {&first, &second})
    if (!body->inverse_mass.isZero(0)) budget = std::min(budget, body->budget);
  VERISIM_ASSERT(budget > 0);
  return budget;
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

/// Where springs press: sums over them, each by how far it is pressed.
struct CollisionLink::PressureSum {
  double sum = 0, squares = 0;
  Vector3d weighed = Vector3d::Zero();
  void add(double pressed, const Vector3d& at) {
    sum += pressed;
    weighed += pressed * at;
    squares += pressed * at.squaredNorm();
  }
  [[nodiscard]] Vector3d middle() const { return weighed / sum; }
  [[nodiscard]] double radius() const { return std::sqrt(std::max(0.0, squares / sum - middle().squaredNorm())); }
};

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
  PressureSum pressure;
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
    pressure.add(c.depth[i], Vector3d(c.x[i], c.y[i], c.z[i]));
  }
  follow_patch(pressure, turned, moved);
  stiffness_before_ = stiffness_;
}

void CollisionLink::follow_patch(const PressureSum& pressure, const Matrix3d& turned, const Vector3d& moved) {
  if (!(pressure.sum > 0)) return;
  if (pressed_in_ + 1 != queries_) grip_.let_go();
  pressed_in_ = queries_;
  patch_ = {pressure.middle(), pressure.radius(), turned * pressure.middle() + moved,
            0.5 * Vector3d(turned(2, 1) - turned(1, 2), turned(0, 2) - turned(2, 0), turned(1, 0) - turned(0, 1))};
  grip_.follow(patch_);
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
  dt_ = dt;
  stiffness_ = parameters.stiffness_max;
  if (parameters.stabilize && lambda > 0) {
    const double budget = budget_of(first, second);
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

void CollisionLink::sum_up(const LinkBody& first, const LinkBody& second, LinkSides& sides) {
  sides = LinkSides();
  if (contacts_.size == 0) return;
  const ContactSum total = sum(contacts_, about_);
  depth_max_ = std::max(total.depth_max, deepest_);
  Wrench on_points = total.wrench;
  hold(first, second, on_points);
  give_wrench(first, second, on_points, sides);
}

void CollisionLink::respond_at_once(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters,
                                    double dt, LinkSides& sides) {
  sides = LinkSides();
  if (contacts_.size == 0) return;
  choose_stiffness(first, second, parameters, dt);
  if (parameters.from_touch) follow_motion();
  give_pushing(first, second, pushing(contacts_, about_, relative_twist(first, second), stiffness_, damping_), sides);
}

Matrix6d CollisionLink::mobility(const LinkBody& first, const LinkBody& second) const {
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  const Matrix6d T = shift_of_arm(points.p_WC - map.p_WC);
  const Matrix6d both = points.inverse_mass + T.transpose() * map.inverse_mass * T;
  return rotated(both, map.X_WB.rotation.toRotationMatrix().transpose());
}

Grip::Matrices CollisionLink::hold(const LinkBody& first, const LinkBody& second, Wrench& on_points) {
  if (pressed_in_ != queries_) return {};
  return grip_.hold({patch_.middle - about_, patch_.radius, relative_twist(first, second), mobility(first, second),
                     budget_of(first, second), dt_},
                    on_points);
}

void CollisionLink::give_wrench(const LinkBody& first, const LinkBody& second, const Wrench& on_points,
                                LinkSides& sides) const {
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  LinkSide& points_side = first_is_map_ ? sides.second : sides.first;
  LinkSide& map_side = first_is_map_ ? sides.first : sides.second;
  const Matrix3d R_WM = map.X_WB.rotation.toRotationMatrix();
  points_side.wrench = {R_WM * on_points.force, R_WM * on_points.torque};
  map_side.wrench = reaction(points_side.wrench, points.p_WC, map.p_WC);
}

void CollisionLink::give_pushing(const LinkBody& first, const LinkBody& second, const Pushing& contacts,
                                 LinkSides& sides) {
  const LinkBody& map = first_is_map_ ? first : second;
  const LinkBody& points = first_is_map_ ? second : first;
  LinkSide& on_points = first_is_map_ ? sides.second : sides.first;
  LinkSide& on_map = first_is_map_ ? sides.first : sides.second;
  depth_max_ = std::max(contacts.sum.depth_max, deepest_);
  Wrench total = contacts.sum.wrench;
  const Grip::Matrices held = hold(first, second, total);
  give_wrench(first, second, total, sides);

  const Matrix3d R_WM = map.X_WB.rotation.toRotationMatrix();
  const Matrix6d T = shift_of_arm(points.p_WC - map.p_WC);
  on_points.stiffness = rotated(stiffness_ * contacts.W + held.stiffness * held.across, R_WM);
  on_points.damping = rotated(damping_ * contacts.W + held.damping * held.across, R_WM);
  on_points.drift = on_points.stiffness * twist_at(map, points.p_WC);
  on_map.stiffness = T * on_points.stiffness * T.transpose();
  on_map.damping = T * on_points.damping * T.transpose();
  on_map.drift = on_map.stiffness * twist_at(points, map.p_WC);
}

}  // namespace verisim

// Friction of precise contacts: a grip for each link, by what pressed in the last frame.
#include <cmath>
#include <limits>

#include "engine/simulation/stages/exact_response.hpp"

namespace verisim {
namespace {

/// m/s: what slides more slowly friction resists in proportion to its speed. Without any friction a body that is
/// squeezed between two others has no stable place: the pressure W tilts what lies on it by W x / K where it stands x
/// beside the middle (K: of its contacts, N m), and the tilt pushes it on, the faster the lighter it is (1e-9 kg under
/// 64 g: e times as far in 30 ms). So it is held by friction, however little, where the tilt is below the coefficient.
constexpr double kSticking = 1e-3;
/// Of the sum of all pushes: a smaller resultant has no direction to be across.
constexpr double kAcross = 1e-3;
/// m/s: what friction would take from the lighter body in one step, for a blow's own friction to be solved for.
constexpr double kCounts = 1e-4;

}  // namespace

/// Friction by what pressed in the last frame.
void ExactResponse::add_grip(const World& world, std::size_t l) {
  OfLink& of = links_[l];
  const double friction = world.parameters.exact_friction;
  if (!(of.pressing.force > 0) || friction == 0) return;
  exact::ConvexStep::Grip& grip = of.pressing.grip;
  Vector3d slip = Vector3d::Zero();
  for (const std::size_t i : {world.links[l].first, world.links[l].second}) {
    slip = -slip;
    if (!bodies_[i].solved) continue;
    const RigidBody& rigid = world.bodies[i].rigid;
    slip += rigid.v_C + rigid.omega.cross(grip.point - rigid.p_WC);
  }
  slip -= slip.dot(grip.normal) * grip.normal;
  grip.drag = friction * of.pressing.force / std::max(kSticking, slip.norm());
  of.in_solver = solver_->add_grip(grip, bodies_[world.links[l].first].in_solver,
                                   bodies_[world.links[l].second].in_solver, world.dt);
}

/// What presses one link's bodies on each other, as the solver found it: a grip without drag, and its force.
ExactResponse::Pressing ExactResponse::pressing(std::size_t l, std::size_t first_row) const {
  const auto& rows = links_[l].search->rows().rows();
  Vector3d push = Vector3d::Zero(), center = Vector3d::Zero();
  double sum = 0;
  const auto each = [&](auto f) {
    for (std::size_t i = 0; i < rows.size() && first_row + i < solver_->row_count(); ++i)
      if (const double force = solver_->force(first_row + i); force > 0) f(rows[i], force);
  };
  each([&](const exact::ContactRow& row, double force) {
    push += force * row.normal;
    center += force * row.point;
    sum += force;
  });
  const double resultant = push.norm();
  if (!(resultant > kAcross * sum) || !std::isfinite(resultant)) return {};  // what diverges ends the run elsewhere
  Pressing found{{center / sum, push / resultant}, resultant};
  double square = 0;
  each([&](const exact::ContactRow& row, double force) {
    square += force * (row.point - found.grip.point).cross(found.grip.normal).squaredNorm();
  });
  found.grip.radius = std::sqrt(square / sum);
  return found;
}

/// True if a blow presses on a body much more than anything did before, and so much that its friction counts for so
/// light a body. Its grips are those of the blow then.
bool ExactResponse::squeezes_light_body(const World& world, std::size_t island) {
  bool any = false;
  std::size_t first_row = 0;
  for (std::size_t l = bodies_[island].first_link; l != kNone; l = links_[l].next) {
    OfLink& of = links_[l];
    double lightest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : {world.links[l].first, world.links[l].second})
      if (bodies_[i].solved) lightest = std::min(lightest, world.bodies[i].rigid.mass);
    const Pressing now = pressing(l, first_row);
    first_row += of.search->rows().rows().size();
    if (!(now.force > 2 * of.pressing.force)) continue;
    if (world.parameters.exact_friction * now.force * world.dt <= kCounts * lightest) continue;
    of.pressing = now;
    any = true;
  }
  return any;
}

/// What the grip of one link did to its second body, and where there is one in the next frame.
void ExactResponse::read_grip(const World& world, std::size_t l, std::size_t first_row) {
  OfLink& of = links_[l];
  if (of.in_solver != exact::ConvexStep::kNoGrip) {
    const Wrench drag = solver_->grip_wrench(of.in_solver);
    const Vector3d& p_WC = world.bodies[world.links[l].second].rigid.p_WC;
    of.on_second += {drag.force, drag.torque + (of.pressing.grip.point - p_WC).cross(drag.force)};
  }
  of.pressing = solver_->was_hit() ? Pressing{} : pressing(l, first_row);  // a blow with a rebound is over
}

}  // namespace verisim

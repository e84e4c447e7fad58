#include "engine/simulation/stages/exact_response.hpp"

#include <Eigen/Cholesky>

#include "engine/base/error.hpp"
#include "engine/simulation/stages/groups.hpp"

namespace verisim {
namespace {

/// Precise contacts are looked for this far ahead of what the bodies can close within the step [m]. A contact counts
/// only when it closes, so more costs time and changes nothing.
constexpr double kMargin = 1e-4;
constexpr std::size_t kRowsMax = 16384;  // of one island

/// Bound of the velocity of any point of a body [m/s].
double speed_of(const Body& body, const Vector6d& u) {
  return u.head<3>().norm() + u.tail<3>().norm() * body.bounds_B.size().norm();
}

}  // namespace

void ExactResponse::add_link(const PairMethods& methods, std::size_t l) {
  VERISIM_ASSERT(l == links_.size());
  links_.emplace_back();
  if (!solver_ && methods.is_precise(l)) solver_ = std::make_unique<exact::ConvexStep>(kRowsMax, bodies_.size());
}

void ExactResponse::solve(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                          const Response& response, FrameCost& cost) {
  if (!solver_) return;
  begin(world, response);
  find(world, neighbours, methods, cost);
  join_bodies(world, island_, [&](std::size_t l) {
    return links_[l].search != nullptr && !links_[l].search->rows().rows().empty() &&
           bodies_[world.links[l].first].solved && bodies_[world.links[l].second].solved;
  });
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (bodies_[i].solved && island_[i] == i) solve_island(world, i, cost);
}

void ExactResponse::begin(const World& world, const Response& response) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    OfBody& of = bodies_[i];
    of.solved = false;
    of.wrench = {};
    of.contacts = 0;
    if (!world.bodies[i].exact || !world.moves(world.bodies[i])) continue;
    of.step = begin_implicit(world.bodies[i].rigid, response.loads(i), world.dt);
    of.velocity = of.step.free;
  }
}

void ExactResponse::find(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                         FrameCost& cost) {
  for (const std::size_t l : world.near_links) {
    links_[l] = {};
    exact::ExactLink* search = methods.acting(l) != nullptr ? methods.acting(l)->precise() : nullptr;
    if (search == nullptr) continue;
    const Link& link = world.links[l];
    const Body& first = world.bodies[link.first];
    const Body& second = world.bodies[link.second];
    // The boxes know where bodies are, not how fast: a contact is to be there before the bodies overlap.
    const double reach = closing(world, link);
    if (!(gap(neighbours.box(link.first), neighbours.box(link.second)) <= reach)) continue;
    bodies_[link.first].solved = bodies_[link.first].solved || world.moves(first);
    bodies_[link.second].solved = bodies_[link.second].solved || world.moves(second);
    find(world, l, *search, reach);
    cost.exact_samples += search->cost().samples;
    cost.rows_left_out += search->rows().left_out();
  }
}

/// How far ahead contacts of two bodies are looked for [m].
double ExactResponse::closing(const World& world, const Link& link) const {
  double sum = kMargin;
  for (const std::size_t i : {link.first, link.second})
    if (world.moves(world.bodies[i])) sum += world.dt * speed_of(world.bodies[i], bodies_[i].velocity);
  return sum;
}

void ExactResponse::find(const World& world, std::size_t l, exact::ExactLink& search, double closing) {
  const auto motion_of = [&](std::size_t i) {
    const RigidBody& rigid = world.bodies[i].rigid;
    const OfBody& of = bodies_[i];
    exact::BodyMotion motion{.X_WB = rigid.pose(), .p_WC = rigid.p_WC, .twist = {}};
    if (!of.solved) return motion;
    motion.twist = {of.velocity.head<3>(), of.velocity.tail<3>()};
    motion.last_twist = {rigid.v_C, rigid.omega};
    return motion;
  };
  search.find(motion_of(world.links[l].first), motion_of(world.links[l].second), world.dt, closing);
  links_[l].search = &search;
  links_[l].depth_max = search.depth_max();
}

void ExactResponse::solve_island(const World& world, std::size_t island, FrameCost& cost) {
  solver_->clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    OfBody& of = bodies_[i];
    of.in_solver = exact::kFixed;
    if (!of.solved || island_[i] != island) continue;
    const RigidBody& rigid = world.bodies[i].rigid;
    Vector6d last;
    last << rigid.v_C, rigid.omega;
    of.in_solver = solver_->add_body(rigid.p_WC, of.step.A, of.step.free, last);
  }
  const auto in_solver = [&](std::size_t body) { return bodies_[body].in_solver; };
  const auto belongs = [&](std::size_t l) {
    const auto [first, second, number] = world.links[l];
    return links_[l].search != nullptr && (in_solver(first) != exact::kFixed || in_solver(second) != exact::kFixed);
  };
  for (const std::size_t l : world.near_links)
    if (belongs(l))
      solver_->add_rows(links_[l].search->rows().rows(), in_solver(world.links[l].first),
                        in_solver(world.links[l].second));
  cost.solver_steps += static_cast<std::uint64_t>(solver_->solve(world.dt));
  cost.rows_left_out += solver_->left_out();
  cost.solver_unfinished += solver_->finished() ? 0 : 1;
  read_bodies(world.dt);
  std::size_t first_row = 0;
  for (const std::size_t l : world.near_links) {
    if (!belongs(l)) continue;
    read_rows(world, l, first_row, cost);
    first_row += links_[l].search->rows().rows().size();
  }
}

/// What the solver found for its bodies.
void ExactResponse::read_bodies(double dt) {
  const bool alone = solver_->body_count() == 1;
  for (OfBody& of : bodies_) {
    if (of.in_solver == exact::kFixed) continue;
    of.velocity = solver_->velocity(of.in_solver);
    of.wrench = solver_->wrench(of.in_solver);
    if (alone) continue;
    // A stiff row's force has the roundings of its gap times its stiffness, 1e-9 of it and more. The velocity that
    // exactly these forces give keeps the momentum of bodies that push each other.
    Vector6d impulse;
    impulse << dt * of.wrench.force, dt * of.wrench.torque;
    of.velocity = of.step.free + of.step.A.llt().solve(impulse);
  }
}

/// What the rows of one link do to its bodies; rows are numbered as they were added.
void ExactResponse::read_rows(const World& world, std::size_t l, std::size_t first_row, FrameCost& cost) {
  OfLink& of = links_[l];
  const Vector3d& p_WC = world.bodies[world.links[l].second].rigid.p_WC;
  VERISIM_ASSERT(first_row <= solver_->row_count() + solver_->left_out());
  const auto& rows = of.search->rows().rows();
  for (std::size_t i = 0; i < rows.size() && first_row + i < solver_->row_count(); ++i) {
    const double force = solver_->force(first_row + i);
    if (!(force > 0)) continue;
    ++of.acting;
    const Vector3d f = force * rows[i].normal;
    of.on_second += {f, (rows[i].point - p_WC).cross(f)};
  }
  cost.contacts += of.acting;
  bodies_[world.links[l].first].contacts += of.acting;
  bodies_[world.links[l].second].contacts += of.acting;
}

}  // namespace verisim

#include "engine/simulation/stages/exact_response.hpp"

#include <fmt/format.h>

#include <utility>

#include "engine/base/cholesky.hpp"
#include "engine/base/error.hpp"
#include "engine/contact/depth_inside.hpp"
#include "engine/simulation/stages/groups.hpp"

namespace verisim {
namespace {

/// Precise contacts are looked for this far ahead of what the bodies can close within the step [m]. A contact counts
/// only when it closes, so more costs time and changes nothing.
constexpr double kMargin = 1e-4;
/// m: of the gap at the end of a step, for which contacts are found again; and how often, at most. Two or three times
/// are enough: what the next one changes is of the order of the step smaller.
constexpr double kCurves = 5e-6;
constexpr int kAgainMax = 3;
/// Rows and blocks that an island has room for at first, and by how much more than the last frame needed there is room
/// in the next: so much more has to come at once to be left out.
constexpr std::size_t kRowsMax = 16384;
constexpr std::size_t kRoom = 2;
/// Frames with rows and without a late one, after which a pair counts as one that touches: of what is not known to
/// overlap, and of what did. Rows are those of features as near as a voxel: what is deeper comes to light as it moves
/// out, not in every frame.
constexpr std::uint32_t kTouches = 10, kCalm = 100;

/// m/s: what a body may get from roundings in a step and nobody is told.
constexpr double kRounded = 1e-3;

std::string text_of_rounding(const World& world, const Note& note) {
  return fmt::format(
      "'{}' weighs {:.3g} kg, too little for its stiff contacts with heavier bodies: the roundings of their forces "
      "move "
      "it, {:.2g} m/s in a step; lower exactStiffness (now {:.3g} N/m^2), use a smaller timestep or raise its density",
      world.bodies[note.first].name, world.bodies[note.first].rigid.mass, note.a, world.parameters.exact_stiffness);
}

std::string text_of_overlap(const World& world, const Note& note) {
  const bool put = note.b > 0;
  return fmt::format(
      "'{}' and '{}' {}, by {:.3g} mm or more: their contacts move them apart, {:g} m/s fast at most, and give no "
      "energy; {}",
      world.bodies[note.first].name, world.bodies[note.second].name,
      put ? "were put inside of each other" : "came inside of each other where no precise contact told of it",
      1e3 * note.a, exact::ConvexStep::kPushOut, put ? "put them apart" : "use smaller voxels, or a smaller timestep");
}

/// Bound of the velocity of any point of a body [m/s].
double speed_of(const Body& body, const Vector6d& u) {
  return u.head<3>().norm() + u.tail<3>().norm() * body.bounds_B.size().norm();
}

/// The box around all that rows are found on, body coordinates. It is the body's own: those of the search's blocks are
/// larger, by half a segment.
Bounds box_of(const exact::ExactBody& body) {
  Bounds box;
  const auto include = [&](const Bounds& one) {
    box.min = box.min.cwiseMin(one.min);
    box.max = box.max.cwiseMax(one.max);
  };
  for (const exact::ExactFace& face : body.faces) include(face.bounds);
  for (const exact::ExactEdge& edge : body.edges) include(edge.bounds);
  return box;
}

}  // namespace

void ExactResponse::add_link(const World& world, const PairMethods& methods, std::size_t l) {
  VERISIM_ASSERT(l == links_.size());
  links_.emplace_back().is_new = some_are_new_ = true;
  if (!methods.is_precise(l)) return;
  for (const std::size_t body : {world.links[l].first, world.links[l].second})
    bodies_[body].box_B = box_of(*world.bodies[body].exact);
  if (solver_) return;
  solver_ = std::make_unique<exact::ConvexStep>(kRowsMax, bodies_.size());
}

void ExactResponse::make_room() {
  if (!solver_) return;
  for (OfLink& of : links_)
    if (of.search != nullptr) of.search->make_room();
  if (kRoom * rows_needed_ > solver_->rows_max()) solver_->reserve(2 * kRoom * rows_needed_, bodies_.size());
  if (kRoom * blocks_needed_ > solver_->blocks_max()) solver_->reserve_blocks(2 * kRoom * blocks_needed_);
}

void ExactResponse::solve(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                          const Response& response, FrameCost& cost, Notes& notes) {
  if (!solver_) return;
  begin(world, response);
  find(world, neighbours, methods, cost);
  join_bodies(world, island_, [&](std::size_t l) {
    return links_[l].search != nullptr && !links_[l].search->rows().rows().empty() &&
           bodies_[world.links[l].first].solved && bodies_[world.links[l].second].solved;
  });
  list_islands(world);
  for (const std::size_t i : world.busy)
    if (bodies_[i].solved && island_[i] == i) solve_island(world, neighbours, methods, i, cost);
  tell(world, notes);
}

void ExactResponse::forget(const World& world, std::size_t body) {
  for (std::size_t l = 0; l < links_.size(); ++l)
    if (world.links[l].first == body || world.links[l].second == body) {
      links_[l].calm = 0;
      links_[l].is_new = some_are_new_ = true;
    }
}

void ExactResponse::look_inside(const World& world, const PairMethods& methods, Notes& notes) {
  if (!std::exchange(some_are_new_, false)) return;
  for (const std::size_t l : world.near_links) {
    OfLink& of = links_[l];
    if (of.told || !of.is_new || !methods.is_precise(l)) continue;
    const Body &a = world.bodies[world.links[l].first], &b = world.bodies[world.links[l].second];
    const double depth = depth_inside(*a.voxels, *b.voxels, a.rigid.pose().inverse() * b.rigid.pose());
    of.was_put = of.was_put || depth > 0;
    if (depth > 0) note_overlap(world, l, depth, notes);
  }
  for (OfLink& of : links_) of.is_new = false;
}

void ExactResponse::note_overlap(const World& world, std::size_t l, double depth, Notes& notes) {
  OfLink& of = links_[l];
  of.told = true;
  notes.add({.time = world.time(),
             .kind = "overlap",
             .text = text_of_overlap,
             .first = world.links[l].first,
             .second = world.links[l].second,
             .a = depth,
             .b = of.was_put ? 1.0 : 0.0});
}

void ExactResponse::tell(const World& world, Notes& notes) {
  for (const std::size_t i : world.busy) {
    OfBody& of = bodies_[i];
    if (of.told || !of.solved || !(of.rounded > kRounded)) continue;
    of.told = true;
    notes.add({.time = world.time(), .kind = "rounding", .text = text_of_rounding, .first = i, .a = of.rounded});
  }
  for (const std::size_t l : world.near_links) {
    if (!links_[l].told && links_[l].late) note_overlap(world, l, links_[l].depth_max, notes);
  }
}

/// Bodies and links of each island, in their order: chains that begin at the island's first body.
void ExactResponse::list_islands(const World& world) {
  for (const std::size_t i : world.busy) {
    OfBody& of = bodies_[i];
    of.in_solver = exact::kFixed;
    of.first_body = of.first_link = kNone;
  }
  for (std::size_t n = world.busy.size(); n-- > 0;) {
    const std::size_t i = world.busy[n];
    if (!bodies_[i].solved) continue;
    OfBody& island = bodies_[island_[i]];
    bodies_[i].next = std::exchange(island.first_body, i);
  }
  for (std::size_t n = world.near_links.size(); n-- > 0;) {
    const std::size_t l = world.near_links[n];
    if (links_[l].search == nullptr || links_[l].search->rows().rows().empty()) continue;
    const Link& link = world.links[l];
    OfBody& island = bodies_[island_[bodies_[link.first].solved ? link.first : link.second]];
    links_[l].next = std::exchange(island.first_link, l);
  }
}

void ExactResponse::begin(const World& world, const Response& response) {
  for (const std::size_t i : world.busy) {
    OfBody& of = bodies_[i];
    of.solved = of.placed = of.moves_otherwise = of.is_found_again = false;
    of.speed = 0;
    of.wrench = {};
    of.shift_moment = Vector3d::Zero();
    of.contacts = 0;
    of.rounded = 0;
    if (!world.bodies[i].exact || !world.moves(world.bodies[i])) continue;
    of.step = begin_implicit(world.bodies[i].rigid, response.loads(i), world.dt);
    of.velocity = of.step.free;
    expect_motion(world.bodies[i].rigid, world.dt, of);
    of.speed = speed_of(world.bodies[i], of.velocity);
  }
}

/// With what velocity a body is taken to move when its contacts are found: the last one, and what the last step changed
/// of it if the step before changed alike. Without that a contact that turns the velocity is found a little late in
/// every step, always on the same side: half a ball of 6 mm that swings in a bowl gains 0.4 % of energy a second at
/// steps of 0.9 ms, and 0.02 % with it.
void ExactResponse::expect_motion(const RigidBody& rigid, double dt, OfBody& of) {
  constexpr double kAlike = 0.5;
  constexpr double kTurn = 0.5;  // rad in a step: what turns farther does not go on in a line
  Vector6d u;
  u << rigid.v_C, rigid.omega;
  const Vector6d change = u - of.last;
  const Vector6d other = change - of.last_change;
  const auto alike = [](const auto& now, const auto& before) { return now.norm() < kAlike * before.norm(); };
  const bool goes_on =
      alike(other.head<3>(), of.last_change.head<3>()) && alike(other.tail<3>(), of.last_change.tail<3>());
  of.during = goes_on && dt * rigid.omega.norm() < kTurn ? u + change : u;
  of.last = u;
  of.last_change = change;
}

/// What a body may meet in this step because another one hits it first: it goes no faster then than that one, and its
/// own rebound, let it. One body farther; the next in a row is the next step's.
void ExactResponse::expect_blows(const World& world, const PairMethods& methods) {
  for (const std::size_t i : world.busy) bodies_[i].speed_hit = bodies_[i].speed;
  for (const std::size_t l : world.near_links) {
    if (methods.searching(l) == nullptr) continue;
    const Link& link = world.links[l];
    OfBody& first = bodies_[link.first];
    OfBody& second = bodies_[link.second];
    if (!world.moves(world.bodies[link.first]) || !world.moves(world.bodies[link.second])) continue;
    if (are_apart(placed(world, link.first), placed(world, link.second),
                  kMargin + world.dt * (first.speed + second.speed)))
      continue;
    const double e = world.parameters.restitution;
    first.speed_hit = std::max(first.speed_hit, (1 + e) * second.speed + e * first.speed);
    second.speed_hit = std::max(second.speed_hit, (1 + e) * first.speed + e * second.speed);
  }
}

void ExactResponse::find(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                         FrameCost& cost) {
  expect_blows(world, methods);
  for (const std::size_t l : world.near_links) {
    OfLink& of = links_[l];
    begin_frame(world, of);
    exact::ExactLink* search = methods.searching(l);
    if (search == nullptr) continue;
    const Link& link = world.links[l];
    const Body& first = world.bodies[link.first];
    const Body& second = world.bodies[link.second];
    // The boxes know where bodies are, not how fast: a contact is to be there before the bodies overlap.
    const double reach = closing(world, link);
    const std::uint32_t calm = std::exchange(of.calm, kCalm);  // but for what is not apart
    if (!(gap(neighbours.box(link.first), neighbours.box(link.second)) <= reach)) continue;
    bodies_[link.first].solved = bodies_[link.first].solved || world.moves(first);
    bodies_[link.second].solved = bodies_[link.second].solved || world.moves(second);
    of.searched = true;
    of.idle = false;
    if (are_apart(placed(world, link.first), placed(world, link.second), reach)) continue;
    of.calm = calm;
    find(world, l, *search, reach, cost);
  }
}

/// What is known of a link from the frame before.
void ExactResponse::begin_frame(const World& world, OfLink& of) const {
  if (of.idle) return;
  const OfLink last = of;
  of = {};
  of.calm = last.calm;
  of.told = last.told;
  of.is_new = last.is_new;
  of.idle = last.found_in == kNone || last.found_in + 1 != world.frame;
  if (of.idle) return;
  of.overlap = last.overlap;
  of.pressing = last.pressing;
}

/// Where the box around a body is in this frame.
const exact::OrientedBox& ExactResponse::placed(const World& world, std::size_t body) {
  OfBody& of = bodies_[body];
  if (of.placed) return of.box;
  const Pose X_WB = world.bodies[body].rigid.pose();
  of.box = {X_WB * of.box_B.center(), 0.5 * of.box_B.size(), X_WB.rotation.toRotationMatrix()};
  of.placed = true;
  return of.box;
}

/// How far ahead contacts of two bodies are looked for [m].
double ExactResponse::closing(const World& world, const Link& link) const {
  double sum = kMargin;
  for (const std::size_t i : {link.first, link.second})
    if (world.moves(world.bodies[i])) sum += world.dt * bodies_[i].speed_hit;
  return sum;
}

void ExactResponse::find(const World& world, std::size_t l, exact::ExactLink& search, double closing, FrameCost& cost) {
  const auto motion_of = [&](std::size_t i) {
    const RigidBody& rigid = world.bodies[i].rigid;
    const OfBody& of = bodies_[i];
    exact::BodyMotion motion{.X_WB = rigid.pose(), .p_WC = rigid.p_WC, .twist = {}};
    if (!of.solved) return motion;
    motion.twist = {of.velocity.head<3>(), of.velocity.tail<3>()};
    motion.last_twist = {rigid.v_C, rigid.omega};
    motion.during = Twist{of.during.head<3>(), of.during.tail<3>()};
    motion.is_found_again = of.is_found_again;
    return motion;
  };
  search.find(motion_of(world.links[l].first), motion_of(world.links[l].second), world.dt, closing, links_[l].overlap);
  links_[l].search = &search;
  links_[l].found_in = world.frame;
  links_[l].depth_max = search.depth_max();
  cost.exact_samples += search.cost().samples;
}

/// True if a link's bodies are all of one island, or do not move.
bool ExactResponse::is_of_island(const World& world, std::size_t l, std::size_t island) const {
  bool any = false;
  for (const std::size_t i : {world.links[l].first, world.links[l].second}) {
    if (!world.moves(world.bodies[i])) continue;
    if (!bodies_[i].solved || island_[i] != island) return false;
    any = true;
  }
  return any;
}

/// Marks the island's bodies that move otherwise in this step than was assumed when their contacts were found: so much
/// faster, after a blow, that they may meet what was not looked for, or turning otherwise, so that their places leave
/// the straight lines of the rows by more than kCurves. Their contacts are to be found for these motions.
/// @returns whether there are any
bool ExactResponse::mark_otherwise_moved(const World& world, std::size_t island) {
  bool any = false;
  for (std::size_t i = bodies_[island].first_body; i != kNone; i = bodies_[i].next) {
    OfBody& of = bodies_[i];
    const Vector6d& u = solver_->velocity(of.in_solver);
    const Vector3d now = u.tail<3>(), assumed = of.during.tail<3>();
    const double curves = 0.25 * world.dt * world.dt * (now - assumed).norm() * (now.norm() + assumed.norm()) *
                          world.bodies[i].bounds_B.size().norm();
    const double speed = speed_of(world.bodies[i], u);
    of.moves_otherwise = curves > kCurves || world.dt * (speed - of.speed_hit) > 0.5 * kMargin;
    if (!of.moves_otherwise) continue;
    any = of.is_found_again = true;
    of.during = u;
    of.speed_hit = std::max(of.speed_hit, speed);
  }
  return any;
}

/// The contacts of the island's marked bodies, for the motions that the last solution gave. A body of another island is
/// not met: that is the next step's.
void ExactResponse::find_again(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                               std::size_t island, FrameCost& cost) {
  bodies_[island].first_link = kNone;
  for (std::size_t n = world.near_links.size(); n-- > 0;) {
    const std::size_t l = world.near_links[n];
    exact::ExactLink* search = methods.searching(l);
    if (search == nullptr || !is_of_island(world, l, island)) continue;
    const Link& link = world.links[l];
    const bool again = bodies_[link.first].moves_otherwise || bodies_[link.second].moves_otherwise;
    const double reach = closing(world, link);
    if (again && gap(neighbours.box(link.first), neighbours.box(link.second)) <= reach &&
        !are_apart(placed(world, link.first), placed(world, link.second), reach))
      find(world, l, *search, reach, cost);
    if (links_[l].search == nullptr || links_[l].search->rows().rows().empty()) continue;
    links_[l].next = std::exchange(bodies_[island].first_link, l);
  }
}

/// The island's bodies, rows and grips as a problem, solved. @param again  with few rows that differ
void ExactResponse::solve_problem(const World& world, std::size_t island, FrameCost& cost, bool again) {
  const OfBody& head = bodies_[island];
  for (std::size_t i = head.first_body; again && i != kNone; i = bodies_[i].next)
    bodies_[i].velocity = solver_->velocity(bodies_[i].in_solver);
  solver_->clear();
  for (std::size_t i = head.first_body; i != kNone; i = bodies_[i].next) {
    OfBody& of = bodies_[i];
    const RigidBody& rigid = world.bodies[i].rigid;
    Vector6d last;
    last << rigid.v_C, rigid.omega;
    of.in_solver = solver_->add_body(rigid.p_WC, of.step.A, of.step.free, last);
    if (again) solver_->start_from(of.in_solver, of.velocity);
  }
  const SimulationParameters& p = world.parameters;
  for (std::size_t l = head.first_link; l != kNone; l = links_[l].next)
    solver_->add_rows(links_[l].search->rows().rows(), bodies_[world.links[l].first].in_solver,
                      bodies_[world.links[l].second].in_solver,
                      {p.restitution, links_[l].overlap, links_[l].calm < kCalm});
  for (std::size_t l = head.first_link; l != kNone; l = links_[l].next) add_grip(world, l);
  cost.solver_steps += static_cast<std::uint64_t>(solver_->solve(world.dt, p.restitution_speed));
}

void ExactResponse::solve_island(const World& world, const Neighbours& neighbours, const PairMethods& methods,
                                 std::size_t island, FrameCost& cost) {
  const OfBody& head = bodies_[island];
  solve_problem(world, island, cost, false);
  // First: what slips away without its grip moves like nothing that contacts are to be found for.
  if (squeezes_light_body(world, island)) solve_problem(world, island, cost, false);
  for (int again = 0; again < kAgainMax && mark_otherwise_moved(world, island); ++again) {
    find_again(world, neighbours, methods, island, cost);
    solve_problem(world, island, cost, true);
  }
  cost.rows_left_out += solver_->left_out();
  cost.solver_unfinished += solver_->finished() ? 0 : 1;
  rows_needed_ = std::max(rows_needed_, solver_->row_count() + solver_->left_out());
  blocks_needed_ = std::max(blocks_needed_, solver_->blocks_needed());
  read_bodies(island, world.dt);
  std::size_t first_row = 0;
  for (std::size_t l = head.first_link; l != kNone; l = links_[l].next) {
    cost.rows_left_out += links_[l].search->rows().left_out();
    read_rows(world, l, first_row, cost);
    read_grip(world, l, first_row);
    first_row += links_[l].search->rows().rows().size();
  }
}

/// What the solver found for the island's bodies.
void ExactResponse::read_bodies(std::size_t island, double dt) {
  const bool alone = solver_->body_count() == 1;
  for (std::size_t i = bodies_[island].first_body; i != kNone; i = bodies_[i].next) {
    OfBody& of = bodies_[i];
    of.velocity = solver_->velocity(of.in_solver);
    of.velocity_after = solver_->velocity_after(of.in_solver);
    of.wrench = solver_->wrench(of.in_solver);
    of.shift_moment = solver_->shift_moment(of.in_solver);
    if (alone) continue;
    // A stiff row's force has the roundings of its gap times its stiffness, 1e-9 of it and more. The velocity that
    // exactly these forces give keeps the momentum of bodies that push each other.
    Vector6d impulse;
    impulse << dt * of.wrench.force, dt * of.wrench.torque;
    of.velocity_after = of.step.free + Cholesky6(of.step.A).solve(impulse);
    if (solver_->was_hit()) continue;
    of.rounded = (of.velocity_after - of.velocity).head<3>().norm();
    of.velocity = of.velocity_after;
  }
}

/// What the rows of one link do to its bodies; rows are numbered as they were added.
void ExactResponse::read_rows(const World& world, std::size_t l, std::size_t first_row, FrameCost& cost) {
  OfLink& of = links_[l];
  const Vector3d& p_WC = world.bodies[world.links[l].second].rigid.p_WC;
  VERISIM_ASSERT(first_row <= solver_->row_count() + solver_->left_out());
  const auto& rows = of.search->rows().rows();
  of.overlap = 0;
  for (std::size_t i = 0; i < rows.size() && first_row + i < solver_->row_count(); ++i) {
    const double force = solver_->force(first_row + i);
    const bool late = solver_->is_late(first_row + i);
    const bool began_inside = solver_->began_inside(first_row + i) && -rows[i].gap <= of.depth_max;  // it tells of that
    of.late = of.late || (late && (of.calm < kCalm || began_inside));
    of.was_put = of.was_put || (late && of.calm < kCalm);
    if (!late) of.overlap = std::max(of.overlap, -rows[i].gap);
    // A row that pushed and is free after the rebound has no force left, but two opposite ones at two places.
    const Vector3d rebound = solver_->rebound(first_row + i) * rows[i].normal;
    of.on_second.torque += solver_->moved(first_row + i).cross(rebound);
    if (!(force > 0)) continue;
    ++of.acting;
    const Vector3d f = force * rows[i].normal;
    of.on_second += {f, (rows[i].point - p_WC).cross(f)};
  }
  if (of.late || of.calm < kCalm) of.calm = of.late ? 0 : of.calm + (of.told ? 1 : kCalm / kTouches);
  cost.contacts += of.acting;
  bodies_[world.links[l].first].contacts += of.acting;
  bodies_[world.links[l].second].contacts += of.acting;
}

}  // namespace verisim

// The hybrid methods in the loop: which one acts on a pair, restoration between response and sum, and the exact
// response in place of both (INTERFACES section 3: hybrid).
#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/simulation/groups.hpp"

namespace verisim {
namespace {

/// Precise contacts are looked for this far ahead of what the bodies can close within the step [m]. A contact counts
/// only when it closes, so more costs time and changes nothing.
constexpr double kExactMargin = 1e-4;
constexpr std::size_t kRowsMax = 16384;

/// Bound of the velocity of any point of a body [m/s].
double speed_of(const Body& body, const Vector6d& u) {
  return u.head<3>().norm() + u.tail<3>().norm() * body.bounds_B.size().norm();
}

bool all_faces_known(const Body& body) {
  return body.exact->precise_face_count == body.exact->faces.size();
}

}  // namespace

void Simulation::Implementation::make_hybrid(const BodyDescription& description, Body& body) {
  const BodyFeatures& features = body.voxels->features;
  if (features.entity_count() == 0) return;
  body.entities = std::make_unique<EntitySets>(features.faces, features.edges, features.sets);
  if (body.hybrid != Hybrid::exact || !description.use_brep) return;
  exact::BodyOptions options;
  options.spacing = description.voxel_size;
  auto precise = std::make_shared<exact::ExactBody>(description.parts, options);
  if (precise->has_precise_faces()) body.exact = std::move(precise);
  if (!solver) solver = std::make_unique<exact::ConvexStep>(kRowsMax);
  const auto solved = std::count_if(bodies.begin(), bodies.end(), [](const Body& b) { return b.exact && b.can_move; });
  if (solved > exact::ConvexStep::kBodiesMax)
    fail(ErrorKind::input, "'{}': more than {} moving bodies are 'exact'; give the others hybrid = \"restore\"",
         body.name, exact::ConvexStep::kBodiesMax);
}

void Simulation::Implementation::make_hybrid(Link& link) {
  const Body& first = bodies[link.first];
  const Body& second = bodies[link.second];
  if (first.hybrid == Hybrid::off || second.hybrid == Hybrid::off) return;
  if (!first.entities || !second.entities) {
    if (first.entities || second.entities)
      events.push_back({0, "hybrid",
                        fmt::format("'{}' has no b-rep: its contacts with '{}' stay with the voxels",
                                    (first.entities ? second : first).name, (first.entities ? first : second).name)});
    return;
  }
  const Body& map = link.contact->first_is_map() ? first : second;
  const Body& points = link.contact->first_is_map() ? second : first;
  ConstraintOptions options;
  options.measure = parameters.alignment;
  options.reduction = parameters.reduction;
  options.scales.voxel_size = std::max(map.voxels->voxmap.voxel_size, points.voxels->voxmap.voxel_size);
  link.hybrid = std::make_unique<HybridLink>(HybridLink::Side{map.voxels.get(), map.entities.get()},
                                             HybridLink::Side{points.voxels.get(), points.entities.get()}, options);
  if (!first.exact || !second.exact) return;
  link.exact = std::make_unique<exact::ExactLink>(first.exact, second.exact);
  link.voxels_answer = !all_faces_known(first) || !all_faces_known(second);
}

Hybrid Simulation::Implementation::method_of(const Link& link) const {
  const Body& first = bodies[link.first];
  const Body& second = bodies[link.second];
  if (!link.hybrid || !first.hybrid_enabled || !second.hybrid_enabled) return Hybrid::off;
  const Hybrid method = std::min(first.hybrid, second.hybrid);
  return method == Hybrid::exact && !link.exact ? Hybrid::restore : method;
}

bool Simulation::Implementation::moves(const Body& body) const {
  return body.can_move && (parameters.all_bodies_are_dynamic || body.held_by != kNone);
}

/// The body with the points as the one with the voxmap sees it.
Pose Simulation::Implementation::relative_pose(const Link& link) const {
  const Pose X_W1 = bodies[link.first].rigid.pose();
  const Pose X_W2 = bodies[link.second].rigid.pose();
  return link.contact->first_is_map() ? X_W1.inverse() * X_W2 : X_W2.inverse() * X_W1;
}

/// An implicit step needs the matrices of restored contacts, so it restores their normals before anything is computed
/// from them. An explicit one needs forces alone, and its stiffness stays that of the voxels' contacts.
/// Returns whether a constraint holds anywhere: else the normals are the voxels'.
bool Simulation::Implementation::restore_normals(Link& link) {
  const RestoreResult result = link.hybrid->restore_normals(link.contact->contacts(), relative_pose(link));
  note(link, result);
  return result.restored > 0;
}
void Simulation::Implementation::restore_forces(Link& link) {
  note(link, link.hybrid->restore_forces(link.contact->contacts(), relative_pose(link)));
}

/// Faas's response: the collision's, mixed with the pull of a spring towards where the constraints would have the body.
/// The spring is the virtual coupling's, as weak as that of the weaker of the bodies that move.
void Simulation::Implementation::blend(Link& link, LinkSide& on_first, LinkSide& on_second) {
  const Pose X_AB = relative_pose(link);
  note(link, link.hybrid->look_up(link.contact->contacts(), X_AB));
  const bool first_is_map = link.contact->first_is_map();
  const Body& map = bodies[first_is_map ? link.first : link.second];
  const Body& points = bodies[first_is_map ? link.second : link.first];
  LinkSide& on_map = first_is_map ? on_first : on_second;
  LinkSide& on_points = first_is_map ? on_second : on_first;
  BlendParameters spring{.stiffness = parameters.max_stiffness, .angular_stiffness = parameters.max_angular_stiffness};
  for (const Body* body : {&map, &points}) {
    if (!body->can_move) continue;
    spring.stiffness = std::min(spring.stiffness, body->coupling.stiffness);
    spring.angular_stiffness = std::min(spring.angular_stiffness, body->coupling.angular_stiffness);
  }
  spring.length = 0.5 * points.bounds_B.size().norm();
  const Vector3d center_B = points.rigid.pose().inverse() * points.rigid.p_WC;
  const ConstraintForce pull = constraint_force(link.hybrid->engaged(), X_AB, center_B, spring);
  const Matrix3d R_WA = map.rigid.R_WB.toRotationMatrix();
  const Wrench pull_W{R_WA * pull.on_b.force, R_WA * pull.on_b.torque};
  on_points.wrench = blended(on_points.wrench, pull_W, pull.alpha);
  on_map.wrench = reaction(on_points.wrench, points, map);
  for (LinkSide* side : {&on_map, &on_points}) {  // the collision's part of what an implicit step is told
    side->stiffness *= 1 - pull.alpha;
    side->damping *= 1 - pull.alpha;
    side->drift *= 1 - pull.alpha;
  }
}

void Simulation::Implementation::note(Link& link, const RestoreResult& result) {
  const MemoCounts& counts = link.hybrid->counts();
  cost.recognitions += counts.recognitions - link.counted.recognitions;
  totals.null_misses += counts.misses_null - link.counted.misses_null;
  link.counted = counts;
  link.constraint = result.kind;
  link.alpha = result.alpha;
  link.cache_hits = result.hits;
  link.cache_misses = result.misses;
  cost.lookups += result.hits + result.misses;
}

/// Every body that an exact link can move is prepared without those contacts, then each island of them is solved.
void Simulation::Implementation::solve_exactly() {
  for (Body& body : bodies) {
    body.solved = false;
    body.exact_wrench = {};
    if (!body.exact || !moves(body)) continue;
    body.implicit = begin_implicit(body.rigid, body.loads, dt);
    body.velocity = body.implicit.free;
  }
  for (Link& link : links) {
    if (link.method != Hybrid::exact) continue;
    Body& first = bodies[link.first];
    Body& second = bodies[link.second];
    // The broad phase knows where bodies are, not how fast: a contact is to be there before the bodies overlap.
    link.near = link.near || box_gap(first, second) <= grown_by(first) + grown_by(second) + closing(link);
    if (!link.near) continue;
    for (Body* body : {&first, &second}) body->solved = body->solved || moves(*body);
    find_exact_contacts(link);
  }
  join_islands();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].solved && bodies[i].island == i) solve_island(i);
}

/// How far ahead contacts of two bodies are looked for [m].
double Simulation::Implementation::closing(const Link& link) const {
  double sum = kExactMargin;
  for (const Body* body : {&bodies[link.first], &bodies[link.second]})
    if (moves(*body)) sum += dt * speed_of(*body, body->velocity);
  return sum;
}

void Simulation::Implementation::find_exact_contacts(Link& link) {
  const auto motion_of = [&](const Body& body) {
    exact::BodyMotion motion{.X_WB = body.rigid.pose(), .p_WC = body.rigid.p_WC, .twist = {}};
    if (!body.solved) return motion;
    motion.twist = {body.velocity.head<3>(), body.velocity.tail<3>()};
    motion.last_twist = {body.rigid.v_C, body.rigid.omega};
    return motion;
  };
  link.exact->find(motion_of(bodies[link.first]), motion_of(bodies[link.second]), dt, closing(link));
  cost.exact_samples += link.exact->cost().samples;
  link.depth_max = std::max(link.depth_max, link.exact->depth_max());
}

/// Bodies that touch each other are solved together; an island goes by the number of its first body.
void Simulation::Implementation::join_islands() {
  join_bodies(bodies, links, &Body::island, [&](const Link& link) {
    return link.near && link.method == Hybrid::exact && !link.exact->rows().rows().empty() &&
           bodies[link.first].solved && bodies[link.second].solved;
  });
}

void Simulation::Implementation::solve_island(std::size_t island) {
  solver->clear();
  for (Body& body : bodies) {
    body.in_solver = exact::kFixed;
    if (!body.solved || body.island != island) continue;
    Vector6d last;
    last << body.rigid.v_C, body.rigid.omega;
    body.in_solver = solver->add_body(body.rigid.p_WC, body.implicit.A, body.implicit.free, last);
  }
  const auto belongs = [&](const Link& link) {
    return link.near && link.method == Hybrid::exact &&
           (bodies[link.first].in_solver != exact::kFixed || bodies[link.second].in_solver != exact::kFixed);
  };
  for (const Link& link : links)
    if (belongs(link))
      solver->add_rows(link.exact->rows().rows(), bodies[link.first].in_solver, bodies[link.second].in_solver);
  cost.solver_steps += static_cast<std::uint64_t>(solver->solve(dt));
  for (Body& body : bodies) {
    if (body.in_solver == exact::kFixed) continue;
    body.velocity = solver->velocity(body.in_solver);
    body.exact_wrench = solver->wrench(body.in_solver);
  }
  std::size_t first_row = 0;
  for (Link& link : links) {
    if (!belongs(link)) continue;
    share_out(link, first_row);
    first_row += link.exact->rows().rows().size();
  }
}

/// What the rows of one link do to its bodies; rows are numbered as they were added.
void Simulation::Implementation::share_out(Link& link, std::size_t first_row) {
  const Body& second = bodies[link.second];
  Wrench on_second;
  std::uint32_t acting = 0;
  const auto& rows = link.exact->rows().rows();
  for (std::size_t i = 0; i < rows.size() && first_row + i < solver->row_count(); ++i) {
    const double force = solver->force(first_row + i);
    if (!(force > 0)) continue;
    ++acting;
    const Vector3d f = force * rows[i].normal;
    on_second += {f, (rows[i].point - second.rigid.p_WC).cross(f)};
  }
  link.on_second += on_second;
  count_contacts(link, acting);
}

}  // namespace verisim

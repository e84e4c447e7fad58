// Rows that are hit, late or damped: see the header.
#include <cmath>
#include <limits>

#include "engine/base/cholesky.hpp"
#include "engine/exact/convex_step.hpp"

namespace verisim::exact {
namespace {

/// While it is hit a row's stiffness is at least that of the lighter body's mass times this by dt^2: the rebound is
/// right to about (1 + 1 / e) of its inverse.
constexpr double kRigid = 1e5;
/// Of the speed of approach times dt: a row whose gap is below minus that slides, and is not hit.
constexpr double kOverlapOfHit = 0.25;
/// m. By so much a row may overlap more than is known without being late: a step along a curve does that.
constexpr double kUnknown = 1e-5;
/// m. A row of any pair that overlaps by so much more is late: no step along a curve does that, so the bodies
/// overlapped before, where no row told of it.
constexpr double kImpossible = 2e-4;
/// Of sqrt(m / k): so long is a step, with tau, at least. What approaches too slowly for a hit then leaves with 0.11 of
/// its speed at most; with 0.05 where the step alone is that long.
constexpr double kDamped = 4;

/// Of the kinetic energy at the start: what begins to slide along a curve gains (v dt / 2 rho)^2 once.
constexpr double kTurnsOnce = 1e-2;

/// s >= 0 with quadratic s^2 + linear s = value, without loss of digits. @pre value >= 0; linear or quadratic is above
/// 0
double positive_root(double quadratic, double linear, double value) {
  const double root = std::sqrt(linear * linear + 4 * quadratic * value);
  return linear > 0 ? 2 * value / (linear + root) : (root - linear) / (2 * quadratic);
}

}  // namespace

/// Finds the rows that are hit if they close within the step, and makes them rigid; those that are late; and damps
/// others that would ring.
void ConvexStep::note_hits(double dt, double threshold) {
  for (const Run& run : runs_) {
    if (rows_[run.begin].both) continue;
    const double tau = damping_time(run, dt);
    if (run.pair.restitution > 0 || run.pair.overlap < std::numeric_limits<double>::infinity() || tau > 0)
      note_hits(run, dt, threshold, tau);
    if (tau > 0) damp(run, dt, tau);
  }
}

double ConvexStep::lighter_mass(const Run& run) const {
  const double mass = bodies_[at(run.body[0])].M(0, 0);
  return run.body[1] == kFixed ? mass : std::min(mass, bodies_[at(run.body[1])].M(0, 0));
}

double ConvexStep::stiffest(const Run& run) const {
  double stiffest = 0;
  for (std::size_t r = run.begin; r < run.end; ++r) stiffest = std::max(stiffest, rows_[r].k);
  return stiffest;
}

/// Of the stiffest row: of all rows that are near few act.
double ConvexStep::damping_time(const Run& run, double dt) const {
  return std::max(0.0, kDamped * std::sqrt(lighter_mass(run) / stiffest(run)) - dt);
}

void ConvexStep::damp(const Run& run, double dt, double tau) {
  for (std::size_t r = run.begin; r < run.end; ++r) {
    Row& row = rows_[r];
    RowRest& rest = rests_[r];
    if (rest.asked >= 0 || !(rest.curving - row.g > 0)) continue;
    rest.stretch = (dt + tau) / dt;
    row.J *= rest.stretch;
    rest.J_second *= rest.stretch;
    row.k /= rest.stretch;
  }
}

void ConvexStep::note_hits(const Run& run, double dt, double threshold, double tau) {
  // The same factor for all rows of the pair: one that fades in or out keeps its weight.
  const double factor = std::max(1.0, kRigid * lighter_mass(run) / (dt * dt) / stiffest(run));
  const bool is_hit = run.pair.restitution > 0 || tau > 0;
  for (std::size_t r = run.begin; r < run.end; ++r) {
    Row& row = rows_[r];
    RowRest& rest = rests_[r];
    // What began inside leaves no faster than kPushOut, however small the step is.
    const double known = run.pair.overlap + (run.pair.began_inside ? std::min(kUnknown, kPushOut * dt) : kUnknown);
    const bool watches = bodies_.size() > kDenseMax || run.pair.restitution > 0 || run.pair.began_inside;
    const double overlap = rest.curving - row.g;
    if (!is_hit && overlap <= known) continue;
    const double approach = -rate(r, &Body::before);
    const double sudden = overlap - known - std::max(0.0, approach * dt);
    rest.began_inside = sudden > kImpossible;
    parts_ = parts_ || rest.began_inside;
    if (sudden > (watches ? 0 : kImpossible)) {
      rest.late = late_ = true;
      rest.asked = 0;
      row.g = std::max(row.g, -run.pair.overlap - kPushOut * dt);
    } else if (is_hit && approach > threshold && -row.g <= kOverlapOfHit * approach * dt) {
      rest.asked = run.pair.restitution * approach;
      row.k *= factor;
    }
    hit_ = hit_ || rest.asked >= 0;
  }
}

/// J that late rows may give the bodies for this step: they move apart with kPushOut, and no faster.
double ConvexStep::energy_of_pushing_out() const {
  double most = 0, kinetic = 0;
  for (const Body& body : bodies_) {
    most += 0.5 * body.M(0, 0) * kPushOut * kPushOut;
    kinetic += 0.5 * body.before.dot(body.M * body.before);
  }
  return std::max(0.0, most - kinetic);
}

/// Takes a smaller share of all impulses where they do more work than the springs held that were pressed at the start,
/// by more than kTurnsOnce and `most`. Bodies that were put inside of each other may have no motion that parts them
/// all: late rows that work against each other, on short levers, would throw them.
void ConvexStep::limit_work(double most) {
  double linear = 0, quadratic = 0;  // work of the share s of the impulses: s linear + s^2 quadratic
  double left = most;
  for (const Body& body : bodies_) {
    const Vector6d change = body.u - body.u0;
    const Vector6d impulse = body.M * change;
    linear += impulse.dot(body.u0);
    quadratic += 0.5 * impulse.dot(change);
    left += kTurnsOnce * 0.5 * body.before.dot(body.M * body.before);
  }
  left += held_at_start();
  if (!(linear + quadratic > left)) return;
  const double share = positive_root(quadratic, linear, left);
  for (Body& body : bodies_) body.u = body.u0 + share * (body.u - body.u0);
  for (RowRest& row : rests_) {
    row.force *= share;
    row.before_rebound *= share;
  }
}

/// J that springs held at the start. Those of late rows and of pairs that began inside hold none: nothing compressed
/// them.
double ConvexStep::held_at_start() const {
  double sum = 0;
  for (const Run& run : runs_) {
    for (std::size_t r = run.begin; r < run.end && !run.pair.began_inside; ++r) {
      const RowRest& rest = rests_[r];
      if (rest.late || rows_[r].both || !(rest.force > 0)) continue;
      const double overlap = std::max(0.0, rest.curving - rows_[r].g);
      sum += 0.5 * rest.stretch * rows_[r].k * overlap * overlap;
    }
  }
  return sum;
}

/// How much of what curves may be taken: less than 1 where the contacts have done more work than the springs held that
/// were pressed at the start, by more than kTurnsOnce and what late rows may give. A row that is told of too much
/// pushes the bodies apart, the work as the square of it.
double ConvexStep::share_of_curving() const {
  double held = 0;
  bool any = false;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (row.both || !row.acts()) continue;
    any = any || rests_[r].curving < 0;
    if (rests_[r].late) continue;
    const double overlap = std::max(0.0, rests_[r].curving - row.g);
    held += 0.5 * rests_[r].stretch * row.k * overlap * overlap;
  }
  if (!any || (late_ && !parts_)) return 1;
  double work = 0, kinetic = 0;
  for (const Body& body : bodies_) {
    work += 0.5 * (body.M * (body.u - body.u0)).dot(body.before + body.u);
    kinetic += 0.5 * body.before.dot(body.M * body.before);
  }
  const double most = kTurnsOnce * kinetic + (parts_ ? energy_of_pushing_out() : 0);
  return work > held + most ? std::sqrt(most / (work - held)) : 1;
}

void ConvexStep::scale_curving(double share) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    rows_[r].g += (share - 1) * rests_[r].curving;
    rests_[r].curving *= share;
  }
}

/// From the velocities during the step to the problem of those at its end. False if no row that was hit has closed.
bool ConvexStep::begin_rebound(double dt) {
  bool any = false;
  for (std::size_t r = 0; r < rows_.size(); ++r) any = any || (rests_[r].asked >= 0 && rows_[r].z < 0);
  hit_ = any;
  if (!any) return false;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    const double asked = rests_[r].asked;
    if (row.both) continue;
    // What has not closed is the next step's; so is what was open, and closes only because of the blow: it is handed
    // on.
    const bool handed_on = asked < 0 && row.g > 0 && row.g + dt * rate(r, &Body::u0) > 0;
    if (row.z >= 0 || handed_on) {
      row.g = std::numeric_limits<double>::infinity();
    } else if (asked >= 0) {
      row.g = -dt * asked;
    }
  }
  move_rows(dt);
  evaluate_gaps(dt);
  return true;
}

/// To where the rebound acts. What a row has pushed already it has pushed where it was: with that, u0 is such that the
/// rows' forces in their new places give the velocity at the end.
void ConvexStep::move_rows(double dt) {
  for (Body& body : bodies_) body.without = body.u0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    RowRest& row = rests_[r];
    const Vector3d& u = bodies_[at(row.body[0])].during.head<3>();
    if (row.body[1] == kFixed) {  // its point moves with the body
      row.moved = dt * u;
      continue;
    }
    row.moved = 0.5 * dt * (u + bodies_[at(row.body[1])].during.head<3>());
    for (std::size_t side = 0; side < 2; ++side) {
      Body& body = bodies_[at(row.body[side])];
      Vector6d& J = jacobian(r, side);
      row.turn[side] = (row.moved - dt * body.during.head<3>()).cross(J.head<3>());
      J.tail<3>() += row.turn[side];
      if (row.force == 0) continue;
      Vector6d pushed = Vector6d::Zero();
      pushed.tail<3>() = dt * row.force * row.turn[side];
      body.u0 -= Cholesky6(body.M).solve(pushed);
    }
  }
  for (Body& body : bodies_) body.p_WC += dt * body.during.head<3>();  // the two sides of a row differ by that
  for (Run& run : runs_) run.has_sum = false;
}

/// Takes as much of the rebound as creates no energy. The work of the contacts is that of their impulse A (u - u0)
/// along the mean of the velocities before and after: a parabola in the fraction s of the rebound that is taken.
void ConvexStep::end_rebound() {
  for (Body& body : bodies_) body.u0 = body.without;
  double held = 0;  // J, by springs at the start
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const double overlap = std::max(0.0, rests_[r].curving - rows_[r].g);
    if (rests_[r].force > 0 && rests_[r].asked < 0) held += 0.5 * rests_[r].stretch * rows_[r].k * overlap * overlap;
  }
  double work = 0;  // J, without rebound
  double linear = 0;
  double quadratic = 0;
  for (const Body& body : bodies_) {
    const Vector6d more = body.u - body.during;
    const Vector6d impulse = body.M * (body.during - body.u0);
    const Vector6d impulse_more = body.M * more;
    const Vector6d twice_mean = body.before + body.during;
    work += 0.5 * impulse.dot(twice_mean);
    linear += 0.5 * (impulse.dot(more) + impulse_more.dot(twice_mean));
    quadratic += 0.5 * impulse_more.dot(more);
  }
  const double left = std::max(held - work, 0.0);  // s linear + s^2 quadratic is to stay below
  double s = 1;
  if (!late_ && linear + quadratic > left) {  // u of late rows is of no use: it pushes them apart
    s = std::clamp(positive_root(quadratic, linear, left), 0.0, 1.0);
  }
  for (Body& body : bodies_) body.u = body.during + s * (body.u - body.during);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    rests_[r].force += s * (-rows_[r].k * rows_[r].pressed(rows_[r].z) - rests_[r].force);
}

}  // namespace verisim::exact

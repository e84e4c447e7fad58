#include "engine/exact/convex_step.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::exact {
namespace {

/// Newton's method ends after a few iterations, a few dozen for a heap. This, and one per body of a heap, bounds the
/// time of a step with absurd numbers.
constexpr int kIterationsMax = 60;
/// Relative to the cost: a smaller Newton decrement is lost in its rounding. Then either the forces on each body
/// balance, to so much of their sum, or so many iterations more are of use: a body of 1e-9 kg has next to no part in
/// the cost of what lies beside it.
constexpr double kRoundingOfCost = 1e-15, kBalanced = 1e-12;
constexpr int kBelowRounding = 8;
/// Blocks below the diagonal of the sparse factor that there is room for at first, per body: a heap of boxes needs 6.
constexpr std::size_t kBlocksPerBody = 16;

}  // namespace

ConvexStep::ConvexStep(std::size_t rows_max, std::size_t bodies_max) {
  reserve(rows_max, bodies_max);
}

void ConvexStep::reserve(std::size_t rows_max, std::size_t bodies_max) {
  rows_.reserve(rows_max);
  rests_.reserve(rows_max);
  added_.reserve(rows_max);
  runs_.reserve(rows_max);
  grips_.reserve(rows_max);
  bodies_.reserve(bodies_max);
  crossing_.reserve(rows_max);
  if (bodies_max <= kDenseMax) return;
  factor_.reserve(bodies_max, kBlocksPerBody * bodies_max);
  unknowns_.reserve(6 * bodies_max);
}

void ConvexStep::clear() {
  rows_.clear();
  rests_.clear();
  added_.clear();
  runs_.clear();
  grips_.clear();
  bodies_.clear();
  left_out_ = 0;
}

int ConvexStep::add_body(const Vector3d& p_WC, const Matrix6d& M, const Vector6d& u0, const Vector6d& before) {
  VERISIM_ASSERT(bodies_.size() < bodies_.capacity());
  VERISIM_ASSERT(is_symmetric(M));
  VERISIM_ASSERT(!(M.diagonal().array() <= 0).any());
  bodies_.push_back({p_WC, M, u0, before, before, Vector6d::Zero()});
  return static_cast<int>(bodies_.size()) - 1;
}

void ConvexStep::start_from(int body, const Vector6d& u) {
  VERISIM_ASSERT(at(body) < bodies_.size());
  bodies_[at(body)].u = u;
}

void ConvexStep::add_rows(std::span<const ContactRow> rows, int first, int second, const Pair& pair) {
  VERISIM_ASSERT(is_fraction(pair.restitution));
  VERISIM_ASSERT(pair.overlap >= 0);
  VERISIM_ASSERT(first != second);
  VERISIM_ASSERT(std::min(first, second) >= kFixed);
  VERISIM_ASSERT(std::max(first, second) < static_cast<int>(bodies_.size()));
  const auto set = [&](const ContactRow& row, int body, double sign, Vector6d& J) {
    const Vector3d n = sign * row.normal;
    const Vector3d arm = row.point - bodies_[at(body)].p_WC;
    J[0] = n.x();
    J[1] = n.y();
    J[2] = n.z();
    J[3] = arm.y() * n.z() - arm.z() * n.y();
    J[4] = arm.z() * n.x() - arm.x() * n.z();
    J[5] = arm.x() * n.y() - arm.y() * n.x();
  };
  const std::size_t begin = rows_.size();
  const std::size_t added_before = added_.size();
  for (const ContactRow& from : rows) {
    if (rows_.size() == rows_.capacity() || added_.size() == added_.capacity()) {
      ++left_out_;
      continue;
    }
    const std::size_t row = new_row(second, first);
    rows_[row].g = from.gap + from.curving;
    rests_[row].curving = from.curving;
    rows_[row].k = from.stiffness;
    if (second != kFixed) set(from, second, 1, jacobian(row, 0));
    if (first != kFixed) set(from, first, -1, jacobian(row, 1));
    order_bodies(row);
    const std::size_t same = same_row(begin);
    added_.push_back({static_cast<std::uint32_t>(same), from.stiffness});
    if (same == row) continue;
    rows_[same].k += from.stiffness;
    rows_.pop_back();
    rests_.pop_back();
  }
  for (std::size_t i = added_before; i < added_.size(); ++i) added_[i].part /= rows_[added_[i].row].k;
  if (rows_.size() > begin) runs_.push_back({rests_[begin].body, begin, rows_.size(), pair});
}

/// The row from `begin` on that the last one is to be solved with: one at the same place, to rounding; else itself. Of
/// a few before it: those of neighbouring features follow each other.
std::size_t ConvexStep::same_row(std::size_t begin) const {
  constexpr std::size_t kLookBack = 48;
  constexpr double kSame = 1e-12;  // m, of gap and arm
  const std::size_t last = rows_.size() - 1;
  if (bodies_.size() <= kDenseMax) return last;
  const Row& row = rows_[last];
  const auto near = [&](double a, double b) { return std::abs(a - b) <= kSame; };
  for (std::size_t r = std::max(begin + kLookBack, last) - kLookBack; r < last; ++r) {
    const Row& other = rows_[r];
    if (near(row.g, other.g) && near(rests_[last].curving, rests_[r].curving) &&
        ((row.J - other.J).array().abs() <= kSame).all())
      return r;
  }
  return last;
}

/// The first of a row's bodies moves.
void ConvexStep::order_bodies(std::size_t row) {
  RowRest& rest = rests_[row];
  if (rest.body[0] != kFixed) return;
  std::swap(rest.body[0], rest.body[1]);
  std::swap(rows_[row].J, rest.J_second);
}

std::size_t ConvexStep::new_row(int first, int second) {
  rows_.emplace_back();
  rests_.push_back({.body = {first, second}});
  return rows_.size() - 1;
}

int ConvexStep::add_grip(const Grip& grip, int first, int second, double dt) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_unit(grip.normal));
  VERISIM_ASSERT(grip.drag >= 0);
  VERISIM_ASSERT(grip.radius >= 0);
  VERISIM_ASSERT(first != second);
  VERISIM_ASSERT(std::min(first, second) >= kFixed);
  VERISIM_ASSERT(std::max(first, second) < static_cast<int>(bodies_.size()));
  if (rows_.capacity() - rows_.size() < 3) {
    left_out_ += 3;
    return kNoGrip;
  }
  const Vector3d along = grip.normal.unitOrthogonal();
  const std::array tangents{along, Vector3d(grip.normal.cross(along)), Vector3d(Vector3d::Zero())};
  const std::size_t begin = rows_.size();
  for (const Vector3d& tangent : tangents) {
    const std::size_t row = new_row(second, first);
    rows_[row].both = true;
    rows_[row].g = 0;
    rows_[row].k = grip.drag / dt;
    for (std::size_t side = 0; side < 2; ++side) {
      if (rests_[row].body[side] == kFixed) continue;
      const Vector3d arm = grip.point - bodies_[at(rests_[row].body[side])].p_WC;
      Vector6d& J = jacobian(row, side);
      J << tangent, tangent.isZero(0) ? Vector3d(grip.radius * grip.normal) : arm.cross(tangent);
      if (side == 1) J = -J;
    }
    order_bodies(row);
  }
  runs_.push_back({rests_[begin].body, begin, rows_.size(), {}});
  grips_.push_back({begin, tangents[0], tangents[1], grip.normal, grip.radius});
  return static_cast<int>(grips_.size()) - 1;
}

/// Calls f(number of a row, dt times the rate of its gap) for all rows. The Jacobian of the second of two bodies is -T
/// times that of the first (see sum_stiffness), so of all rows of a run the rate is that of one velocity.
template <typename F>
void ConvexStep::evaluate_rates(double dt, Vector6d Body::*velocity, F&& f) const {
  for (const Run& run : runs_) {
    const Body& first = bodies_[at(run.body[0])];
    Vector6d u = first.*velocity;
    if (run.body[1] != kFixed) {
      const Body& second = bodies_[at(run.body[1])];
      const Vector6d& of_second = second.*velocity;
      const Vector3d turn = of_second.tail<3>();
      u.head<3>() -= of_second.head<3>() + turn.cross(first.p_WC - second.p_WC);
      u.tail<3>() -= turn;
    }
    u *= dt;
    for (std::size_t r = run.begin; r < run.end; ++r) f(r, rows_[r].J.dot(u));
  }
}

void ConvexStep::evaluate_gaps(double dt) {
  evaluate_rates(dt, &Body::u, [&](std::size_t r, double dz) { rows_[r].z = rows_[r].g + dz; });
}

double ConvexStep::cost() const {
  double sum = 0;
  for (const Body& body : bodies_) sum += (body.u - body.u0).dot(body.M * (body.u - body.u0));
  for (const Row& row : rows_) {
    const double pressed = row.pressed(row.z);
    sum += row.k * pressed * pressed;
  }
  return 0.5 * sum;
}

/// Starts from the velocity before (start_from) or from the motion without contact, whichever costs less.
void ConvexStep::choose_start(double dt) {
  evaluate_gaps(dt);
  const double cost_of_before = cost();
  for (Body& body : bodies_) std::swap(body.u, body.u0);  // now u is the motion without contact, u0 that before
  evaluate_gaps(dt);
  double cost_of_free = 0;
  for (const Row& row : rows_) cost_of_free += 0.5 * row.k * row.pressed(row.z) * row.pressed(row.z);
  const bool starts_free = cost_of_free <= cost_of_before;
  for (Body& body : bodies_) {
    std::swap(body.u, body.u0);
    if (starts_free) body.u = body.u0;
  }
  if (!starts_free) evaluate_gaps(dt);
}

/// The derivatives of all gaps along the search direction. Between t = 0 and 1 most rows act all along or nowhere: with
/// the first term of the cost these are one parabola. What is left are few.
void ConvexStep::prepare_line_search(double dt) {
  LineValue sum{};
  double twice_cost = 0;
  for (const Body& body : bodies_) {
    const Vector6d off = body.u - body.u0;
    const Vector6d push = body.M * body.direction;
    twice_cost += off.dot(body.M * off);
    sum.slope += off.dot(push);
    sum.curvature += body.direction.dot(push);
  }
  crossing_.clear();
  evaluate_rates(dt, &Body::direction, [&](std::size_t r, double dz) {
    Row& row = rows_[r];
    row.dz = dz;
    const bool acts = row.acts();
    if (acts) twice_cost += row.k * row.z * row.z;
    if (!row.both && acts != (row.z + dz < 0)) {
      crossing_.push_back(static_cast<std::uint32_t>(r));
    } else if (acts) {
      sum.slope += row.k * row.z * dz;
      sum.curvature += row.k * dz * dz;
    }
  });
  line_begin_ = sum;
  cost_ = 0.5 * twice_cost;
}

/// @param t  from 0 to 1
ConvexStep::LineValue ConvexStep::value_along(double t) const {
  const LineValue& begin = line_begin_;
  LineValue sum{t * (begin.slope + 0.5 * t * begin.curvature), begin.slope + t * begin.curvature, begin.curvature};
  for (const std::uint32_t r : crossing_) {
    const Row& row = rows_[r];
    const double gap = row.z + t * row.dz;
    const double pressed = std::min(0.0, row.z);
    if (!(gap < 0)) {
      sum.change -= 0.5 * row.k * pressed * pressed;
      continue;
    }
    sum.change += 0.5 * row.k * (gap - pressed) * (gap + pressed);
    sum.slope += row.k * gap * row.dz;
    sum.curvature += row.k * row.dz * row.dz;
  }
  return sum;
}

/// Line search: 1 if the full step lowers the cost enough (Armijo), else the exact minimum. It is found to the last
/// digits: a step that ends just before the next row begins to act would meet that row again in the next direction.
double ConvexStep::step_length(const LineValue& begin) const {
  constexpr double kEnough = 1e-4;  // of the slope at the start: Armijo's usual constant
  constexpr double kFlat = 1e-10;   // of the slope at the start
  LineValue here = value_along(1);
  if (here.change <= kEnough * begin.slope) return 1;
  double low = 0;
  double high = 1;
  double t = 1;
  for (int i = 0; i < 40; ++i) {  // the slope is piecewise linear and rises with t: Newton's method ends on one piece
    const double wanted = t - here.slope / here.curvature;
    t = wanted > low && wanted < high ? wanted : 0.5 * (low + high);
    here = value_along(t);
    if (std::abs(here.slope) <= -kFlat * begin.slope) break;
    (here.slope < 0 ? low : high) = t;
  }
  return t;
}

/// Takes a step of length t. True if the same rows act before and after.
bool ConvexStep::advance(double t) {
  for (Body& body : bodies_) body.u += t * body.direction;
  bool same = true;
  for (Row& row : rows_) {
    const bool acted = row.acts();
    row.z += t * row.dz;
    same = same && acted == row.acts();
  }
  return same;
}

/// Do the impulses on each body cancel, but for kBalanced of their sum?
bool ConvexStep::are_balanced(double dt) {
  for (Body& body : bodies_) {
    body.left = body.M * (body.u - body.u0);
    body.summed = {body.left.head<3>().norm(), body.left.tail<3>().norm()};
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (!rows_[r].acts()) continue;
    for (std::size_t side = 0; side < 2; ++side) {
      if (rests_[r].body[side] == kFixed) continue;
      Body& body = bodies_[at(rests_[r].body[side])];
      const Vector6d impulse = dt * rows_[r].k * rows_[r].z * jacobian(r, side);
      body.left += impulse;
      body.summed += Eigen::Vector2d(impulse.head<3>().norm(), impulse.tail<3>().norm());
    }
  }
  return std::all_of(bodies_.begin(), bodies_.end(), [](const Body& body) {
    return body.left.head<3>().norm() <= kBalanced * body.summed[0] &&
           body.left.tail<3>().norm() <= kBalanced * body.summed[1];
  });
}

int ConvexStep::minimize(double dt) {
  const bool is_sparse = bodies_.size() > kDenseMax;
  const int most = kIterationsMax + (is_sparse ? static_cast<int>(bodies_.size()) : 0);
  int below_rounding = 0;
  for (int i = 0; i < most; ++i) {
    const bool moves = bodies_.size() == 1 ? find_direction_of_one(dt)
                       : is_sparse         ? find_direction_sparse(dt)
                                           : find_direction_dense(dt);
    if (!moves) return i;
    prepare_line_search(dt);
    const LineValue begin = value_along(0);
    const double t = step_length(begin);
    const bool same = advance(t);
    // With the same rows acting the cost is one parabola, and a full Newton step ends at its minimum.
    if (same && t == 1) return i + 1;
    if (-begin.slope > kRoundingOfCost * cost_) continue;
    if (++below_rounding == kBelowRounding || are_balanced(dt)) return i + 1;
  }
  finished_ = false;
  return most;
}

int ConvexStep::solve(double dt, double threshold) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_positive(threshold));
  finished_ = true;
  hit_ = late_ = parts_ = false;
  blocks_needed_ = 0;
  unknowns_.clear();
  if (bodies_.empty()) return 0;
  note_hits(dt, threshold);
  choose_start(dt);
  int iterations = minimize(dt);
  if (const double share = share_of_curving(); share < 1) {
    scale_curving(share);
    choose_start(dt);
    iterations += minimize(dt);
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) rests_[r].force = -rows_[r].k * rows_[r].pressed(rows_[r].z);
  if (parts_) limit_work(energy_of_pushing_out());
  if (parts_) evaluate_gaps(dt);
  for (Body& body : bodies_) body.during = body.u;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    rests_[r].before_rebound = rests_[r].force;
    rests_[r].end_gap = rows_[r].g + (rows_[r].z - rows_[r].g) / rests_[r].stretch;
  }
  if (hit_ && begin_rebound(dt)) {
    iterations += minimize(dt);
    end_rebound();
  }
  if (parts_) limit_work(0);
  sum_up(dt);
  return iterations;
}

double ConvexStep::rate(std::size_t row, Vector6d Body::*velocity) const {
  const RowRest& rest = rests_[row];
  double rate = rows_[row].J.dot(bodies_[at(rest.body[0])].*velocity);
  if (rest.body[1] != kFixed) rate += rest.J_second.dot(bodies_[at(rest.body[1])].*velocity);
  return rate;
}

void ConvexStep::sum_up(double dt) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const RowRest& row = rests_[r];
    if (row.force == 0 && row.before_rebound == 0) continue;
    for (std::size_t side = 0; side < 2; ++side) {
      if (row.body[side] == kFixed) continue;
      Body& body = bodies_[at(row.body[side])];
      const Vector6d& J = jacobian(r, side);
      body.push += row.force * J;
      if (!hit_) continue;
      body.push.tail<3>() -= row.before_rebound * row.turn[side];
      const Vector3d more = (row.force - row.before_rebound) * J.head<3>();
      body.shift_moment += dt * body.during.head<3>().cross(more);
    }
  }
}

const Vector6d& ConvexStep::velocity(int body) const {
  VERISIM_ASSERT(at(body) < bodies_.size());
  return bodies_[at(body)].during;
}

const Vector6d& ConvexStep::velocity_after(int body) const {
  VERISIM_ASSERT(at(body) < bodies_.size());
  return bodies_[at(body)].u;
}

Wrench ConvexStep::grip_wrench(int grip) const {
  VERISIM_ASSERT(at(grip) < grips_.size());
  const PlacedGrip& g = grips_[at(grip)];
  const RowRest* rows = &rests_[g.first_row];
  const auto pull = [&](auto of) { return Vector3d(of(rows[0]) * g.along + of(rows[1]) * g.across); };
  const Vector3d more = pull([](const RowRest& row) { return row.force - row.before_rebound; });
  return {pull([](const RowRest& row) { return row.force; }),
          rows[2].force * g.radius * g.normal + rows[0].moved.cross(more)};
}

Wrench ConvexStep::wrench(int body) const {
  VERISIM_ASSERT(at(body) < bodies_.size());
  const Vector6d& push = bodies_[at(body)].push;
  return {push.head<3>(), push.tail<3>()};
}

const Vector3d& ConvexStep::shift_moment(int body) const {
  VERISIM_ASSERT(at(body) < bodies_.size());
  return bodies_[at(body)].shift_moment;
}

}  // namespace verisim::exact

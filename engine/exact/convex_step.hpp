// One step of several bodies in contact as one convex problem: the velocities u at the end of the step minimise
//
//   1/2 (u - u0)^T M (u - u0)  +  sum_i k_i/2 min(0, g_i + dt J_i u)^2
//
// u0: velocities without contact. M: the bodies' inertia, plus dt D + dt^2 K of forces that are linearly implicit, as
// those of the virtual coupling. g_i, k_i, J_i: gap, stiffness and Jacobian of row i.
//
// This is the penalty method with forces at the end of the step instead of its beginning; it is stable for any
// stiffness. The cost is strictly convex, so semi-smooth Newton with a line search converges to its one minimum. Each
// iteration is one Cholesky solve with 6 unknowns per body: dense for a few bodies, sparse for more
// (block_cholesky.hpp). The same formulation with friction: Castro et al., "An unconstrained convex formulation of
// compliant contact" (SAP), 2022.
//
// Impacts. The velocity u above is zero across a contact that closes: an inelastic blow. Where rows are hit the bodies
// move with u, but the step ends with the velocity w that minimises the same cost over the rows that push, where those
// that were hit ask for J w >= e v instead: Newton's law of impact, as in Moreau and Jean's time stepping (Acary and
// Brogliato, "Numerical Methods for Nonsmooth Dynamical Systems", 2008, chapter 10). v is the speed of approach at the
// start of the step, e the restitution.
//   - A row is hit if v is above the threshold speed and its gap is at least -v dt / 4; with e = 0 only where the step
//     is too short for implicit Euler to do the same (see Damping).
//     A body that lies has no speed of approach; one that slides along a curved path has, but its gap will be half of v
//     dt below zero (ContactRow::curving).
//   - A row that was open and closes only because of a blow is left out: the next step finds it hit. So a blow is
//     handed on from body to body, one per step.
//   - While it is hit a row is as stiff as rigid bodies: a blow is over within the step, whatever the stiffness.
//   - w is moved towards u until the contacts give no more energy than their springs held. Several blows at once could
//     create energy otherwise (a chain whose bodies are parting when it is hit).
//   - What w has more than u is an impulse at the end of the step, when the bodies have moved: it acts at one place for
//     both, the row's point moved by the mean of their velocities. So u, w and what is between them keep the angular
//     momentum, too.
// Damping. Springs alone are elastic. What keeps a contact from ringing is the step itself: implicit Euler's damping,
// which fades where the step is no longer long beside sqrt(m / k), in short steps and soft contacts. There a row that
// overlaps is damped, with the time tau = max(0, kDamped sqrt(m / k) - dt): its force is -k (g + (dt + tau) J u). k: of
// the stiffest row of the two bodies, m: of the lighter one. Friction. A grip is a quadratic term more, dt c/2 |w|^2,
// of the velocity w of one body against the other at one point: along two tangents, and of their spin about the normal.
// It takes energy and keeps momentum. How large c is the caller says. Late rows. A row that overlaps by more than the
// pair did before and the approach explains was not there when it should have been. Nothing compressed it, so it has no
// energy to give: it moves the bodies apart, no faster than kPushOut, and asks for J w >= 0. Of more than kDenseMax
// bodies, with restitution, or of a pair that began inside of each other that is so by how little ever; else by 0.2 mm
// or more.
//
// Curves. What a row is told of them (ContactRow::curving) may be wrong: it is a guess of the motion. Where the
// contacts would do more work than the springs held, by more than 1 % of the kinetic energy, all rows take a smaller
// share of it. Light bodies. One of 1e-9 kg has next to no part in the cost of what lies beside it. Where the cost has
// converged to its rounding the iterations go on until the impulses on each body balance, a few times.
//
// World coordinates; a velocity is (v, omega) of the centre of mass. SI units. No allocation after the constructor but
// in reserve and reserve_blocks. Sums are taken in the order in which rows were added.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/exact/block_cholesky.hpp"
#include "engine/exact/contact_rows.hpp"

namespace verisim::exact {

/// Number of a body that does not move.
inline constexpr int kFixed = -1;

class ConvexStep {
 public:
  static constexpr int kDenseMax = 8;  ///< up to so many bodies the Newton system is one dense matrix

  /// Room as reserve(rows_max, bodies_max).
  explicit ConvexStep(std::size_t rows_max, std::size_t bodies_max = kDenseMax);

  /// Room for so many rows and bodies of one problem; more than now, never less. It allocates: between steps.
  void reserve(std::size_t rows_max, std::size_t bodies_max);
  /// Room for so many blocks of a sparse factor below its diagonal. It allocates: between steps.
  void reserve_blocks(std::size_t blocks) { factor_.reserve(0, blocks); }

  /// Removes all bodies and rows. Nothing is kept: the answer depends on this step alone.
  void clear();

  /// @param M   about the centre of mass
  /// @param u0  velocity that the body would have without contact
  /// @param before  velocity at the start of the step: speeds of approach are those that it gives, and the search for
  ///        the minimum may begin there
  /// @pre fewer than bodies_max bodies so far; M is symmetric positive definite  @returns the body's number
  int add_body(const Vector3d& p_WC, const Matrix6d& M, const Vector6d& u0, const Vector6d& before);
  /// The search for the minimum begins at this velocity instead of the one before.
  /// @pre body is a number from add_body; solve has not been called since
  void start_from(int body, const Vector6d& u);

  /// What is known of two bodies beside their rows.
  struct Pair {
    double restitution = 0;                                    ///< e, in [0, 1]; 0: none of the rows is ever hit
    double overlap = std::numeric_limits<double>::infinity();  ///< m, before: deeper rows may be late
    bool began_inside = false;  ///< overlapped when it was first seen: deeper rows are late, by how little ever
  };
  /// Adds rows between two bodies. Rows beyond rows_max are left out and counted. Of more than kDenseMax bodies rows at
  /// one place are solved as one: in a heap of boxes a quarter of them. It changes nothing but roundings.
  /// @pre both are numbers from add_body or kFixed, and not the same
  void add_rows(std::span<const ContactRow> rows, int first, int second, const Pair& pair);
  void add_rows(std::span<const ContactRow> rows, int first, int second) { add_rows(rows, first, second, {}); }
  static constexpr double kPushOut = 0.5;  ///< m/s

  /// Friction between two bodies, as in add_rows.
  struct Grip {
    Vector3d point = Vector3d::Zero();    ///< m, where it acts
    Vector3d normal = Vector3d::UnitZ();  ///< unit; it acts across it
    double radius = 0;                    ///< m, of the ring about the normal by which it resists a spin
    double drag = 0;                      ///< N s/m
  };
  /// @pre drag >= 0 and radius >= 0, finite; dt is that of solve  @returns its number, kNoGrip: there is no room
  int add_grip(const Grip& grip, int first, int second, double dt);
  static constexpr int kNoGrip = -1;

  /// Solves for the velocities. @returns the number of Newton iterations; 0 if no row acts. About 1 us for one body and
  /// 20 rows that act. @param threshold  m/s, > 0: a slower approach is no impact
  /// @pre dt is finite and above 0; it is called once after clear()
  int solve(double dt, double threshold = kThreshold);
  static constexpr double kThreshold = 0.01;  ///< m/s

  /// @pre body is a number from add_body, here and below
  /// The velocity with which the body moves during the step.
  [[nodiscard]] const Vector6d& velocity(int body) const;
  /// The velocity that it has at the end: the same but where a row was hit.
  [[nodiscard]] const Vector6d& velocity_after(int body) const;
  [[nodiscard]] bool was_hit() const { return hit_; }  ///< any row, or late and pushing, in the last solve
  /// Contact wrench on a body about its centre of mass. Rows in their order. dt of it takes u0 to velocity_after().
  [[nodiscard]] Wrench wrench(int body) const;
  /// What is to be added to its torque for the torque about where the centre of mass was at the start: what a rebound
  /// gives acts at the end.
  [[nodiscard]] const Vector3d& shift_moment(int body) const;
  /// Normal force of the i-th row added [N, >= 0].
  [[nodiscard]] double force(std::size_t row) const { return part(row) * row_of(row).stretch * row_of(row).force; }
  /// How much more the rebound made of that, and by how much the place has moved where it acts [N, m].
  [[nodiscard]] double rebound(std::size_t row) const {
    return part(row) * row_of(row).stretch * (row_of(row).force - row_of(row).before_rebound);
  }
  [[nodiscard]] const Vector3d& moved(std::size_t row) const { return row_of(row).moved; }
  /// Of a grip on its second body, about the grip's point.
  [[nodiscard]] Wrench grip_wrench(int grip) const;
  /// Was it late? Then its overlap is none that a later row may have.
  [[nodiscard]] bool is_late(std::size_t row) const { return row_of(row).late; }
  /// Late by so much that its bodies overlapped before, where no row told of it?
  [[nodiscard]] bool began_inside(std::size_t row) const { return row_of(row).began_inside; }
  /// Its linearised gap at the end of the step [m].
  [[nodiscard]] double gap_at_end(std::size_t row) const { return row_of(row).end_gap; }
  [[nodiscard]] std::size_t body_count() const { return bodies_.size(); }
  [[nodiscard]] std::size_t rows_max() const { return rows_.capacity(); }
  [[nodiscard]] std::size_t row_count() const { return added_.size(); }  ///< of add_rows
  [[nodiscard]] std::size_t left_out() const { return left_out_; }       ///< rows beyond rows_max
  /// Did the last solve end at the minimum? False: at the largest number of iterations, somewhere on the way.
  [[nodiscard]] bool finished() const { return finished_; }
  /// Blocks of the sparse factor of the last solve; 0: it was dense. Above blocks_max() there was no room for them: the
  /// search for the minimum then took each body by itself, which takes many more iterations.
  [[nodiscard]] std::size_t blocks_needed() const { return blocks_needed_; }
  [[nodiscard]] std::size_t blocks_max() const { return factor_.blocks_max(); }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static constexpr double kNothing = -1;
  struct Body {
    Vector3d p_WC;
    Matrix6d M;
    Vector6d u0, before, u, direction;
    Vector6d during = Vector6d::Zero();   ///< velocity()
    Vector6d push = Vector6d::Zero();     ///< wrench()
    Vector6d without = Vector6d::Zero();  ///< u0 of the step, while u0 is that of the rebound
    Vector3d shift_moment = Vector3d::Zero();
    Vector6d left = Vector6d::Zero();  ///< N s, N m s: sum of all impulses
    Eigen::Vector2d summed{0, 0};      ///< likewise, of their magnitudes
  };
  /// What each iteration reads of a row.
  struct Row {
    Vector6d J;  ///< Jacobian: rate of the gap by the velocity of its first body
    double g, k;
    double z = 0;         ///< gap at the end of the step
    double dz = 0;        ///< its change along the search direction
    bool summed = false;  ///< in the stiffness of its run
    bool both = false;    ///< of a grip: it pulls as well
    [[nodiscard]] double pressed(double gap) const { return both ? gap : std::min(0.0, gap); }
    [[nodiscard]] bool acts() const { return both || z < 0; }
  };
  /// The rest of it.
  struct RowRest {
    std::array<int, 2> body;               ///< the second may be kFixed
    Vector6d J_second = Vector6d::Zero();  ///< as J
    double curving = 0;                    ///< m, of g: what curved motion will take from the gap
    double force = 0, end_gap = 0;
    double before_rebound = 0;                                         ///< N, of the force
    Vector3d moved = Vector3d::Zero();                                 ///< m, of its point until the rebound
    std::array<Vector3d, 2> turn{Vector3d::Zero(), Vector3d::Zero()};  ///< what the Jacobians have gained by that
    double asked = kNothing;  ///< m/s, the rate at least; kNothing: neither hit nor late
    double stretch = 1;       ///< (dt + tau) / dt: by so much the Jacobians are longer and the force is smaller
    bool late = false, began_inside = false;
  };
  /// A row as it was added. Several may be one row of the problem: where the ends of two edges and the corner between
  /// them touch a face there are three at one place.
  struct Added {
    std::uint32_t row;
    double part;  ///< of that row's stiffness, and so of its force
  };
  /// Rows between the same two bodies, one after the other.
  struct Run {
    std::array<int, 2> body;  ///< as of its rows
    std::size_t begin, end;
    Pair pair;
    bool joined = false;   ///< in the pattern of the sparse system
    bool has_sum = false;  ///< is the stiffness that of the rows that act now?
    /// What the rows that act add to the sparse system: to either body's block, and to theirs.
    Matrix6d of_first = Matrix6d::Zero(), of_second = Matrix6d::Zero(), across = Matrix6d::Zero();
  };
  /// Its rows: along two tangents, and the spin.
  struct PlacedGrip {
    std::size_t first_row;
    Vector3d along, across, normal;
    double radius;
  };
  /// What the cost has changed by along the search direction, and its first two derivatives, at step length t.
  struct LineValue {
    double change, slope, curvature;
  };

  [[nodiscard]] const RowRest& row_of(std::size_t added) const { return rests_[added_[added].row]; }
  [[nodiscard]] double part(std::size_t added) const { return added_[added].part; }
  [[nodiscard]] Vector6d& jacobian(std::size_t row, std::size_t side) {
    return side == 0 ? rows_[row].J : rests_[row].J_second;
  }
  std::size_t new_row(int first, int second);
  void order_bodies(std::size_t row);
  [[nodiscard]] std::size_t same_row(std::size_t begin) const;
  int minimize(double dt);
  void note_hits(double dt, double threshold);
  void note_hits(const Run& run, double dt, double threshold, double tau);
  [[nodiscard]] double lighter_mass(const Run& run) const;
  [[nodiscard]] double stiffest(const Run& run) const;
  [[nodiscard]] double damping_time(const Run& run, double dt) const;
  void damp(const Run& run, double dt, double tau);
  [[nodiscard]] double share_of_curving() const;
  [[nodiscard]] double energy_of_pushing_out() const;
  void limit_work(double most);
  [[nodiscard]] double held_at_start() const;
  void scale_curving(double share);
  [[nodiscard]] bool begin_rebound(double dt);
  void move_rows(double dt);
  void end_rebound();
  void sum_up(double dt);
  [[nodiscard]] double rate(std::size_t row, Vector6d Body::*velocity) const;
  void choose_start(double dt);
  void evaluate_gaps(double dt);
  template <typename F>
  void evaluate_rates(double dt, Vector6d Body::*velocity, F&& f) const;
  [[nodiscard]] double cost() const;
  bool find_direction_of_one(double dt);
  bool find_direction_dense(double dt);
  bool find_direction_sparse(double dt);
  [[nodiscard]] bool join_acting_runs();
  void analyze();
  void add_run(Run& run, double dt);
  void sum_stiffness(Run& run, double dt);
  void prepare_line_search(double dt);
  [[nodiscard]] LineValue value_along(double t) const;
  [[nodiscard]] double step_length(const LineValue& begin) const;
  bool advance(double t);
  [[nodiscard]] bool are_balanced(double dt);

  std::vector<Row> rows_;
  std::vector<RowRest> rests_;
  std::vector<Added> added_;
  std::vector<Run> runs_;
  std::vector<PlacedGrip> grips_;
  std::vector<Body> bodies_;
  BlockCholesky factor_;
  std::vector<double> unknowns_;  ///< of the sparse system, 6 per body
  bool coupled_ = false;          ///< is there room for the blocks of pairs?
  std::size_t blocks_needed_ = 0;
  std::size_t left_out_ = 0;
  bool finished_ = true, hit_ = false, late_ = false;
  bool parts_ = false;      ///< does any row say that its bodies began inside of each other?
  double cost_ = 0;         ///< at the start of the search direction
  LineValue line_begin_{};  ///< of all that is one parabola along the direction, for t from 0 to 1, at t = 0
  /// The others: rows that begin or cease to act somewhere between. Their numbers.
  std::vector<std::uint32_t> crossing_;
};

}  // namespace verisim::exact

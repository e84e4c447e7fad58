// The smoothest movement from one place to another: minimum jerk (Flash & Hogan 1985), a polynomial of fifth degree in
// time. From rest to rest it peaks at 1.875 d/T.
//
// One that is corrected on its way goes on from the place, velocity and acceleration that it has, so that nothing
// jumps. Where the correction takes much longer than what is left, what is left runs out as it would have, and the
// correction is added to it (superposition: Henis & Flash 1991, NIPS 4); stretched over the longer time the old motion
// would swing far out.
#pragma once

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/pose.hpp"

namespace verisim {

class MinimumJerk {
 public:
  /// At rest.
  explicit MinimumJerk(const Vector3d& place) { base_.end = place; }

  /// From where it is at t to rest at `end` in T. @pre T is finite and above 0
  void correct(double t, const Vector3d& end, double T) { plan(t, at(t), this->end(), end, T); }
  /// The same in coordinates in which it is at `place` now and its end was `old_end`.
  void correct_from(double t, const Vector3d& place, const Vector3d& old_end, const Vector3d& end, double T) {
    State now = at(t);
    now.x = place;
    plan(t, now, old_end, end, T);
  }
  [[nodiscard]] Vector3d place(double t) const { return at(t).x; }
  [[nodiscard]] Vector3d velocity(double t) const { return at(t).v; }
  [[nodiscard]] Vector3d end() const { return base_.end + added_.end; }
  /// s, until it is at rest
  [[nodiscard]] double left(double t) const { return std::max(base_.left(t), added_.left(t)); }

 private:
  static constexpr double kMuchLonger = 2;
  struct State {
    Vector3d x = Vector3d::Zero(), v = Vector3d::Zero(), a = Vector3d::Zero();
  };
  struct Polynomial {
    double start = 0, T = 0;
    State from;  ///< velocity and acceleration per T
    Vector3d c3 = Vector3d::Zero(), c4 = Vector3d::Zero(), c5 = Vector3d::Zero();
    Vector3d end = Vector3d::Zero();

    [[nodiscard]] double left(double t) const { return std::max(0.0, start + T - t); }
    [[nodiscard]] State at(double t) const {
      if (!(t < start + T)) return {end, Vector3d::Zero(), Vector3d::Zero()};
      const double s = (t - start) / T;
      const auto& [x, v, a] = from;
      return {x + s * (v + s * (a / 2 + s * (c3 + s * (c4 + s * c5)))),
              (v + s * (a + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))) / T,
              (a + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))) / (T * T)};
    }
  };

  static Polynomial movement(double t, const State& now, const Vector3d& end, double T) {
    VERISIM_ASSERT(is_positive(T));
    const Vector3d d = end - now.x, v = T * now.v, a = T * T * now.a;
    Polynomial p;
    p.start = t;
    p.T = T;
    p.from = {now.x, v, a};
    p.end = end;
    p.c3 = 10 * d - 6 * v - 1.5 * a;
    p.c4 = -15 * d + 8 * v + 1.5 * a;
    p.c5 = 6 * d - 3 * v - 0.5 * a;
    return p;
  }
  void plan(double t, const State& now, const Vector3d& old_end, const Vector3d& end, double T) {
    const double rest = left(t);
    if (rest > 0 && T > kMuchLonger * rest) {
      base_ = movement(t, now, old_end, rest);
      added_ = movement(t, State(), end - old_end, T);
    } else {
      base_ = movement(t, now, end, T);
      added_ = Polynomial();
    }
  }
  [[nodiscard]] State at(double t) const {
    const State a = base_.at(t), b = added_.at(t);
    return {a.x + b.x, a.v + b.v, a.a + b.a};
  }

  Polynomial base_, added_;
};

}  // namespace verisim

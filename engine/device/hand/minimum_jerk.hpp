// The smoothest movement from one place to another: minimum jerk (Flash & Hogan 1985), a polynomial of fifth degree in
// time. From rest to rest it peaks at 1.875 d/T. One that is corrected on its way goes on from the place, velocity and
// acceleration that it has (as Hoff & Arbib 1993 do), so that nothing jumps.
#pragma once

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/pose.hpp"

namespace verisim {

class MinimumJerk {
 public:
  /// At rest.
  explicit MinimumJerk(const Vector3d& place) : x_(place), end_(place) {}

  /// From where it is at t to rest at `end` in T. @pre T is finite and above 0
  void correct(double t, const Vector3d& end, double T) {
    const State now = at(t);
    begin(t, now, end, T);
  }
  /// Goes on as if all places were `shift` further: for a change of the origin.
  void move_origin(double t, const Vector3d& place, const Vector3d& end, double T) {
    State now = at(t);
    now.x = place;
    begin(t, now, end, T);
  }
  [[nodiscard]] Vector3d place(double t) const { return at(t).x; }
  [[nodiscard]] Vector3d velocity(double t) const { return at(t).v; }
  [[nodiscard]] const Vector3d& end() const { return end_; }
  /// s, until it is at rest
  [[nodiscard]] double left(double t) const { return std::max(0.0, start_ + T_ - t); }

 private:
  struct State {
    Vector3d x, v, a;
  };
  void begin(double t, const State& now, const Vector3d& end, double T) {
    VERISIM_ASSERT(is_positive(T));
    start_ = t;
    T_ = T;
    x_ = now.x;
    v_ = T * now.v;
    a_ = T * T * now.a;
    end_ = end;
    const Vector3d d = end - now.x;
    c3_ = 10 * d - 6 * v_ - 1.5 * a_;
    c4_ = -15 * d + 8 * v_ + 1.5 * a_;
    c5_ = 6 * d - 3 * v_ - 0.5 * a_;
  }
  [[nodiscard]] State at(double t) const {
    if (!(t < start_ + T_)) return {end_, Vector3d::Zero(), Vector3d::Zero()};
    const double s = (t - start_) / T_;
    return {x_ + s * (v_ + s * (a_ / 2 + s * (c3_ + s * (c4_ + s * c5_)))),
            (v_ + s * (a_ + s * (3 * c3_ + s * (4 * c4_ + s * 5 * c5_)))) / T_,
            (a_ + s * (6 * c3_ + s * (12 * c4_ + s * 20 * c5_))) / (T_ * T_)};
  }

  double start_ = 0, T_ = 0;
  Vector3d x_, v_ = Vector3d::Zero(), a_ = Vector3d::Zero();  ///< at the start, per T
  Vector3d c3_ = Vector3d::Zero(), c4_ = Vector3d::Zero(), c5_ = Vector3d::Zero();
  Vector3d end_;
};

}  // namespace verisim

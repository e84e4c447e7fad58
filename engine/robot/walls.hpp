// Virtual walls: the base stops short of the room's boundary at any gain (dissertation section 5.5, future work: "there
// are presently no specific safeties ... to prevent the mobile robot from contacting the projection screens or the
// walls", "computer-side approaches using the tracked position of the base to modify velocity commands before they are
// sent"). Floor coordinates F, robot coordinates R, SI. One call per millisecond; no allocation after construction,
// about 0.5 us.
//
// The bound. Let c(t) be the commanded velocity toward one wall and w(t) the base's. The promise is for a base that
//   (1) has in force a command that was given at most `delay` ago: server period, line, firmware period, lost frames;
//   (2) slows down: while w > c in force, dw/dt <= -min(deceleration, (w - c) / lag); and gains no more than up to c;
//   (3) turns no faster than omega_max, and is measured within `margin` and `yaw_error`.
// Then e(t), which follows the largest command of the last `delay` at once upwards, and by (2) downwards, is never
// below w. The room left in front of a wall is at least
//   r = distance when measured - radius - margin - integral of e since then,
// and after a command of v, if zero follows, the base goes at most
//   stop(v) = v (delay + 1 ms + lag) + v^2 / (2 deceleration),   v = max(e, command).
// Each millisecond one of two things is commanded: v with stop(max(e, v)) <= r, or 0 if stop(e) > r. The first is safe
// by its inequality; the second because zero is what the millisecond before counted on. So by induction no wall is
// touched, for any latency and any dropout: age enters r through the integral. What is commanded in the first case is
//   v <= kappa r and stop(v) <= r,   kappa = lambda (1 - lambda lag) exp(-lambda (delay + 1 ms)),
//   lambda = 1 / (delay + 1 ms + lag + speed_max / (2 deceleration)),
// an exponential approach: in a steady one e is lambda r and stop(e) at most r, so that 0 is needed after a dropout
// only.
//
// While the base turns, the direction of a command is known within delta = yaw_error + omega_max (age + delay + 2 lag).
// A command counts at its worst within that, and 1 mm/s more for rounding: c = v . n + delta |v| + 1 mm/s.
//
// What pulls the base along against its motors is not in the bound: within the margin it is driven back.
//
// A server that is killed leaves its command in force until the firmware's watchdog acts: `delay` has to hold that time
// too (0.36 s: 250 ms, then to 0 within 200 ms) where walls shall hold then as well.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/robot/base_tracker.hpp"
#include "engine/robot/notes.hpp"

namespace verisim::robot {

struct WallSettings {
  std::vector<std::array<double, 2>> corners;  ///< m, F: of a convex room, counter-clockwise; 3 to 8
  double radius = 0.27;   ///< m: of a disc about the base that holds its outline at any heading. Nexus: 0.40 x 0.36 m
  double margin = 0.010;  ///< m: more than the tracker is off
  double delay = 0.060;   ///< s: 20 ms server, 5 line, 10 firmware, one frame lost. At most 1
  double lag = 0.080;     ///< s: of the base's velocity behind its command, motors and arm of the device included
  double deceleration = 1.5;  ///< m/s^2: what the base can do at least
  double speed_max = 0.573;   ///< m/s
  double omega_max = 0.5;     ///< rad/s; rotation commands are limited to it
  double yaw_error = 0.010;   ///< rad: more than the tracker is off
  double stiffness = 200;     ///< N/m: of what the hand feels when a wall holds the base back
  double force_max = 10;      ///< N: of the same; the Virtuose's continuous force
};

/// The corners of [x_min, x_max] x [y_min, y_max].
[[nodiscard]] std::vector<std::array<double, 2>> rectangle(double x_min, double x_max, double y_min, double y_max);

class Walls {
 public:
  static constexpr std::size_t kMost = 8;

  /// For a base at rest. Error(input) for settings out of range, a room that is not convex, or one that the base does
  /// not fit into.
  explicit Walls(const WallSettings& settings);

  /// Takes one millisecond: what may be commanded instead of `wanted` [R], and is taken to be commanded. Along a wall
  /// the base stays free. Before the first report of the tracker, and when the last is older than 4 s, it stands.
  /// @pre wanted is finite
  [[nodiscard]] PlanarTwist limit(const PlanarTwist& wanted, const TrackedBase& tracked);

  /// What the base was told and did until now is not known: up to speed_max toward any wall is taken for granted.
  void forget();

  /// The force on the hand [N, R] that takes the place of what the base may not follow: a spring from the handle
  /// towards the neutral point, along the normals of the walls that hold the base back, for error_R [m]. It grows from
  /// nothing as the wall takes hold, is stiffness x error at the wall, whatever the gain, and never more than
  /// force_max. For the last call of limit(). No error that is not finite makes a force.
  [[nodiscard]] std::array<double, 2> limit_force(const std::array<double, 2>& error_R) const;

  [[nodiscard]] bool is_limiting() const { return limiting_.is_on(); }
  [[nodiscard]] double kappa() const { return kappa_; }  ///< 1/s: speed allowed per room left
  /// Room in front of the nearest wall at the last call [m]: the bound r.
  [[nodiscard]] double room_left() const;
  void report(RobotNotes& notes) { limiting_.report(notes); }

 private:
  struct Wall {
    std::array<double, 2> n;       ///< unit, outward
    double d;                      ///< n . p <= d inside
    double e = 0;                  ///< bound of the base's velocity toward it [m/s]
    double went = 0;               ///< its integral since the beginning [m]
    double room = 0;               ///< r
    double allowed = 0;            ///< m/s toward it
    double asked = 0;              ///< m/s toward it: what was wanted
    double given = 0;              ///< and what was commanded
    std::vector<double> commands;  ///< ring: those of the last `delay`
    std::vector<double> history;   ///< ring: `went` of each millisecond
  };
  void measure(Wall& wall, const TrackedBase& tracked) const;
  void come_back(std::array<double, 2>& v, const TrackedBase& tracked) const;
  void slide(std::array<double, 2>& v) const;
  void command(Wall& wall, double c);
  [[nodiscard]] double stop(double v) const;

  WallSettings settings_;
  std::vector<Wall> walls_;
  double lambda_, kappa_, delta_ = 0;
  std::array<double, 2> heading_{1, 0};  ///< cosine and sine of the tracked yaw
  std::uint64_t now_ = 0;
  Spell limiting_{"walls", "hold the base back", "let the base go", 200};
};

}  // namespace verisim::robot

// Kinematics of a base on four mecanum wheels whose rollers stand at 45 degrees to the axles (dissertation
// section 5.3.1; ORACLES section 2, "Mecanum" and "Mecanum without slip"). Pure functions: no state, no allocation,
// tens of flops.
//
// Robot coordinates R: x forward, y left, origin in the middle of the wheels. Floor coordinates F: x and y on the
// floor, theta counter-clockwise seen from above. SI units. A wheel's speed is positive when it rolls the robot
// forward.
//
// Seen from above. The rollers that are seen, on top, form an X; those that stand on the floor, below, are their mirror
// images and form a diamond: their axles are the lines drawn here, and a wheel pushes the base along its line alone,
// because across it its roller rolls freely.
//
//              x, forward
//                 ^
//       FL  \     |     /  FR          a_FL = (1, -1) / sqrt 2        a_FR = (1,  1) / sqrt 2
//            \    |    /
//      y <--------+                    a_RL = (1,  1) / sqrt 2        a_RR = (1, -1) / sqrt 2
//            /         \               .
//       RL  /           \  RR
//
// Hub i at p_i moves with v + omega x p_i, its rim over the floor with r w_i along x. Along the roller's axle both must
// agree: a_i . (v + omega x p_i) = a_i . (r w_i, 0). With p_FL = (l, w) and so on that is, times sqrt 2,
//
//   r w_FL = vx - vy - (l + w) omega        r w_FR = vx + vy + (l + w) omega
//   r w_RL = vx + vy - (l + w) omega        r w_RR = vx - vy + (l + w) omega
//
// Of four speeds three are free. Front minus rear, w_FL + w_FR - w_RL - w_RR, is 2 vx - 2 vx = 0 without slip.
#pragma once

#include <array>
#include <cstddef>

namespace verisim::robot {

/// The order of wheels everywhere: in arrays, in encoder traces (e0 to e3), on the wire.
enum Wheel : std::size_t { kFrontLeft = 0, kFrontRight = 1, kRearLeft = 2, kRearRight = 3 };
inline constexpr std::size_t kWheels = 4;

/// Of each wheel: angular velocity [rad/s] or angle [rad], duty, counts ...
using PerWheel = std::array<double, kWheels>;

/// Nexus 4WD (ORACLES section 2).
struct MecanumGeometry {
  double half_base = 0.150;     ///< l: half the distance of the front from the rear axle [m]
  double half_track = 0.150;    ///< w: half the distance of the left from the right wheels [m]
  double wheel_radius = 0.050;  ///< r [m]
};

/// Velocity of the base in robot coordinates, or a small displacement in them.
struct PlanarTwist {
  double vx = 0;     ///< forward [m/s]
  double vy = 0;     ///< left [m/s]
  double omega = 0;  ///< counter-clockwise seen from above [rad/s]
};

/// Where the base is: floor coordinates.
struct PlanarPose {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad], not wrapped: a full turn is 2 pi more
};

/// Inverse kinematics: the wheels' angular velocities [rad/s] that move the base with `twist` without slip.
[[nodiscard]] PerWheel wheel_speeds(const MecanumGeometry& geometry, const PlanarTwist& twist);

/// Forward kinematics: the twist that the wheels' angular velocities [rad/s] come to. Four speeds overdetermine three
/// unknowns: this is the least-squares answer, whose error is `slip_residual` alone.
[[nodiscard]] PlanarTwist twist_of(const MecanumGeometry& geometry, const PerWheel& speeds);

/// w_FL + w_FR - w_RL - w_RR [rad/s]: zero to rounding as long as no wheel slips along its roller's axle.
[[nodiscard]] double slip_residual(const PerWheel& speeds);

/// Where the hub of a wheel is, in robot coordinates, and along which unit vector its roller on the floor pushes.
struct WheelPlace {
  std::array<double, 2> p;  ///< [m]
  std::array<double, 2> a;  ///< unit vector along the axle of the roller on the floor, pointing forward
};
[[nodiscard]] WheelPlace wheel_place(const MecanumGeometry& geometry, std::size_t wheel);

}  // namespace verisim::robot

// What the mobile robot is made of: each figure with its unit and source. "Estimate" says that no source gives it.
#pragma once

#include <array>

#include "engine/robot/mecanum.hpp"
#include "engine/robot/motor.hpp"

namespace verisim::robot {

/// The base with its stand and the haptic device on it, as one rigid body that stays level. Robot coordinates.
/// The Nexus kit, a stand of aluminium and a Virtuose 6D35-45 with its base; all estimates.
struct BodyParameters {
  double mass = 28;                               ///< of everything [kg]: kit and battery 9, stand 6, device 13
  double inertia = 0.7;                           ///< about the vertical through the centre of mass [kg m^2]
  std::array<double, 2> centre_of_mass = {0, 0};  ///< x, y from the middle of the wheels [m]
  double height = 0.35;                           ///< of the centre of mass above the floor [m]
};

/// A mecanum wheel on the floor. 9 rubber rollers on 100 mm (dissertation section 5.3.1); the rest are estimates.
struct WheelParameters {
  double inertia = 4.5e-4;           ///< of wheel and gear's output about the axle [kg m^2]: 0.36 kg as a disc
  double friction = 0.3;             ///< of a roller on the floor along its axle. With this base, arm and motors a
                                     ///< torque of 17.5 N m turns the base: 35 N at 0.45 m, and 3.1 N m, do it, as
                                     ///< section 5.5 saw after a powerful collision with the arm extended
  double roller_resistance = 0.03;   ///< of a roller that turns on its axle: force across it per normal load
  double rolling_resistance = 0.01;  ///< of a wheel that rolls: torque per normal load and wheel radius
  double stiffness = 5e5;            ///< of a roller's rubber along the floor [N/m]
  double damping = 1900;             ///< beside it [N s/m]: 0.3 of critical for the base on held wheels
};

/// 12 V (dissertation section 5.3.1); the resistance is an estimate for a pack of nickel cells with its wiring.
struct SupplyParameters {
  double voltage = 12;       ///< without load [V]
  double resistance = 0.15;  ///< [ohm]
};

struct PlantParameters {
  MecanumGeometry geometry;
  MotorParameters motor;
  BridgeParameters bridge;
  GearParameters gear;
  WheelParameters wheel;
  BodyParameters body;
  SupplyParameters supply;
  double gravity = 9.81;  ///< [m/s^2]; 0: the wheels carry nothing and grip nothing, as on a stand
  int substeps = 8;       ///< per millisecond: 125 us
};

/// Error(usage) that names a figure out of range. On return the plant's contracts hold.
void check(const PlantParameters& parameters);

}  // namespace verisim::robot

// The robot's mechanics: a level rigid base on four mecanum wheels, each turned by a motor through a gear with
// backlash. One `step` of a few ten microseconds. Sources: rigid bodies and Coulomb's law; the parameters' are in
// plant_parameters.hpp. Robot coordinates R; the base's velocity u = (vx, vy, omega) is that of its centre of mass.
//
// Wheel i touches the floor with one roller. a: unit vector along the roller's axle, t: across it. The roller's rubber
// slides along a against friction mu N, and turns on its axle, along t, against c N. A wheel rolls against a torque
// c_w N r. All three are the same law: a spring and a damper that yield at a bound. Nothing creeps at rest, and who
// carries how much of a load is decided by the springs.
//
//   slip  s = J u - r a_x w_wheel       J = (a_x, a_y, (p - c) x a)        force on the base  f = -(k z + d s), |f| <=
//   bound rolling: at the wheel alone, torque -r (k z + d r w_wheel), z a length of the rim
//
// Gear: a rigid gap. Within it motor and wheel turn apart; at a flank they turn together, and meet without rebound.
// Its losses are a factor e between torques, that of driving or of being driven. The motor's dry friction holds it at
// rest.
//
// Velocities are implicit (backward Euler, first order): all forces belong to the velocities at the step's end. Which
// flank, who rests, who slides is found by trial: with a guess, all is linear; the wheels are eliminated, three
// unknowns are left; what contradicts its guess corrects it. The guess is the last step's, and nearly always right;
// then a step costs about 150 ns. A step whose guesses do not settle goes on with its last and is counted.
#pragma once

#include <array>
#include <cstdint>

#include "engine/base/pose.hpp"
#include "engine/robot/plant_parameters.hpp"

namespace verisim::robot {

/// What turns the motor of a wheel in a step.
struct MotorDrive {
  WindingTorque torque;
  bool blocked = false;  ///< the rotor cannot turn
};

/// State of one wheel, its gear and its motor.
struct WheelState {
  double motor_speed = 0;      ///< [rad/s]
  double wheel_speed = 0;      ///< [rad/s]
  double gap = 0;              ///< motor angle / ratio - wheel angle [rad], within half the backlash, to rounding
  double stretch_along = 0;    ///< z along a [m]
  double stretch_across = 0;   ///< z along t [m]
  double stretch_rolling = 0;  ///< z of rolling [m]
};

/// Velocities and forces that a step found, at one wheel.
struct WheelForces {
  double slip = 0;            ///< s along a [m/s]
  double roll = 0;            ///< s along t: how fast the roller's rim runs [m/s]
  double along = 0;           ///< force on the base, along a [N]
  double across = 0;          ///< and along t [N]
  double rolling = 0;         ///< resistance to rolling: torque on the wheel / r [N]
  double gear_torque = 0;     ///< on the wheel [N m]
  double gear_load = 0;       ///< of the gear on the motor [N m]
  double motor_friction = 0;  ///< on the motor, also what blocks it [N m]
};

/// Where mechanical energy went, since the beginning [J]. With kinetic and stored energy the sum closes to rounding.
struct MechanicalBook {
  double motors = 0;    ///< from the windings
  double outside = 0;   ///< from the wrench
  double friction = 0;  ///< heat of the motors' dry friction
  double gears = 0;     ///< heat of the gears, and of flanks that meet
  double floor = 0;     ///< heat of wheels that roll, and of rollers that slide, turn and are damped
};

class RollingBase {
 public:
  /// @pre check(parameters) passed; step > 0 [s]
  RollingBase(const PlantParameters& parameters, double step);

  /// One step. load: normal force of each wheel [N], not negative. wrench: from outside on the base, about its centre
  /// of mass: forces along x and y [N], torque about the vertical [N m].
  void step(const std::array<MotorDrive, kWheels>& drive, const PerWheel& load, const Vector3d& wrench);

  [[nodiscard]] const std::array<WheelState, kWheels>& wheels() const { return wheel_; }
  [[nodiscard]] const std::array<WheelForces, kWheels>& forces() const { return forces_; }
  [[nodiscard]] const Vector3d& velocity() const { return u_; }  ///< of the centre of mass
  [[nodiscard]] const Vector3d& floor_force() const {
    return floor_force_;
  }  ///< of all wheels in the last step, about it
  [[nodiscard]] std::uint64_t unsettled() const { return unsettled_; }

  [[nodiscard]] const MechanicalBook& book() const { return book_; }
  [[nodiscard]] double kinetic_energy() const;  ///< of base, wheels and rotors [J]
  [[nodiscard]] double stored_energy() const;   ///< in the rollers' rubber [J]

  /// Turns the base's coordinates by the step's rotation: velocities stay what they were on the floor.
  /// cosine and sine: of the angle by which the base turned.
  void turn_coordinates(double cosine, double sine);

 private:
  /// What is guessed of a wheel: -1, 0, 1 each.
  struct Guess {
    int motor = 0;  ///< direction in which it turns; 0: friction holds it
    int flank = 0;  ///< sign of the torque on the wheel; 0: within the gap
    int along = 0;  ///< sign of the force that slides; 0: it holds
    int across = 0;
    int rolling = 0;
    int conducts = 0;  ///< 1: torque falls with speed
    bool operator==(const Guess&) const = default;
  };
  /// Of one wheel under a guess: (P) w_wheel = Q + q . u. What depends on the guess alone is kept.
  struct Elimination {
    double inverse = 0;       ///< 1 / P; 0: the wheel is held by its motor
    double motor_weight = 0;  ///< ratio * e: torque of the motor as it arrives; 0: no flank
    double motor_term = 0;    ///< inertia / step + half of per_speed, motor side
    double per_motor_weight = 0, per_motor_term = 0;
    Vector3d q = Vector3d::Zero();
    double holds_along = 0, holds_across = 0, holds_rolling = 0;  ///< k h + d, or 0 where it slides
  };
  struct Place {
    Vector3d along, across;            ///< J
    double lever_along, lever_across;  ///< r a_x, r t_x [m]
  };

  void factorize(const std::array<MotorDrive, kWheels>& drive);
  void eliminate(std::size_t i, const MotorDrive& drive);
  void solve(const std::array<MotorDrive, kWheels>& drive, const PerWheel& load, const Vector3d& wrench);
  void follow(std::size_t i, const MotorDrive& drive);
  bool correct(std::size_t i, const MotorDrive& drive, double load);
  [[nodiscard]] int corrected_flank(std::size_t i) const;
  [[nodiscard]] int corrected_motor(std::size_t i, const MotorDrive& drive) const;
  void finish(std::size_t i);
  void enter(std::size_t i, const WindingTorque& torque);
  [[nodiscard]] double efficiency_factor(const Guess& guess) const;

  WheelParameters parameters_;
  GearParameters gear_;
  double motor_inertia_, motor_dry_friction_, wheel_radius_, h_;
  // Divided once: divisions would be a third of a step's time.
  double per_h_, motor_inertia_per_h_, wheel_inertia_per_h_, per_ratio_, half_backlash_;
  double hold_;  ///< force of a roller that holds, per velocity: k h + d
  double per_stiffness_;
  Vector3d mass_, mass_per_h_;  ///< m, m, I
  std::array<Place, kWheels> place_;
  std::array<WheelState, kWheels> before_, wheel_;  ///< as the step began; now
  std::array<WheelForces, kWheels> forces_;
  std::array<Guess, kWheels> guess_, factorized_;
  std::array<Elimination, kWheels> eliminated_;
  Vector3d u_ = Vector3d::Zero(), floor_force_ = Vector3d::Zero();
  Vector3d u_new_ = Vector3d::Zero();  ///< of this trial
  Matrix3d inverse_;
  bool is_factorized_ = false;
  std::uint64_t unsettled_ = 0;
  MechanicalBook book_;
};

}  // namespace verisim::robot

// The mobile robot as physics: from four duties and the haptic device's reaction to motion and encoder edges, a
// millisecond at a time (dissertation sections 5.3.1 and 5.5). Windings (motor.hpp), mechanics (rolling_base.hpp) and
// encoders (encoder.hpp) are put together here, with what couples them: the supply that sags, and the wheels' loads.
//
// Floor coordinates F and robot coordinates R as in mecanum.hpp, z up from the floor. SI units.
//
// Loads: the base is stiff and stands on four equal springs, so the vertical force and the moments about x and y are
// shared as N_i = W/4 + x_i S_x / (4 l^2) + y_i S_y / (4 w^2). The moments are those of the reaction and of the floor's
// forces below the centre of mass, a substep late. A wheel that would be pulled at is lifted: it carries nothing and
// the others carry its part in proportion. That the base then tips is not simulated; it is counted.
//
// First order in the substep: halving it moves a start, a stop or a curve by less than an encoder count (0.1 mm).
// About 2 us a millisecond; no allocation; the same bits for the same calls.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/base/pose.hpp"
#include "engine/robot/encoder.hpp"
#include "engine/robot/rolling_base.hpp"

namespace verisim::robot {

/// What the haptic device does to the base that it is bolted to: the opposite of what it does to the hand. Robot
/// coordinates R, as they are when the millisecond begins.
struct Reaction {
  Vector3d force = Vector3d::Zero();   ///< [N]
  Vector3d torque = Vector3d::Zero();  ///< [N m]
  Vector3d point = Vector3d::Zero();   ///< where the force acts, z above the floor [m]
};

/// What can be seen of the robot at the end of a millisecond. Wheels in the order FL, FR, RL, RR.
struct PlantState {
  PlanarPose pose;                             ///< of the middle of the wheels, F
  PlanarTwist twist;                           ///< of the middle of the wheels, R
  PerWheel wheel_speed{};                      ///< [rad/s]
  PerWheel motor_speed{};                      ///< [rad/s]
  PerWheel current{};                          ///< [A]
  PerWheel slip{};                             ///< of the floor's roller along its axle [m/s]
  PerWheel load{};                             ///< normal force [N]
  double supply_voltage = 0;                   ///< at the bridges [V]
  std::array<std::int64_t, kWheels> counts{};  ///< of the encoders, as a decoder that misses nothing has them
};

/// Where the supply's energy went, since the beginning [J]: source = battery + bridges + windings + mechanics' motors +
/// what the coils hold.
struct ElectricalBook {
  double source = 0;    ///< given by the supply, before its own resistance
  double battery = 0;   ///< heat of the supply's resistance
  double bridges = 0;   ///< heat of the L298
  double windings = 0;  ///< heat of the motors' copper
};

class Plant {
 public:
  /// Error(usage) for parameters out of range. At rest at the origin of F, with the gears in the middle of their gaps.
  explicit Plant(const PlantParameters& parameters);

  /// One millisecond. Returns the encoders' edges in it, valid until the next call.
  /// @pre each |duty| <= kDutyMax; reaction finite
  std::span<const Edge> advance(const std::array<std::int16_t, kWheels>& duty, const Reaction& reaction);

  [[nodiscard]] const PlantState& state() const { return state_; }

  /// Sets the base down elsewhere, as it is otherwise.
  void place(const PlanarPose& pose);

  /// Faults, from the next millisecond on. Without supply the duties count as 0: nothing drives, and a motor that is
  /// turned fast enough is braked through its bridge.
  void set_supplied(bool on) { is_supplied_ = on; }
  /// @pre voltage >= 0 [V]
  void set_supply_voltage(double voltage);
  void set_blocked(std::size_t wheel, bool blocked);
  void set_encoder_fault(std::size_t wheel, EncoderFault fault);

  /// What was not simulated as it should, in substeps since the beginning; edges that did not fit.
  [[nodiscard]] std::uint64_t tipping() const { return tipping_; }
  [[nodiscard]] std::uint64_t unsettled() const { return base_.unsettled(); }
  [[nodiscard]] std::uint64_t edges_dropped() const { return edges_.dropped(); }

  [[nodiscard]] const ElectricalBook& electrical_book() const { return book_; }
  [[nodiscard]] const RollingBase& mechanics() const { return base_; }
  [[nodiscard]] double coil_energy() const;  ///< [J]

 private:
  [[nodiscard]] PerWheel loads(const Reaction& reaction);
  void substep(const PerWheel& duty, const Reaction& reaction, std::uint32_t cycle);
  void move(const Vector3d& before, double& cosine, double& sine);
  void publish();

  PlantParameters parameters_;
  double h_;
  std::array<std::array<double, 2>, kWheels> per_moment_;  ///< load of a wheel per S_x and S_y [1/m]
  RollingBase base_;
  std::array<Winding, kWheels> winding_;
  std::array<Encoder, kWheels> encoder_;
  std::array<bool, kWheels> blocked_{};
  bool is_supplied_ = true;
  double supply_current_ = 0;         ///< of the last substep [A]
  double x_ = 0, y_ = 0, theta_ = 0;  ///< of the centre of mass, F
  Edges edges_;
  PlantState state_;
  ElectricalBook book_;
  std::uint64_t tipping_ = 0;
};

}  // namespace verisim::robot

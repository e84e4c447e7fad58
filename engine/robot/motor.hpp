// A motor of the robot, the bridge that feeds it and the gear behind it: their figures, and how the current of the
// winding moves in a step. SI units; motor side unless said. Positive voltage, current, torque and speed drive the
// robot forward.
//
// Bridge: 8 bit of signed duty, as an average: the winding sees d V_s - sign(i) (V_0 + R_0 |i|), d = duty / 255. While
// the pulse is off the current runs on through a transistor and a diode, with about the drop of two transistors. The
// period of the pulses is not resolved; the average holds where it is far shorter than the motor's 6 ms, and counts a
// little too little torque where the current dies within a pulse. Below V_0 at the winding no current flows: duties of
// 29 and less do nothing at 12 V.
#pragma once

#include <cstdint>

namespace verisim::robot {

/// Faulhaber 2342 012CR (ORACLES section 2).
struct MotorParameters {
  double torque_constant = 13.4e-3;                        ///< k_M [N m/A], and back-EMF [V s/rad]
  double resistance = 1.9;                                 ///< R [ohm]
  double inductance = 65e-6;                               ///< L [H]
  double inertia = 5.7e-7;                                 ///< of the rotor [kg m^2]
  double nominal_voltage = 12;                             ///< at which the next is stated [V]
  double no_load_speed = 8100.0 / 60 * 6.283185307179586;  ///< [rad/s]
};

/// Dry friction of the motor [N m]: what the current without load at the nominal voltage turns against,
/// k_M (U - k_M w_0) / R = 4.47 mN m (0.334 A). Friction without a part that grows with speed leaves the data sheet's
/// slope, R / k_M^2 = 101 rpm/mN m, as it is.
[[nodiscard]] double dry_friction(const MotorParameters& motor);

/// L298. STMicroelectronics' data sheet, typical saturation of source and sink together: 1.35 V + 1.2 V at 1 A,
/// 2 V + 1.7 V at 2 A. The line through both; at 0.5 A it is the 2 V of ORACLES section 2. Its limit of 2 A is not kept
/// here: a stalled motor draws 3.5 A.
struct BridgeParameters {
  double drop = 1.4;              ///< V_0 [V]
  double drop_per_ampere = 1.15;  ///< R_0 [ohm]
};

/// The largest duty; duties are -kDutyMax to kDutyMax.
inline constexpr std::int16_t kDutyMax = 255;

/// 64:1 planetary gear (dissertation section 5.3.1). The others are estimates of a three-stage planetary gear of this
/// size: Faulhaber's own gearheads 23/1 and 26/1 of that ratio state 70 %.
struct GearParameters {
  double ratio = 64;               ///< turns of the motor per turn of the wheel
  double backlash = 0.0175;        ///< angle of the wheel between both flanks [rad]: 1 degree
  double efficiency = 0.7;         ///< torque that arrives at the wheel / ratio * torque of the motor
  double efficiency_driven = 0.6;  ///< torque that arrives at the motor * ratio / torque of the wheel that turns it
};

/// Torque of a winding in a step, as a function of the motor's mean speed in it.
struct WindingTorque {
  double at_rest = 0;    ///< [N m]
  double per_speed = 0;  ///< torque lost per speed [N m s/rad]; 0: no current flows
};

/// What a winding did in a step, for the books: means over the step.
struct WindingStep {
  double current = 0;         ///< [A]
  double current_square = 0;  ///< [A^2]
};

/// Current of one winding and its bridge, over steps of one length. Exact for a voltage and speed that stay through the
/// step, however the step compares with L / R. A current that changes its sign within a step starts that step at zero.
class Winding {
 public:
  /// @pre step > 0 [s], R > 0, L > 0, drops not negative
  Winding(const MotorParameters& motor, const BridgeParameters& bridge, double step);

  /// Decides whether and in which direction current flows in the step that begins, and gives its torque.
  /// voltage: d V_s [V]; speed: of the motor, as the step begins [rad/s].
  [[nodiscard]] WindingTorque begin(double voltage, double speed);

  /// Ends the step. speed: the motor's mean in it [rad/s].
  WindingStep end(double speed);

  [[nodiscard]] double current() const { return current_; }  ///< [A]

  /// 1/2 L i^2 that a current which reversed left in the bridge in the last step [J].
  [[nodiscard]] double lost_at_reversal() const { return lost_at_reversal_; }

 private:
  double k_, inductance_, drop_, resistance_;  ///< resistance of winding and bridge
  double decay_, mean_decay_, mean_square_decay_;
  double current_ = 0;
  double drive_ = 0;  ///< what drives current through the resistances at rest in this step [V]
  double direction_ = 0;
  double lost_at_reversal_ = 0;
};

}  // namespace verisim::robot

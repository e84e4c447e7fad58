// Models of haptic hardware: position resolution, force limits. Numbers: ORACLES section 4, data sheets.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "engine/device/device.hpp"

namespace verisim {

struct HardwareDescription {
  std::string name;
  double resolution = 0;                                        ///< m; 0: not quantised
  double force_max = std::numeric_limits<double>::infinity();   ///< N, peak; a longer force is shortened to it
  double torque_max = std::numeric_limits<double>::infinity();  ///< N m; 0: renders no torque
  bool forces = true;                                           ///< forces= of the scenario: false renders nothing
  Pose home;                                                    ///< pose while nothing drives it
};

/// Phantom Omni: 3.3 N peak, 0.055 mm, no torque. Virtuose 6D35-45: 35 N, 3.1 N m.
[[nodiscard]] HardwareDescription phantom_omni(const std::string& name);
[[nodiscard]] HardwareDescription virtuose_6d(const std::string& name);

/// Hardware moved by `source`; null: nothing drives it. Error(input) for a resolution or a limit that is negative or
/// not a number, or a home pose that is not finite with a unit rotation.
[[nodiscard]] std::shared_ptr<Device> make_hardware(HardwareDescription description, std::shared_ptr<Device> source);

/// Scales positions (and so velocities) of `inner` by `scale` about the origin and forces down by it (section 4.3.1);
/// rotations and torques stay. Error(input) unless `scale` is finite and above 0. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_scale(std::shared_ptr<Device> inner, double scale);
/// Moves handle positions by `translation`. Error(input) unless it is finite. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_translate(std::shared_ptr<Device> inner, const Vector3d& translation);

}  // namespace verisim

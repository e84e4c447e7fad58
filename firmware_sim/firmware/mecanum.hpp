// firmware_sim/firmware/mecanum.hpp
// What four mecanum wheels must do for a velocity of the robot (ORACLES section 2): with r = 50 mm, l + w = 300 mm and
// a gear of 64, v_wheel = vx -+ vy -+ (l + w) omega and RPM = v_wheel / r * 64 * 60 / (2 pi). C++14 without standard
// library. Robot coordinates: x forward, y left, omega counter-clockwise seen from above. mm/s, mrad/s; RPM/16 of the
// motors.
#pragma once

#include <stdint.h>

#include "firmware_sim/firmware/robot.hpp"

namespace verisim {
namespace firmware {

struct Setpoints {
  int32_t wheels[kWheels];
};

/// Beyond 7000 RPM of any wheel all four are scaled together, so that the robot goes where it was sent, slower.
/// Within it an error is at most one unit, 1/16 RPM. @pre each velocity within +-kVelocityMax
constexpr int32_t kVelocityMax = 8388607;
Setpoints setpoints_for(int32_t vx, int32_t vy, int32_t omega);

/// The published gain of the float messages, 5000 mm/s per m (mrad/s per rad), exactly and rounded half away from zero.
/// Beyond +-kVelocityMax (1678 m of error) it stays there; NaN gives false and leaves `velocity` alone.
bool velocity_for_error(const float& error, int32_t& velocity);

}  // namespace firmware
}  // namespace verisim

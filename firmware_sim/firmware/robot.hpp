// firmware_sim/firmware/robot.hpp
// Numbers of the robot and of its firmware, each in one place. Sources: dissertation section 5.3.1 (Nexus 4WD Mecanum
// kit 10011), the Faulhaber 2342L012CR's data sheet; what is measured says so. C++14 without standard library
// (avr-g++ 5.4). Wheels: 0 front left, 1 front right, 2 rear left, 3 rear right.
#pragma once

#include <stdint.h>

namespace verisim {
namespace firmware {

constexpr uint8_t kWheels = 4;

// Time: one tick of timer 2, which counts 250 to a millisecond.
constexpr uint8_t kTicksPerMs = 250;

// Velocities and setpoints inside the firmware: RPM of a motor in sixteenths.
constexpr int32_t kPerRpm = 16;
constexpr int32_t kRpmMax = 7000;           ///< recommended for the motor; 0.57 m/s of the robot
constexpr int32_t kCountsPerTurn = 12 * 4;  ///< of the motor: 12 lines, four edges each
constexpr int32_t kTicksPerMinute = 60000L * kTicksPerMs;

// Control.
// A sample of the wheels' controllers every 5 ms. Measured on the bench of the tests, motor under the robot: a load of
// 2 V costs 11 % of the speed and is made good to 5 % after 95 ms; every 10 ms, with the gain that this still bears, 15
// % and 158 ms.
constexpr uint8_t kSampleMs = 5;
constexpr uint8_t kReportMs = 20;      ///< setpoints, velocities and PWM, one after the other, 50 times a second
constexpr uint16_t kWatchdogMs = 250;  ///< silence after which the robot stops
constexpr uint8_t kStopSteps = 40;     ///< samples in which the watchdog brings the setpoints to 0, evenly: 0.2 s
constexpr int16_t kPwmMax = 255;

// Faults: what the wheel does contradicts its drive for so long that the encoder or the motor cannot be right.
constexpr int16_t kHardPwm = 96;        ///< 4.5 V of 12 V less the bridge's drop turns a free wheel or pushes 15 N
constexpr uint16_t kStalledMs = 500;    ///< driven hard and no count: dead encoder, cut cable or stalled motor
constexpr uint16_t kReversedMs = 200;   ///< driven hard and turning the other way: braking from 7000 RPM takes 60 ms
constexpr int32_t kReversedRpm = 300;   ///< turning, not trembling
constexpr int32_t kStandstillRpm = 30;  ///< with setpoint 0 the drive lets go below this

}  // namespace firmware
}  // namespace verisim

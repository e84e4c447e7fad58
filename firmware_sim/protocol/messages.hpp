// firmware_sim/protocol/messages.hpp
// The messages between computer and robot, as a table that exists at compile time only: fields in the order of the
// wire, and collections whose order gives the ids. Source: the published NexusRobotProtocol (revision ce571af,
// 2012-10-30). Shared by firmware and host: C++14 without standard library (avr-g++ 5.4), and C++20. No allocation, no
// state.
//
// The protocol states no units. These are ours, in robot coordinates (x forward, y left, rotation counter-clockwise
// seen from above). Errors: m and rad. Velocities: mm/s and mrad/s. Wheels: front left, front right, rear left, rear
// right; setpoint and velocity in RPM of the motor, PWM from -255 to 255, each positive when it drives the robot
// forward.
#pragma once

#include <stdint.h>

namespace verisim {
namespace protocol {

/// What the robot has still to go; the firmware's gain makes a velocity of it.
struct XYFloatError {
  float x, y;
  static constexpr const char* name() { return "XYFloatError"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& self, Visitor& field) {
    field(self.x);
    field(self.y);
  }
};

struct XYRotationFloatError {
  float x, y, rotation;
  static constexpr const char* name() { return "XYRotationFloatError"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& self, Visitor& field) {
    field(self.x);
    field(self.y);
    field(self.rotation);
  }
};

struct XYIntVelocities {
  int16_t x, y;
  static constexpr const char* name() { return "XYIntVelocities"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& self, Visitor& field) {
    field(self.x);
    field(self.y);
  }
};

struct XYRotationIntVelocities {
  int16_t x, y, rotation;
  static constexpr const char* name() { return "XYRotationIntVelocities"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& self, Visitor& field) {
    field(self.x);
    field(self.y);
    field(self.rotation);
  }
};

/// Switches the robot's controller on.
struct StartControl {
  static constexpr const char* name() { return "StartControl"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& /*self*/, Visitor& /*field*/) {}
};

/// Switches the robot's controller off: the motors get nothing.
struct EndControl {
  static constexpr const char* name() { return "EndControl"; }
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& /*self*/, Visitor& /*field*/) {}
};

/// What the three reports and the setpoints between two boards have in common: a number per wheel.
struct FourWheels {
  int16_t wheels[4];
  template <typename Self, typename Visitor>
  static constexpr void visit(Self& self, Visitor& field) {
    for (int wheel = 0; wheel < 4; ++wheel) field(self.wheels[wheel]);
  }
};

struct CurrentWheelSetpoints : FourWheels {
  static constexpr const char* name() { return "CurrentWheelSetpoints"; }
};

struct CurrentWheelVelocities : FourWheels {
  static constexpr const char* name() { return "CurrentWheelVelocities"; }
};

struct CurrentPWMOutput : FourWheels {
  static constexpr const char* name() { return "CurrentPWMOutput"; }
};

enum class Envelope : uint8_t { basic, basic_checksum };

/// Messages that travel one way over one line. The id of a message is its position here, from 0.
template <Envelope kind, typename... Messages>
struct Collection {
  static constexpr Envelope envelope = kind;
  static constexpr uint8_t count = sizeof...(Messages);
  static_assert(sizeof...(Messages) <= 255, "at most 255 messages a collection");
};

struct ComputerToRobot : Collection<Envelope::basic_checksum, XYFloatError, XYRotationFloatError, XYIntVelocities,
                                    XYRotationIntVelocities, StartControl, EndControl> {
  static constexpr const char* name() { return "ComputerToRobot"; }
};

struct RobotToComputer
    : Collection<Envelope::basic_checksum, CurrentWheelSetpoints, CurrentWheelVelocities, CurrentPWMOutput> {
  static constexpr const char* name() { return "RobotToComputer"; }
};

struct BlueToGreen : Collection<Envelope::basic, XYRotationIntVelocities, CurrentWheelSetpoints> {
  static constexpr const char* name() { return "BlueToGreen"; }
};

struct GreenToBlue : Collection<Envelope::basic, CurrentWheelSetpoints, CurrentWheelVelocities> {
  static constexpr const char* name() { return "GreenToBlue"; }
};

}  // namespace protocol
}  // namespace verisim

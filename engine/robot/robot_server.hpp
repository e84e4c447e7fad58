// The robot server: what stands between the simulation and the robot's serial line (dissertation section 5.3.2, "Robot
// Server Software"). An error vector comes in, a proportional gain makes a velocity of it, the velocity goes out as
// whole mm/s and mrad/s; setpoints, wheel velocities and PWM come back. Robot coordinates R: x forward, y left. SI.
//
// What differs from the published server, and why:
// - It saturates. int16(error * gain + 0.5) wraps: at gain 5000 an error of 7 m gives -30536 and reverses the robot.
// - It rounds half away from zero. The published conversion truncates towards it after + 0.5: -0.9 becomes 0.
// - It refuses what is not a finite number and goes on with the last good velocity, for as long as the watchdog lets
// it.
// - It repeats the velocity at a fixed rate, so that the firmware's watchdog hears silence only if server or line are
// dead.
// - It sends StartControl again if the robot's setpoints stay 0 against the command, as after a reset. It does so a few
//   times only, because a robot that has found a fault of its own (a stuck wheel) answers in the same way.
// It can end at any time. kill() loses what a process loses: the velocity in force, a gain that was changed, half a
// message, what the robot reported. start() begins anew with the gain of the settings, and telemetry fills up again.
//
// advance() once a millisecond. No allocation, no wall clock.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/robot/mecanum.hpp"
#include "engine/robot/notes.hpp"
#include "engine/robot/serial_line.hpp"
#include "firmware_sim/protocol/frame.hpp"

namespace verisim::robot {

/// A velocity [m/s, rad/s] in wire units [mm/s, mrad/s]: rounded half away from zero, saturated at int16.
/// @pre velocity is not NaN
[[nodiscard]] std::int16_t to_wire(double velocity);

struct RobotServerSettings {
  double gain = 5;               ///< 1/s: velocity per error. The published default: 5000 wire units per m. 0 or above
  double send_period = 0.020;    ///< s: a velocity goes out this often. 0.001 to 1
  double watchdog = 0.250;       ///< s: how long a velocity stays in force without good input, as in the firmware
  double start_period = 0.5;     ///< s: setpoints that are 0 for so long against the command ask for StartControl
  int start_attempts = 3;        ///< so often in a row; a robot that then moves for 2 s has begun a new row
  double silence = 0.5;          ///< s: without a report from the robot, it is silent
  double wheel_speed = 11.4537;  ///< rad/s: no wheel is asked for more. 7000 RPM / 64
  MecanumGeometry geometry = {};
};

/// What the robot reported last, and how long ago [s]; infinite: never.
struct Telemetry {
  std::array<std::int16_t, kWheels> setpoint{}, velocity{}, pwm{};  ///< RPM, RPM, -255 to 255
  double age;                                                       ///< of the newest of the three
};

struct RobotServerCounts {
  std::uint64_t refused = 0;    ///< errors, velocities or gains that are no finite numbers (a gain: nor negative)
  std::uint64_t saturated = 0;  ///< velocities that were reduced to what wheels or wire can do
  std::uint64_t expired = 0;    ///< times that a velocity ended because no good one followed
  std::uint64_t frames = 0;     ///< sent
  std::uint64_t reports = 0;    ///< accepted from the robot
  std::uint64_t starts = 0;     ///< StartControl sent
  std::uint64_t rejected = 0;   ///< beginnings of frames from the robot that were none
};

class RobotServer {
 public:
  /// Error(input) for settings out of the ranges above. It does not run before start().
  explicit RobotServer(const RobotServerSettings& settings);

  /// Begins, or begins anew after stop() and kill().
  void start();
  /// Ends in order: EndControl goes out with the next advance().
  void stop();
  /// Ends without a word.
  void kill();
  [[nodiscard]] bool is_running() const { return is_running_; }

  void set_gain(double gain);
  [[nodiscard]] double gain() const { return gain_; }

  /// The velocity that an error [m] asks for: gain x error, within what the wheels can do. If the error is refused, the
  /// last one that was not, until the watchdog's time is over; zero from then on, and while the server does not run.
  [[nodiscard]] PlanarTwist wanted(double error_x, double error_y);
  /// Direction and proportions kept, no wheel above its speed. @pre finite
  [[nodiscard]] PlanarTwist within_reach(const PlanarTwist& velocity) const;
  /// From now on this is in force. Refused if it is not finite. Nothing happens while the server does not run.
  void command(const PlanarTwist& velocity);
  /// Takes one millisecond. The bytes that go onto the line in it; valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> advance();
  /// Bytes that came from the robot. Nothing happens while the server does not run.
  void receive(std::span<const TimedByte> bytes);

  [[nodiscard]] const PlanarTwist& in_force() const { return in_force_; }  ///< after limits, before rounding
  [[nodiscard]] Telemetry telemetry() const;
  /// The velocity that the robot says it has in force: its setpoints, as motion without slip. Nothing: it has not said
  /// so for 0.1 s.
  [[nodiscard]] std::optional<PlanarTwist> reported_command() const;
  [[nodiscard]] const RobotServerCounts& counts() const { return counts_; }
  void report(RobotNotes& notes);

 private:
  using Velocity = protocol::XYRotationIntVelocities;
  template <typename Message>
  void put(const Message& message);
  [[nodiscard]] bool is_expired(std::uint64_t since) const { return now_ - since >= watchdog_ms_; }
  [[nodiscard]] bool must_start_again();
  void forget();

  RobotServerSettings settings_;
  std::uint64_t send_ms_, watchdog_ms_, start_ms_, silence_ms_;
  std::uint64_t now_ = 0;  ///< ms
  bool is_running_ = false, ends_ = false, reaches_limit_ = false;
  double gain_;
  PlanarTwist good_, in_force_;                                   ///< of the last good error; after limits
  std::uint64_t good_at_ = 0, in_force_at_ = 0, started_at_ = 0;  ///< ms
  std::uint64_t refused_seen_ = 0;
  protocol::Receiver<protocol::RobotToComputer> receiver_;
  Telemetry telemetry_{};
  std::uint64_t heard_at_ = 0;
  bool has_heard_ = false;
  std::uint64_t ignored_ms_ = 0, obeyed_ms_ = 0;  ///< how long the robot has not, has taken up what it is told
  int attempts_ = 0;
  std::array<std::uint8_t, 64> out_{};
  std::size_t out_count_ = 0;
  RobotServerCounts counts_;
  Spell running_{"robot server", "is there", "is gone"};
  Spell refusing_{"robot server", "refuses commands that are no numbers", "gets numbers again", 100};
  Spell expired_{"robot server", "has had no good command for the watchdog's time and stops the robot",
                 "has good commands again"};
  Spell saturated_{"robot server", "asks for all that the wheels can do", "asks for less than the wheels can do", 100};
  Spell ignored_{"robot server", "is not obeyed: the robot was reset, or has found a fault", "is obeyed again"};
  Spell silent_{"robot server", "hears nothing from the robot", "hears the robot again"};
};

}  // namespace verisim::robot

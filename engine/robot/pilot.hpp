// The host's side of the robot as one thing: error -> gain -> drive law -> walls -> command -> bytes, once a
// millisecond. The order is part of the result. Coordinates D, R, F as in drive_law.hpp. No allocation, no wall clock.
//
//   handle -> DriveLaw::error_R -> RobotServer::wanted -> DriveLaw::advance -> ramp -> Walls::limit -> RobotServer
//                                  gain, NaN              heading, lost, stop  slip    tracked pose    rate, rounding
//
// The server can be killed and started at any time. With it ends what the drive law held against the tracker, and what
// the walls know of the base's motion: after start() they take the worst for granted until the tracker has seen it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/robot/drive_law.hpp"
#include "engine/robot/robot_server.hpp"
#include "engine/robot/walls.hpp"

namespace verisim::robot {

struct PilotSettings {
  RobotServerSettings server;
  DriveLawSettings drive;
  std::optional<WallSettings> walls;
  double acceleration = 2;          ///< m/s^2: rollers slip from 2.1 on (mu g / sqrt 2). Walls brake harder
  double angular_acceleration = 8;  ///< rad/s^2
};

class Pilot {
 public:
  /// Error(input) for settings out of range. The server does not run before start().
  explicit Pilot(const PilotSettings& settings);

  void start();
  void stop() { server_.stop(); }
  void kill() { server_.kill(); }
  void set_gain(double gain) { server_.set_gain(gain); }

  /// Takes one millisecond, with the handle at p_D [m], the head at head_F if one is tracked, and what the tracker
  /// says. The bytes for the line; valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> advance(const std::array<double, 2>& p_D,
                                                      const std::optional<std::array<double, 2>>& head_F,
                                                      const TrackedBase& tracked);
  /// Bytes that came from the robot.
  void receive(std::span<const TimedByte> bytes) { server_.receive(bytes); }

  [[nodiscard]] const std::array<double, 2>& error_R() const { return error_R_; }  ///< m, of the last millisecond
  /// What the hand feels of the walls [N, R]: Walls::limit_force; nothing while the server does not run.
  [[nodiscard]] std::array<double, 2> limit_force_R() const;
  [[nodiscard]] const RobotServer& server() const { return server_; }
  [[nodiscard]] const DriveLaw& drive() const { return drive_; }
  [[nodiscard]] const std::optional<Walls>& walls() const { return walls_; }
  void report(RobotNotes& notes);

 private:
  /// Toward `to`, by what the rollers can hold in a millisecond.
  [[nodiscard]] PlanarTwist ramped(const PlanarTwist& to) const;

  double step_, angular_step_;  ///< m/s and rad/s in a millisecond
  RobotServer server_;
  DriveLaw drive_;
  std::optional<Walls> walls_;
  PlanarTwist ramp_;
  std::array<double, 2> error_R_{};
};

}  // namespace verisim::robot

// Synthesized drives of the base: a path of straight lines, turns and arcs, each from rest to rest, as its wheels'
// encoders would count it if nothing slipped, with the commands and the true pose. For `verisim trace synth encoder`
// and for tests that need a known answer. Closed forms of time: pose and wheel angles of a leg are those of its twist
// times its progress.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/robot/mecanum.hpp"
#include "engine/robot/odometry.hpp"

namespace verisim::robot {

struct DriveSample {
  double t = 0;  ///< [s]
  Counts counts{};
  PlanarTwist command;  ///< R
  PlanarPose pose;      ///< F
};

/// "straight", "strafe", "turn" (on the spot), "square" (four sides forward, a quarter turn after each), "circle"
/// (forward, around to the left).
[[nodiscard]] std::vector<std::string> drive_paths();

/// Names, defaults, units and meanings of the parameters, one line each. For --help.
[[nodiscard]] std::string drive_help();

struct DriveTrace {
  double rate_hz = 0;
  std::string description;  ///< path and parameters, from which it can be made again
  std::vector<DriveSample> samples;
};

/// Error(usage) for an unknown path or parameter (with the nearest name), or one that is not above 0 (`rest`: below 0).
[[nodiscard]] DriveTrace synthesize_drive(const std::string& path, const std::map<std::string, double>& parameters);

}  // namespace verisim::robot

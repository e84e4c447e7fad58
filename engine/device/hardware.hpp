// Models of haptic hardware: what a real device adds to the motion of the hand and takes from the wrench. Each part can
// be switched off by itself; an ideal device has none. Numbers: data sheets of the makers, as ORACLES sections 2 and 4
// give them.
//
//   motion in   stop at the workspace's limits -> steps of the encoders -> sample and hold -> transport delay
//   wrench out  transport delay -> sample and hold -> limits of the motors -> the hand, with what the stop pushes
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "engine/device/device.hpp"

namespace verisim {

struct HardwareDescription {
  std::string name;
  std::string model = "ideal device";                                 ///< as its maker calls it
  double resolution = 0;                                              ///< m; 0: not quantised
  double force_max = std::numeric_limits<double>::infinity();         ///< N, peak; a longer force is shortened to it
  double torque_max = std::numeric_limits<double>::infinity();        ///< N m; 0: renders no torque
  double force_continuous = std::numeric_limits<double>::infinity();  ///< N, that the motors bear for long; told only
  bool forces = true;   ///< forces= of the scenario: false renders nothing
  Workspace workspace;  ///< the handle's position ends there
  bool stops = false;   ///< does it? Else the workspace is told only
  double rate = 0;      ///< Hz, sample and hold; 0: every frame
  double delay = 0;     ///< s, each way; whole frames
  HandleLoad load;      ///< apparent mass and friction of the handle
  Pose home;            ///< pose while nothing drives it
};

/// Phantom Omni: 3.3 N peak, 0.88 N continuous, 0.055 mm, no torque, 160 x 120 x 70 mm.
[[nodiscard]] HardwareDescription phantom_omni(const std::string& name);
/// Geomagic Touch, the Omni's successor: the same numbers.
[[nodiscard]] HardwareDescription geomagic_touch(const std::string& name);
/// Virtuose 6D35-45: 35 N and 3.1 N m peak, 10 N continuous, a cube of 450 mm whose centre is 0.55 m before its base.
[[nodiscard]] HardwareDescription virtuose_6d(const std::string& name);
/// Renders everything and reports what is.
[[nodiscard]] HardwareDescription ideal_device(const std::string& name);

/// Hardware moved by `source`; null: nothing drives it. It records `saturated` and says when saturation and a stop at
/// the workspace's limits begin and end. Error(input) for a resolution, rate, delay, load or limit that is negative or
/// not a number, an empty workspace, or a home pose that is not finite with a unit rotation.
/// About 60 ns a frame; with a delay 8192 frames are kept.
[[nodiscard]] std::shared_ptr<Device> make_hardware(HardwareDescription description, std::shared_ptr<Device> source);

}  // namespace verisim

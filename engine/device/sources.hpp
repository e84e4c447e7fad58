// Where motion comes from: recorded traces and a modelled operator.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/device/device.hpp"

namespace verisim {

/// Samples of a haptic trace. Brought to the simulation's step by stated rules: positions linear, rotations slerp,
/// buttons held; before the first and after the last sample the nearest is held. A frame within a nanosecond of a
/// sample gets that sample exactly.
struct HapticSamples {               //  shape  unit
  std::vector<double> t;             //  (n)    s     strictly growing
  std::vector<Pose> pose;            //  (n)    m
  std::vector<std::uint8_t> button;  //  (n) or empty: held throughout
};

/// Devices.Replay{ trace= }. Error(input) for no samples, times that do not grow, poses that are not finite or not
/// unit. @pre as many poses as times, as many buttons or none
[[nodiscard]] std::shared_ptr<Device> make_replay(std::string name, HapticSamples samples);

/// One leg of an operator's target path.
struct HandWaypoint {
  Pose pose;           ///< target of the hand, device coordinates
  double speed = 0.1;  ///< m/s along the leg that ends here
  double dwell = 0;    ///< s, waits after arriving
};

/// Devices.Hand{ … }: an operator. A point mass and inertia (the hand with the handle) is pulled by an impedance
/// (spring and damper, its own muscles) towards a target that moves along a path with tremor, and feels the rendered
/// wrench. It does not push blindly: `lead` bounds how far the target runs ahead of a hand that is held up, and after
/// `patience` it withdraws to the waypoint before and tries again with newly misjudged `error` (drawn uniformly within
/// +-error per axis; the first try uses `error` itself).
struct HandDescription {
  std::string name = "hand";
  std::vector<HandWaypoint> path;
  bool repeat = false;              ///< after the last waypoint on to the first, until the run ends
  double mass = 0.15;               ///< kg, fingers and handle
  double inertia = 1e-3;            ///< kg m^2
  double stiffness = 400;           ///< N/m
  double damping = 15.5;            ///< N s/m (2 sqrt(k m))
  double angular_stiffness = 2;     ///< N m/rad
  double angular_damping = 0.0894;  ///< N m s/rad (2 sqrt(k I))
  double lead = std::numeric_limits<double>::infinity();  ///< m; the target waits while it is further ahead of the hand
  double patience =
      std::numeric_limits<double>::infinity();  ///< s; after so long a wait back to the waypoint before, and again
  double reaction = 0;                          ///< s, until the hand knows that it is held up, or no longer
  double tremor = 0;                            ///< m rms, 8 to 12 Hz, each axis
  double angular_tremor = 0;                    ///< rad rms
  Vector3d error = Vector3d::Zero();            ///< m, added to every target: misjudged place
  Vector3d angular_error = Vector3d::Zero();    ///< rad, rotation vector
  std::uint64_t seed = 1;
};
/// Error(input) for a path without waypoints and for values that are not finite, negative or, where the model divides
/// by them, zero. Its duration() is that of an operator whom nothing holds up; it never gets further than travel().
[[nodiscard]] std::shared_ptr<Device> make_hand(HandDescription description);

}  // namespace verisim

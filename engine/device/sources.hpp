// Where motion comes from: recorded traces, here, and a modelled operator (hand.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/device/hand.hpp"

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

}  // namespace verisim

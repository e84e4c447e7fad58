// A bump that is felt when a collision starts (dissertation section 4.5), so that a hand that a bubble's spring pulls
// at can tell the collision from the spring: a half wave of force against the motion of the handle.
#pragma once

#include <memory>

#include "engine/device/device.hpp"

namespace verisim {

struct BumpDescription {
  double force = 2;        ///< N, peak
  double duration = 0.02;  ///< s
};

/// Error(input) unless force and duration are finite and above 0. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_bump(std::shared_ptr<Device> inner, const BumpDescription& description);

}  // namespace verisim

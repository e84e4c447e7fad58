// What carries devices through the world: a displacement that bubbles drive and that any number of devices share. Where
// a bubble has none of its own, it has one to itself.
#pragma once

#include <memory>

#include "engine/device/device.hpp"

namespace verisim {

struct Navigator {
  Vector3d displacement = Vector3d::Zero();  ///< m, of all devices that it carries
  bool paused = false;                       ///< a paused one does not move; bubbles still pull the hand back
};

/// Adds the navigator's displacement to the handle. The velocity has what it moved since the last frame.
/// @pre neither is null
[[nodiscard]] std::shared_ptr<Device> make_carried(std::shared_ptr<Device> inner,
                                                   std::shared_ptr<const Navigator> navigator);

}  // namespace verisim

// A device whose base stands on something that moves, as on a mobile robot: a tracker's target is fixed to the base,
// and what the device reports is carried to the world by where the tracker sees it (dissertation section 5.3,
// TrackedTransform).
//
//   X_WH = X_WB(t) X_BH      handle in the world, by the base's pose and the handle in the base's coordinates
//   w_B  = R_WB^T w_W        wrenches, about the handle, on the way back
//
// X_WB is the tracker's: at its rate, and late by its delay, while the handle is the device's own. So the virtual
// handle jumps by the base's way between two reports, and with a moving base it is behind by speed times delay. A base
// that stands still takes and gives no power; one that moves adds its own.
#pragma once

#include <memory>

#include "engine/device/device.hpp"

namespace verisim {

/// `inner` on a base that `tracker` follows: its handle is X_WB; hardware with a rate and a delay is such a tracker.
/// Records `tracked_base`. @pre neither is null, and they are not the same. About 50 ns a frame.
[[nodiscard]] std::shared_ptr<Device> make_tracked_transform(std::shared_ptr<Device> inner,
                                                             std::shared_ptr<Device> tracker);

}  // namespace verisim

// A haptic device on a mobile robot (dissertation sections 5.3 and 5.5): who holds its handle walks in the room, what
// it reports is in the coordinates of a base that moves, and how far its handle is from the middle of its workspace
// tells the base where to go.
//
//   operator in the room (W) -> mounted (B) -> hardware -> VRPNRemoteBase -> TrackedTransform by the base's tracker (W)
//
// W: world coordinates; B: base coordinates (engine/base/moving_base.hpp).
#pragma once

#include <memory>
#include <string>

#include "engine/base/moving_base.hpp"
#include "engine/device/device.hpp"

namespace verisim {

/// `source` moves in the room and holds the handle of a device on `base`: X_BH = X_WB^-1 X_WH. On the way back the
/// wrench is turned to the room, and its reaction loads the base at the handle's place. @pre neither is null. 60 ns.
[[nodiscard]] std::shared_ptr<Device> make_mounted(std::shared_ptr<Device> source, std::shared_ptr<MovingBase> base);

/// SPARTA's VRPNRemoteBase(device, x, z, server): drives the base by gain (p_BH - neutral) along x and z. It changes
/// nothing of what goes through it, but that the hand feels the base's limit where the base has one.
struct RemoteBaseDescription {
  double neutral_x = 0, neutral_z = 0;  ///< m, of the handle in B; SPARTA's scripts: 0, 0.55 for the Virtuose
  std::shared_ptr<const double> gain;   ///< read in every frame: a script may change it
  std::string server;                   ///< whom it drives, for the chain's words
};
/// Records `base_error` [m], before the gain. @pre inner, base and gain are not null; neutral is finite. 20 ns.
[[nodiscard]] std::shared_ptr<Device> make_remote_base(std::shared_ptr<Device> inner, std::shared_ptr<MovingBase> base,
                                                       RemoteBaseDescription description);

/// The base's tracker, as TrackedTransform takes one: its handle is what the tracker says of the base.
/// @pre base is not null
[[nodiscard]] std::shared_ptr<Device> make_base_tracker(std::string name, std::shared_ptr<MovingBase> base);

}  // namespace verisim

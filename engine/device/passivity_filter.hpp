// Time-domain passivity observer and controller (Hannaford and Ryu 2002; ORACLES section 2): what is behind the filter
// must not give the hand more energy than the hand gave it.
//
//   E_k = E_(k-1) + dt f_k . v_k     f: what the hand exerts on the handle, the opposite of what is rendered; v: of the
//                                    handle. Below 0 the chain has created energy.
//
// The controller then adds the damping that brings E back to 0 within the step, -E / (dt |v|^2).
#pragma once

#include <memory>

#include "engine/device/device.hpp"

namespace verisim {

struct PassivityDescription {
  bool controls = true;     ///< false: observes only
  double damping_max = 30;  ///< N s/m, of the controller: more than a hand bears at 1 kHz would make it chatter
};

/// Records passivity_energy, and says when the energy falls below 0 and when it is back. Error(input) unless
/// damping_max is finite and above 0. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_passivity_filter(std::shared_ptr<Device> inner,
                                                            const PassivityDescription& description);

}  // namespace verisim

// Devices: what a hand holds. A source (recorded trace, operator model) moves a handle; hardware models and filters
// wrap a device and are devices themselves (dissertation section 4.3.1). World coordinates, SI.
//
// One frame: sample() runs from the source outward to the outermost filter and yields the virtual handle; after the
// coupling, render() runs back inward with the wrench that the hand shall feel, until the hardware (or operator) gets
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/base/pose.hpp"

namespace verisim {

/// What a device says in one frame.
struct DeviceReading {
  Pose raw;            ///< what the hardware reports
  Pose handle;         ///< the virtual handle: after all filters
  bool button = true;  ///< a source without a button holds throughout
};

class Device {
 public:
  virtual ~Device() = default;
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Brings the device to simulated time t [s] (frame * dt). Called once a frame, in order.
  /// @pre t is finite and not before that of the last call; dt is finite and above 0
  virtual void sample(std::uint64_t frame, double t, double dt) = 0;
  /// What sample() found; before the first one, where the device rests.
  [[nodiscard]] virtual const DeviceReading& reading() const = 0;
  /// The wrench that the hand shall feel, about the virtual handle [N, N m].
  virtual void render(const Wrench& wrench, double dt) = 0;
  /// What the hardware was told to render in the last frame: after filters and limits.
  [[nodiscard]] virtual const Wrench& rendered() const = 0;
  /// Simulated time after which the device has nothing more to do [s]; 0: it has no end of its own.
  [[nodiscard]] virtual double duration() const = 0;
  /// How far the virtual handle can get from where it starts [m]; infinity if that is not known. What lies further away
  /// need not be voxelized.
  [[nodiscard]] virtual double travel() const = 0;
  /// Is anything driving it? A device that nothing drives stays at its home pose (and the run says so).
  [[nodiscard]] virtual bool driven() const = 0;
};

}  // namespace verisim

// Devices: what a hand holds. A source (recorded trace, operator model) moves a handle; hardware models and filters
// wrap a device and are devices themselves, in any order (dissertation section 4.3.1). World coordinates, SI.
//
// One frame: sample() runs from the source outward to the outermost filter and yields the virtual handle; after the
// coupling, render() runs back inward with the wrench that the hand shall feel, until the hardware (or operator) gets
// it. What a device may know of the frame comes with the call (DeviceFrame); it asks nobody else.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/columns.hpp"
#include "engine/base/contract.hpp"
#include "engine/base/part_notes.hpp"
#include "engine/base/pose.hpp"

namespace verisim {

/// What an operator sees of the virtual world, as it was at the end of the frame before. Where a scale, a bubble or a
/// navigator is between the two it is not where the hand is.
struct Sight {
  Pose handle;         ///< the virtual handle: what the outermost device reads
  Pose body;           ///< of the body that is held
  bool holds = false;  ///< is one?
};

/// What a device is told of a frame.
struct DeviceFrame {
  std::uint64_t number = 0;
  double t = 0;                   ///< s
  double dt = 0;                  ///< s
  std::uint32_t collisions = 0;   ///< contacts of the body that the device holds; for sample() of the frame before
  bool collision_starts = false;  ///< in the same frame; debounced (CollisionStart)
  Sight sight = {};               ///< for sample()
};

/// What a device says in one frame.
struct DeviceReading {
  Pose raw;            ///< what the hardware reports
  Pose handle;         ///< the virtual handle: after all filters
  Twist velocity;      ///< of the virtual handle, over the step that ended with this frame; 0 in the first
  bool button = true;  ///< a source without a button holds throughout
};

/// The velocity that brings a handle from one pose to the other within dt. @pre dt > 0
[[nodiscard]] inline Twist velocity_between(const Pose& before, const Pose& now, double dt) {
  return {(now.position - before.position) / dt, vector_from_rotation(now.rotation * before.rotation.conjugate()) / dt};
}

/// A box of handle positions [m]; infinite where nothing bounds them.
struct Workspace {
  Vector3d min = Vector3d::Constant(-std::numeric_limits<double>::infinity());
  Vector3d max = Vector3d::Constant(std::numeric_limits<double>::infinity());
  [[nodiscard]] bool contains(const Vector3d& p) const {
    return (p.array() >= min.array()).all() && (p.array() <= max.array()).all();
  }
};

/// What a handle adds to the hand that holds it.
struct HandleLoad {
  double mass = 0;      ///< kg, apparent
  double friction = 0;  ///< N, Coulomb
};

/// What an operator has learned of the chain around its device before the first frame: what does not change.
struct Practice {
  std::string name;     ///< of the chain: what the operator records stands under it
  double gain = 1;      ///< how much further the virtual handle moves than the hand (Device::gain)
  Workspace workspace;  ///< where the virtual handle can be (Device::workspace)
  /// m, of the hand: how far it can go until its position no longer controls the handle's alone
  double edge = std::numeric_limits<double>::infinity();
};

/// What began or ended in a frame.
using DeviceNotes = PartNotes;

class Device {
 public:
  virtual ~Device() = default;
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Its chain in words, innermost first: "omni (Phantom Omni, 3.3 N, …), scaled by 4".
  [[nodiscard]] virtual std::string described() const = 0;
  /// Brings the device to the frame's time. Called once a frame, in order.
  /// @pre frame.t is finite and not before that of the last call; frame.dt is finite and above 0
  virtual void sample(const DeviceFrame& frame) = 0;
  /// What sample() found; before the first one, where the device rests.
  [[nodiscard]] virtual const DeviceReading& reading() const = 0;
  /// The wrench that the hand shall feel, about the virtual handle [N, N m].
  virtual void render(const Wrench& wrench, const DeviceFrame& frame) = 0;
  /// What the hardware was told to render in the last frame: after filters and limits.
  [[nodiscard]] virtual const Wrench& rendered() const = 0;
  /// Simulated time after which the device has nothing more to do [s]; 0: it has no end of its own.
  [[nodiscard]] virtual double duration() const = 0;
  /// How far the virtual handle can get from where it starts [m]; infinity if that is not known. What lies further away
  /// need not be voxelized.
  [[nodiscard]] virtual double travel() const = 0;
  /// Is anything driving it? A device that nothing drives stays at its home pose (and the run says so).
  [[nodiscard]] virtual bool driven() const = 0;
  /// Names of what nothing drives: this device, or a tracker in its chain.
  [[nodiscard]] virtual std::vector<std::string> idle() const {
    return driven() ? std::vector<std::string>() : std::vector{name()};
  }
  /// Where the virtual handle can be.
  [[nodiscard]] virtual Workspace workspace() const { return {}; }
  /// Of a source: the handle's own load, before the first frame. A recorded hand has felt its handle already.
  virtual void carry(const HandleLoad& /*load*/) {}
  /// How much further the virtual handle moves than what moves it, where its position does: scales multiply.
  [[nodiscard]] virtual double gain() const { return 1; }
  /// Of a source: what its operator knows of the chain, before the first frame.
  virtual void practise(const Practice& /*practice*/) {}
  /// Adds what the device itself records, under /state/device/NAME. Called once, before the first frame; the getters
  /// live as long as the device.
  virtual void declare(Columns& /*columns*/) const {}
  /// Says what began or ended in the frame that was rendered last. No allocation.
  virtual void report(DeviceNotes& /*notes*/) {}
};

}  // namespace verisim

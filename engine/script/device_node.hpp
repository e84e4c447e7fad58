// A device as a script describes it, and how descriptions become devices. A word describes one of three: a source of
// motion, a hardware model that a source may drive, a filter around a device. Nothing in script but its word knows
// which device that is.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/script/values.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::script {

/// What is known when a device is made and was not when its word was called.
struct DeviceMaking {
  std::string name;  ///< of the device, and of its random streams
  std::uint64_t seed = 1;
  std::shared_ptr<Device> inner;  ///< of the node's inner node, made already; null if it has none
  std::shared_ptr<Device> base;   ///< of its base node, likewise
};
/// Never returns null. Error(input) for a description that cannot be made.
using DeviceFactory = std::function<std::shared_ptr<Device>(const DeviceMaking&)>;

struct DeviceNode {
  std::string name;                   ///< empty until name_devices for one without name=; of filters always
  std::string default_name;           ///< of one without name=, a number after it if need be; empty: a filter
  std::string made_as;                ///< the name that it is made with (name_devices)
  std::string place;                  ///< FILE:LINE of the word, for later errors
  bool drivable = false;              ///< hardware: a source may be its inner node, by operator= or by --bind
  std::shared_ptr<DeviceNode> inner;  ///< filters: what they wrap; hardware: what drives it, or null
  std::shared_ptr<DeviceNode> base;   ///< of a filter that needs a second device: a tracker of the base
  std::shared_ptr<double> gain;       ///< filters that have one a script may set (`.gain`); null: it has none
  const char* records = nullptr;      ///< filters: what of theirs is recorded, and so may be in a chain once
  DeviceFactory make;
  std::shared_ptr<Device> device;     ///< null until make_device
  std::unique_ptr<Columns> recorded;  ///< what the device declares; null until a script asks for it

  /// A filter has the name of what it wraps.
  [[nodiscard]] bool is_filter() const { return default_name.empty(); }
  [[nodiscard]] bool is_source() const { return !is_filter() && !drivable; }
};
using DevicePointer = std::shared_ptr<DeviceNode>;

/// The hardware or source at the inner end of a chain of filters: it carries the name. @pre every filter has an inner
/// node
[[nodiscard]] DeviceNode& innermost(DeviceNode& node);
/// All that carry a name in a chain: the innermost, and the trackers around it, from the inside out.
[[nodiscard]] std::vector<DeviceNode*> named_in(DeviceNode& node);

// What a word is made of. They raise with place and reason.

/// Raises once the simulation runs.
void check_building(lua_State* L, const char* word);
[[nodiscard]] DevicePointer device_at(lua_State* L, int index, const std::string& what);
/// A source, or hardware if the word sets `drivable`, with the name= of `fields`. The word sets `make`.
/// @pre default_name is not empty
[[nodiscard]] DevicePointer new_device(lua_State* L, Fields& fields, const char* default_name);
/// The device that a filter's word is called with: word{ device, … } or word{ device = device, … }. Raises for too many
/// filters around one device.
[[nodiscard]] DevicePointer wrapped_device(lua_State* L, Fields& fields, const char* word);
/// The word sets `make`. @pre inner is not null
[[nodiscard]] DevicePointer new_filter(lua_State* L, DevicePointer inner);
/// Says of a filter what it is, and raises if there is such a one in its chain already.
void record_once(lua_State* L, DeviceNode& filter, const char* word, const char* what);
/// `inner` itself for a factor of 1.
[[nodiscard]] DevicePointer scaled_device(lua_State* L, DevicePointer inner, double factor);

/// Of a device that replays a haptic trace: Devices.Replay, and what --bind drives hardware by. Reads the trace at
/// once. @pre max_gap is above 0
[[nodiscard]] DeviceFactory replay_of(Inputs& inputs, const std::string& trace, double max_gap, bool allow_gaps);

// What becomes of them after the script, in this order.

/// Gives every device its name and what drives it the name that it is made with. Error(input) for a name given twice.
void name_devices(const std::vector<DevicePointer>& devices);
/// The device of a node, made when first asked for, from the inside out. Error(input) begins with the node's place.
/// @pre name_devices has named it; its word has set `make`, which returns no null
[[nodiscard]] std::shared_ptr<Device> make_device(DeviceNode& node, std::uint64_t seed);

}  // namespace verisim::script

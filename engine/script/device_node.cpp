#include "engine/script/device_node.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/sources.hpp"
#include "engine/record/trace.hpp"
#include "engine/script/script_state.hpp"

namespace verisim::script {
namespace {

constexpr int kChainMax = 100;  // filters around one device

/// Samples of a trace's content. `name` is for the messages.
HapticSamples read_samples(Inputs& inputs, const std::string& name, const TraceLimits& limits) {
  const Trace trace = parse_trace(name, inputs.read(name), "haptic", limits);
  HapticSamples samples;
  const auto column = [&](const char* wanted) { return static_cast<std::size_t>(trace.column(wanted)); };
  const std::size_t t = column("t"), px = column("px"), py = column("py"), pz = column("pz");
  const std::size_t qx = column("qx"), qy = column("qy"), qz = column("qz"), qw = column("qw");
  const bool has_button = trace.column("button") >= 0;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const auto at = [&](std::size_t c) { return trace.at(row, c); };
    samples.t.push_back(at(t) - trace.at(0, t));
    samples.pose.push_back({{at(px), at(py), at(pz)}, Quaterniond(at(qw), at(qx), at(qy), at(qz)).normalized()});
    if (has_button) samples.button.push_back(at(column("button")) != 0 ? 1 : 0);
  }
  return samples;
}

}  // namespace

DeviceNode& innermost(DeviceNode& node) {
  DeviceNode* at = &node;
  while (at->is_filter()) {
    VERISIM_ASSERT(at->inner != nullptr);
    at = at->inner.get();
  }
  return *at;
}

std::vector<DeviceNode*> named_in(DeviceNode& node) {
  std::vector<DeviceNode*> names;
  if (node.is_filter()) {
    names = named_in(*node.inner);
    if (node.base) names.push_back(node.base.get());
  } else {
    names.push_back(&node);
  }
  return names;
}

void check_building(lua_State* L, const char* word) {
  if (ScriptState::of(L).simulation != nullptr)
    raise(L, "{}: the simulation runs already; call it while the scene is built", word);
}

DevicePointer device_at(lua_State* L, int index, const std::string& what) {
  return get<DevicePointer>(L, index, what);
}

DevicePointer new_device(lua_State* L, Fields& fields, const char* default_name) {
  VERISIM_ASSERT(*default_name != '\0');  // without one it would be a filter
  ScriptState::of(L).keep(kNodeBytes);
  auto node = std::make_shared<DeviceNode>();
  node->name = fields.name().value_or("");
  node->default_name = default_name;
  node->place = where(L);
  return node;
}

DevicePointer wrapped_device(lua_State* L, Fields& fields, const char* word) {
  check_building(L, word);
  if (!fields.push("device")) fields.push_child(1);
  DevicePointer inner = device_at(L, lua_gettop(L), fmt::format("{}: the device", word));
  lua_pop(L, 1);
  int length = 0;
  for (const DeviceNode* node = inner.get(); node != nullptr; node = node->inner.get()) ++length;
  if (length > kChainMax) raise(L, "{}: the device has {} filters already; make do with fewer", word, kChainMax);
  return inner;
}

DevicePointer new_filter(lua_State* L, DevicePointer inner) {
  VERISIM_ASSERT(inner != nullptr);
  ScriptState::of(L).keep(kNodeBytes);
  auto node = std::make_shared<DeviceNode>();
  node->place = where(L);
  node->inner = std::move(inner);
  return node;
}

void record_once(lua_State* L, DeviceNode& filter, const char* word, const char* what) {
  for (const DeviceNode* node = filter.inner.get(); node != nullptr; node = node->inner.get())
    if (node->records != nullptr && std::string_view(node->records) == what)
      raise(L, "{}: there is {} around this device already", word, what);
  filter.records = what;
}

DevicePointer scaled_device(lua_State* L, DevicePointer inner, double factor) {
  if (factor == 1) return inner;
  DevicePointer node = new_filter(L, std::move(inner));
  node->make = [factor](const DeviceMaking& making) { return make_scale(making.inner, factor); };
  return node;
}

DeviceFactory replay_of(Inputs& inputs, const std::string& trace, double max_gap, bool allow_gaps) {
  VERISIM_ASSERT(max_gap > 0);
  TraceLimits limits;
  limits.max_gap = max_gap;
  limits.allow_gaps = allow_gaps;
  return [samples = read_samples(inputs, trace, limits)](const DeviceMaking& making) {
    return make_replay(making.name, samples);
  };
}

void name_devices(const std::vector<DevicePointer>& devices) {
  std::vector<DeviceNode*> all;
  for (const DevicePointer& device : devices)
    for (DeviceNode* node : named_in(*device)) all.push_back(node);
  std::vector<std::string> taken;
  for (const DeviceNode* node : all) {
    if (node->name.empty()) continue;
    if (std::find(taken.begin(), taken.end(), node->name) != taken.end())
      fail(ErrorKind::input, "{}: there is a device '{}' already; give each another name=", node->place, node->name);
    taken.push_back(node->name);
  }
  for (DeviceNode* at : all) {
    DeviceNode& node = *at;
    if (node.name.empty()) {
      node.name = node.default_name;
      for (int i = 2; std::find(taken.begin(), taken.end(), node.name) != taken.end(); ++i)
        node.name = fmt::format("{}{}", node.default_name, i);
      taken.push_back(node.name);
    }
    node.made_as = node.name;
    if (!node.inner) continue;
    // What drives hardware is made with the hardware's name; with its word's if the scenario gave it a name of its own.
    // Its random streams are drawn by that: another rule would change the results of every such scenario.
    DeviceNode& source = *node.inner;
    source.made_as = source.name.empty() ? node.name : source.default_name;
    if (source.name.empty()) source.name = node.name;
  }
}

std::shared_ptr<Device> make_device(DeviceNode& node, std::uint64_t seed) {
  if (!node.device) {
    VERISIM_ASSERT(node.make != nullptr);
    VERISIM_ASSERT(!innermost(node).made_as.empty());
    const std::shared_ptr<Device> inner = node.inner ? make_device(*node.inner, seed) : nullptr;
    const std::shared_ptr<Device> base = node.base ? make_device(*node.base, seed) : nullptr;
    node.device = at_place(node.place, [&] { return node.make({innermost(node).made_as, seed, inner, base}); });
  }
  VERISIM_ASSERT(node.device != nullptr);
  return node.device;
}

}  // namespace verisim::script

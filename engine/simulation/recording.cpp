#include "engine/simulation/recording.hpp"

#include <algorithm>
#include <cstring>

#include "engine/base/hash.hpp"

namespace verisim {
namespace {

void declare_body(const World& world, const Stages& stages, std::size_t i, Columns& columns) {
  const Body& body = world.bodies[i];
  const std::string path = "/state/body/" + body.name;
  columns.add(path + "/pose", "m, 1", "world pose of the body coordinates: position, quaternion x y z w",
              [&body] { return body.rigid.pose(); });
  columns.add(path + "/twist", "m/s, rad/s", "velocity of the centre of mass, angular velocity; world", [&body] {
    return Twist{body.rigid.v_C, body.rigid.omega};
  });
  columns.add(path + "/force", "N, N m", "contact wrench on the body as applied, about its centre of mass; world",
              [&stages, i] { return stages.reactions.on_body(i); });
}

void declare_device(const Device& device, Columns& columns) {
  const std::string path = "/state/device/" + device.name();
  columns.add(path + "/handle_pose", "m, 1", "virtual handle: position, quaternion x y z w",
              [&device] { return device.reading().handle; });
  columns.add(path + "/raw_pose", "m, 1", "what the hardware reports: position, quaternion x y z w",
              [&device] { return device.reading().raw; });
  columns.add(path + "/wrench", "N, N m", "what the hardware is told to render, about the handle",
              [&device] { return device.rendered(); });
}

std::uint32_t contacts_of(const Stages& stages, std::size_t l) {
  return stages.contacts.count(l) + stages.exact.count(l);
}
double depth_of(const Stages& stages, std::size_t l) {
  return std::max(stages.contacts.depth_max(l), stages.exact.depth_max(l));
}

void declare_link(const World& world, const Stages& stages, std::size_t l, Columns& columns) {
  const std::vector<std::string> constraint_names(kConstraintKindNames.begin(), kConstraintKindNames.end());
  const auto [first, second] = world.links[l];
  const std::string path = "/state/link/" + world.bodies[first].name + "~" + world.bodies[second].name;
  columns.add(path + "/contacts", "1", "colliding voxel pairs; places of precise contact where the method is exact",
              [&stages, l] { return contacts_of(stages, l); });
  columns.add(path + "/cache_hits", "1", "constraint look-ups that were memoized",
              [&stages, l] { return stages.methods.look_ups(l).hits; });
  columns.add(path + "/cache_misses", "1", "constraint look-ups that had to be recognized",
              [&stages, l] { return stages.methods.look_ups(l).misses; });
  columns.add(
      path + "/constraint", "1", "strongest recognized constraint; none where the method is exact or off",
      [&stages, l] { return static_cast<std::uint8_t>(stages.methods.look_ups(l).constraint); }, constraint_names);
  columns.add(path + "/alignment", "1", "alignment alpha of that constraint",
              [&stages, l] { return stages.methods.look_ups(l).alpha; });
  columns.add(path + "/max_penetration", "m", "deepest contact", [&stages, l] { return depth_of(stages, l); });
  columns.add(path + "/wrench", "N, N m",
              "on the second body by the first as applied, about the second's centre of mass; world",
              [&stages, l] { return stages.reactions.on_second(l); });
}

std::array<double, 8> balance_of(const EnergyBook& book) {
  const EnergyState& e = book.state();
  const Ledger& l = book.ledger();
  return {e.kinetic, e.coupling, e.gravity, l.dissipated(), l.contact(), l.numerical(), l.input(), l.residual(e)};
}

Columns declare(const World& world, const Stages& stages, const FrameCost& cost) {
  Columns columns;
  columns.add("/state/time", "s", "simulated time at the end of the frame", [&world] { return world.time(); });
  for (std::size_t i = 0; i < world.bodies.size(); ++i) declare_body(world, stages, i, columns);
  for (const Hand& hand : world.hands) declare_device(*hand.device, columns);
  for (std::size_t l = 0; l < world.links.size(); ++l) declare_link(world, stages, l, columns);
  for (const CostCounter& counter : kCostCounters)
    columns.add(std::string("/cost/") + counter.name, counter.unit, counter.meaning,
                [&cost, count = counter.count] { return static_cast<std::uint32_t>(cost.*count); });
  for (const auto& companion : world.companions) companion->declare(columns);
  columns.add("/state/energy", "J",
              "kinetic, coupling springs, gravity, dissipated, given to contact, numerical, input by hands, residual "
              "of their balance",
              [&stages] { return balance_of(stages.energy); });
  return columns;
}

Schema schema_of(const Columns& columns) {
  Schema schema;
  for (const Column& column : columns.state()) schema.add(column);
  schema.add({"/state/hash",
              Dtype::u64,
              1,
              "1",
              "XXH3-64 of all values of /state in this row, seeded with the hash of the row before",
              0,
              {}});
  for (const Column& column : columns.other()) schema.add(column);
  return schema;
}

}  // namespace

Recording::Recording(const World& world, const Stages& stages, const FrameCost& cost)
    : columns_(declare(world, stages, cost)), schema_(schema_of(columns_)), row_(schema_.row_bytes(), std::byte{0}) {
  VERISIM_ASSERT(schema_.state_bytes() == columns_.state_bytes());
}

void Recording::take(const World& world, const Stages& stages, const FrameCost& cost) {
  add_up(world, stages, cost);
  columns_.put_state(row_.data());
  hash_ = hash_bytes(row_.data(), columns_.state_bytes(), hash_);
  std::byte* at = row_.data() + columns_.state_bytes();
  put_value(at, hash_);
  columns_.put_other(at);
}

void Recording::add_up(const World& world, const Stages& stages, const FrameCost& cost) {
  totals_.collision_frames += cost.contacts > 0 ? 1 : 0;
  totals_.contacts += cost.contacts;
  decltype(totals_.constraint_frames) active{};  // 0 or 1 per kind
  for (std::size_t l = 0; l < world.links.size(); ++l) {
    totals_.penetration_max = std::max(totals_.penetration_max, depth_of(stages, l));
    const LookUps found = stages.methods.look_ups(l);
    totals_.cache_hits += found.hits;
    totals_.cache_misses += found.misses;
    totals_.null_misses += found.null_misses;
    if (found.constraint != ConstraintKind::none) active[static_cast<std::size_t>(found.constraint)] = 1;
  }
  for (std::size_t kind = 0; kind < active.size(); ++kind) totals_.constraint_frames[kind] += active[kind];
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.moves(world.bodies[i]))
      totals_.force_max = std::max(totals_.force_max, stages.reactions.on_body(i).force.norm());
}

}  // namespace verisim

#include "engine/simulation/recording.hpp"

#include <algorithm>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"

namespace verisim {
namespace {

void declare_body(const World& world, const Stages& stages, std::size_t i, Columns& columns) {
  const Body& body = world.bodies[i];
  const std::string path = "/state/body/" + body.name;
  columns.add(path + "/pose", "m, 1", "world pose of the body coordinates: position, quaternion x y z w",
              [&body] { return body.rigid.pose(); });
  columns.add(path + "/twist", "m/s, rad/s",
              "velocity of the centre of mass, angular velocity, of the step that led to the pose; world", [&body] {
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
  device.declare(columns);
}

std::uint32_t contacts_of(const Stages& stages, std::size_t l) {
  return stages.contacts.count(l) + stages.exact.count(l);
}
double depth_of(const Stages& stages, std::size_t l) {
  return std::max(stages.contacts.depth_max(l), stages.exact.depth_max(l));
}

const char* source_of_depth(const World& world, const Stages& stages, std::size_t l) {
  if (stages.exact.depth_max(l) >= stages.contacts.depth_max(l)) return "exact surfaces";
  return world.parameters.contact == ContactMethod::fcl ? "triangles" : "voxels";
}

void declare_links(const World& world, const Stages& stages, Columns& columns) {
  const std::vector<std::string> constraint_names(kConstraintKindNames.begin(), kConstraintKindNames.end());
  const auto add = [&](const char* name, const char* units, const char* description, auto get,
                       std::vector<std::string> names = {}) {
    columns.add_to_table(std::string("/state/links/") + name, units, description, get, "/cost/links", std::move(names));
  };
  add("frame", "1", "row of the frame, from 0",
      [&world](std::size_t) { return static_cast<std::uint32_t>(world.frame - 1); });
  add("pair", "1", "row of the pair in /state/pairs, from 0",
      [&world](std::size_t l) { return static_cast<std::uint32_t>(world.links[l].number); });
  add("contacts", "1", "colliding voxel pairs; places of precise contact where the method is exact",
      [&stages](std::size_t l) { return contacts_of(stages, l); });
  add("by_voxels", "1", "how many of the contacts voxels answered",
      [&stages](std::size_t l) { return stages.contacts.count(l); });
  add("cache_hits", "1", "constraint look-ups that were memoized",
      [&stages](std::size_t l) { return stages.methods.look_ups(l).hits; });
  add("cache_misses", "1", "constraint look-ups that had to be recognized",
      [&stages](std::size_t l) { return stages.methods.look_ups(l).misses; });
  add(
      "constraint", "1", "strongest recognized constraint; none where the method is exact or off",
      [&stages](std::size_t l) { return static_cast<std::uint8_t>(stages.methods.look_ups(l).constraint); },
      constraint_names);
  add("alignment", "1", "alignment alpha of that constraint",
      [&stages](std::size_t l) { return stages.methods.look_ups(l).alpha; });
  add("max_penetration", "m", "deepest contact when the step began: of the poses of the row before",
      [&stages](std::size_t l) { return depth_of(stages, l); });
  add("wrench", "N, N m", "on the second body by the first as applied, about the second's centre of mass; world",
      [&stages](std::size_t l) { return stages.reactions.on_second(l); });
}

std::array<double, 8> balance_of(const EnergyBook& book) {
  const EnergyState& e = book.state();
  const Ledger& l = book.ledger();
  return {e.kinetic, e.coupling, e.gravity, l.dissipated(), l.contact(), l.numerical(), l.input(), l.residual(e)};
}

Columns declare(const World& world, const Stages& stages, const FrameCost& cost) {
  Columns columns;
  columns.add("/state/time", "s", "simulated time at the end of the frame", [&world] { return world.time(); });
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    columns.begin_part();
    declare_body(world, stages, i, columns);
    columns.end_part();
  }
  for (const Hand& hand : world.hands) declare_device(*hand.device, columns);
  declare_links(world, stages, columns);
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

std::vector<std::byte> rest_of(const Columns& columns) {
  std::vector<std::byte> state(columns.state_bytes());
  columns.put_state(state.data());
  return state;
}

/// The columns of a body that cannot move say what they say at rest in every row, but for the force when it is touched.
Column with_rest(const World& world, Column column, const std::byte* rest) {
  if (column.part != Column::kNoPart && !world.bodies[column.part].can_move)
    column.rest.assign(rest, rest + column.bytes());
  return column;
}

Schema schema_of(const World& world, const Columns& columns, const std::vector<std::byte>& rest) {
  Schema schema;
  for (const Body& body : world.bodies) schema.bodies.push_back(body.name);
  schema.pairs_in_frame = "/cost/pairs_met";
  std::size_t at = 0;
  for (const Column& column : columns.state()) {
    schema.add(with_rest(world, column, &rest[at]));
    at += column.bytes();
  }
  schema.add(
      {"/state/hash",
       Dtype::u64,
       1,
       "1",
       "XXH3-64 in three steps, each seeded with the one before, the first with the hash of the row before: of the "
       "values of /state in this row but those of bodies, in runs of datasets that follow each other; of the XXH3-64 "
       "(seed 0) of each body's values; of the row's rows of /state/links",
       0,
       {}});
  for (const Column& column : columns.other()) schema.add(column);
  for (const Column& column : columns.table()) schema.add(column);
  return schema;
}

}  // namespace

Recording::Recording(const World& world, const Stages& stages, const FrameCost& cost)
    : columns_(declare(world, stages, cost)),
      state_numbers_(columns_.state()),
      other_numbers_(columns_.other()),
      table_numbers_(columns_.table()),
      rest_(rest_of(columns_)),
      schema_(schema_of(world, columns_, rest_)),
      without_rest_(schema_.without_rest()),
      row_(schema_.row_bytes(), std::byte{0}),
      is_awake_(columns_.part_count(), false),
      body_hashes_(columns_.part_count(), 0) {
  awake_.reserve(columns_.part_count());
  VERISIM_ASSERT(schema_.state_bytes() == columns_.state_bytes());
  VERISIM_ASSERT(schema_.row_bytes() == columns_.state_bytes() + sizeof hash_ + columns_.other_bytes());
  VERISIM_ASSERT(schema_.table_row_bytes() == columns_.table_bytes());
}

void Recording::take(const World& world, const Stages& stages, FrameCost& cost) {
  take_links(world, stages);
  cost.links = table_.size() / columns_.table_bytes();
  std::byte* at = row_.data() + columns_.state_bytes();
  columns_.put_state(row_.data(), world.busy);
  columns_.put_other(at + sizeof hash_);
  list_awake(world);
  check_finite(world);
  add_up(world, stages, cost);
  update_hash(world.busy);
  put_value(at, hash_);
}

void Recording::list_awake(const World& world) {
  bool changed = false;
  for (const std::size_t i : world.busy) {
    if (world.bodies[i].can_move) continue;
    columns_.of_part(i, [&](std::size_t offset, std::size_t bytes) {
      const bool awake = std::memcmp(&row_[offset], &rest_[offset], bytes) != 0;
      changed = changed || awake != is_awake_[i];
      is_awake_[i] = awake;
    });
  }
  if (!changed) return;
  awake_.clear();
  for (std::size_t i = 0; i < is_awake_.size(); ++i)
    if (is_awake_[i]) awake_.push_back(i);
}

/// @param written  the bodies whose values are new in this row
void Recording::update_hash(std::span<const std::size_t> written) {
  const std::byte* const row = row_.data();
  columns_.each_written({},
                        [&](std::size_t offset, std::size_t bytes) { hash_ = hash_bytes(row + offset, bytes, hash_); });
  for (const std::size_t i : written)
    columns_.of_part(
        i, [&](std::size_t offset, std::size_t bytes) { body_hashes_[i] = hash_bytes(row + offset, bytes, 0); });
  hash_ = hash_bytes(body_hashes_.data(), sizeof(std::uint64_t) * body_hashes_.size(), hash_);
  hash_ = hash_bytes(table_.data(), table_.size(), hash_);
}

void Recording::check_finite(const World& world) const {
  const auto refuse = [&](const FiniteNumbers& numbers, const std::vector<Column>& columns, const std::byte* row,
                          const std::string& whose) {
    const auto [column, component, value] = *numbers.first_not_in(row);
    const std::string index = columns[column].width > 1 ? fmt::format("[{}]", component) : "";
    fail(ErrorKind::diverged,
         "frame {}: {}{}{} is {}, not a finite number any more; lower the stiffness or the time step", world.frame - 1,
         columns[column].path, index, whose, value);
  };
  bool finite = true;
  columns_.each_written(world.busy, [&](std::size_t offset, std::size_t bytes) {
    finite = state_numbers_.all_in(row_.data(), offset, bytes) && finite;
  });
  if (!finite) refuse(state_numbers_, columns_.state(), row_.data(), "");
  const std::byte* const other = row_.data() + columns_.state_bytes() + sizeof hash_;
  if (!other_numbers_.all_in(other)) refuse(other_numbers_, columns_.other(), other, "");
  std::size_t at = 0;
  for (const std::size_t l : recorded_links_) {
    const std::byte* const row = table_.data() + at;
    if (!table_numbers_.all_in(row))
      refuse(table_numbers_, columns_.table(), row,
             fmt::format(" of '{}' and '{}'", world.bodies[world.links[l].first].name,
                         world.bodies[world.links[l].second].name));
    at += columns_.table_bytes();
  }
}

/// A row for every pair whose boxes meet, and for those that a search for precise contacts looked at besides.
void Recording::take_links(const World& world, const Stages& stages) {
  table_.clear();
  recorded_links_.clear();
  for (const std::size_t l : world.near_links) {
    if (!stages.contacts.meets(l) && !stages.exact.searched(l)) continue;
    recorded_links_.push_back(l);
    table_.resize(table_.size() + columns_.table_bytes());
    columns_.put_table_row(table_.data() + table_.size() - columns_.table_bytes(), l);
  }
}

/// Who answered the contacts of each pair.
void Recording::add_up_answers(const World& world, const Stages& stages) {
  bool exact = false;  // a contact of a pair that was to be exact
  bool exact_by_voxels = false;
  for (const std::size_t l : recorded_links_) {
    const std::uint32_t by_voxels = stages.contacts.count(l);
    const std::uint32_t contacts = contacts_of(stages, l);
    if (contacts == 0) continue;
    const bool off = PairMethods::is_switched_off(world, l);
    PairTotals& pair = pair_totals_[l];
    pair.contacts += contacts;
    pair.by_voxels += by_voxels;
    ++pair.frames;
    pair.switched_off_frames += off ? 1 : 0;
    totals_.by_voxels += by_voxels;
    if (!PairMethods::asked_of(world, l)->needs_precise_surfaces()) continue;
    exact = true;
    exact_by_voxels = exact_by_voxels || by_voxels > 0;
  }
  totals_.exact_frames += exact ? 1 : 0;
  totals_.exact_frames_by_voxels += exact_by_voxels ? 1 : 0;
}

void Recording::add_up(const World& world, const Stages& stages, const FrameCost& cost) {
  totals_.collision_frames += cost.contacts > 0 ? 1 : 0;
  totals_.contacts += cost.contacts;
  add_up_answers(world, stages);
  decltype(totals_.constraint_frames) active{};  // 0 or 1 per kind
  for (const std::size_t l : world.near_links) {
    if (depth_of(stages, l) > totals_.penetration_max) {
      totals_.penetration_max = depth_of(stages, l);
      totals_.penetration_source = source_of_depth(world, stages, l);
    }
    const LookUps found = stages.methods.look_ups(l);
    totals_.cache_hits += found.hits;
    totals_.cache_misses += found.misses;
    totals_.null_misses += found.null_misses;
    if (found.constraint != ConstraintKind::none) active[static_cast<std::size_t>(found.constraint)] = 1;
  }
  for (std::size_t kind = 0; kind < active.size(); ++kind) totals_.constraint_frames[kind] += active[kind];
  for (const std::size_t i : world.moving)
    totals_.force_max = std::max(totals_.force_max, stages.reactions.on_body(i).force.norm());
}

}  // namespace verisim

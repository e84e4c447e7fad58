#include "engine/simulation/body_maker.hpp"

#include <algorithm>
#include <limits>

#include "engine/base/archive.hpp"
#include "engine/base/error.hpp"
#include "engine/exact/body_bytes.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/geometry/message.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/body_bytes.hpp"
#include "engine/voxel/limits.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {
namespace {

void forget_brep(Part& part) {
  part.faces.clear();
  part.edges.clear();
  part.mesh.face_of_triangle.clear();
}

VoxelizeOptions voxel_options(const BodyDescription& description, unsigned threads) {
  VoxelizeOptions options;
  options.voxel_size = description.voxel_size;
  options.point_spacing = description.point_spacing;
  options.threads = threads;
  return options;
}

/// All that a body is made from, as bytes.
template <typename... Options>
std::string key_of(std::span<const Part> parts, const Options&... options) {
  Message message;
  for (const Part& part : parts) message.push_back({"", to_tables(part)});
  ArchiveWriter key;
  key(encode(message), options...);
  return std::move(key.bytes);
}

/// What was prepared before, if it is in the store; else it is made, and kept there.
template <typename T, typename Key, typename Read, typename Make>
T prepared(PreparedStore* store, const char* kind, const Key& key_of_it, const Read& read, const Make& make) {
  if (store == nullptr) return make();
  const std::string key = key_of_it();
  if (const std::optional<std::string> bytes = store->find(kind, key)) return read(*bytes);
  T made = make();
  store->keep(kind, key, to_bytes(made));
  return made;
}

void check_voxels(const BodyDescription& description) {
  const Part part = merged(description.parts);
  check_voxel_size(description.name, part.mesh, checked_bounds(description.name, part.mesh),
                   voxel_options(description, 1));
}

/// How far from where bodies start their surfaces can get.
class Reach {
 public:
  explicit Reach(const World& world) : world_(world) {
    for (const Hand& hand : world.hands) travel_ = std::max(travel_, hand.device->travel());
    for (const Body& body : world.bodies) boxes_.push_back(world_box(body));
  }
  [[nodiscard]] bool can_meet(std::size_t i, std::size_t j) const {
    const Body& a = world_.bodies[i];
    const Body& b = world_.bodies[j];
    return (a.can_move || b.can_move) && gap(boxes_[i], boxes_[j]) <= of(a) + of(b);
  }
  [[nodiscard]] bool can_meet_another(std::size_t i) const {
    for (std::size_t j = 0; j < world_.bodies.size(); ++j)
      if (i != j && can_meet(i, j)) return true;
    return false;
  }

 private:
  /// m; infinite for what flies freely.
  [[nodiscard]] double of(const Body& body) const {
    if (!body.can_move) return 0;
    if (world_.parameters.all_bodies_are_dynamic) return std::numeric_limits<double>::infinity();
    return travel_ + body.bounds_B.size().norm();  // a body that turns sweeps its own size
  }

  const World& world_;
  double travel_ = 0;
  std::vector<Bounds> boxes_;
};

}  // namespace

bool will_be_exact(const BodyDescription& body, Hybrid method) {
  if (!method->needs_precise_surfaces() || !body.use_brep) return false;
  const auto is_known = [](const Face& face) { return !std::holds_alternative<OtherSurface>(face.surface); };
  return std::any_of(body.parts.begin(), body.parts.end(),
                     [&](const Part& part) { return std::any_of(part.faces.begin(), part.faces.end(), is_known); });
}

void BodyMaker::check(const World& world) const {
  const Reach reach(world);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (reach.can_meet_another(i)) check_voxels(bodies_[i]);
}

void BodyMaker::begin(World& world) {
  check(world);
  if (world.hands.empty()) return;
  const Reach reach(world);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (world.bodies[i].selectable && reach.can_meet_another(i)) make(world, i);
}

std::vector<std::pair<std::size_t, std::size_t>> BodyMaker::pairs_that_can_meet(const World& world) const {
  const Reach reach(world);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (std::size_t j = i + 1; j < world.bodies.size(); ++j)
      if (reach.can_meet(i, j)) pairs.emplace_back(i, j);
  return pairs;
}

void BodyMaker::make(World& world, std::size_t i) {
  Body& body = world.bodies[i];
  if (body.voxels) return;
  const BodyDescription& description = bodies_[i];
  voxelize_body(world, description, body);
  const BodyFeatures& features = body.voxels->features;
  if (features.entity_count() > 0) {
    body.entities = std::make_unique<EntitySets>(features.faces, features.edges, features.sets);
    if (body.method->needs_precise_surfaces() && description.use_brep) {
      auto precise = exact_body_of(world, description);
      if (precise->has_precise_faces()) body.exact = std::move(precise);
    }
  }
  bodies_[i] = {};
}

std::shared_ptr<const exact::ExactBody> BodyMaker::exact_body_of(const World& world,
                                                                 const BodyDescription& description) const {
  exact::BodyOptions options;
  options.spacing = description.voxel_size;
  options.line_stiffness = world.parameters.exact_stiffness;
  return std::make_shared<const exact::ExactBody>(prepared<exact::ExactBody>(
      store_.get(), "exact-body", [&] { return key_of(description.parts, options.spacing, options.line_stiffness); },
      exact::exact_body_from, [&] { return exact::ExactBody(description.parts, options); }));
}

VoxelBody BodyMaker::voxels_of(const BodyDescription& description, const Part& part, bool with_entities) const {
  // What a script declared is voxel by voxel: as long to write down as to do again.
  PreparedStore* store = description.declared ? nullptr : store_.get();
  return prepared<VoxelBody>(
      store, "voxels",
      [&] {
        return key_of({&part, 1}, description.voxel_size, description.point_spacing, with_entities);
      },
      voxel_body_from,
      [&] {
        VoxelBody voxels = voxelize(description.name, part.mesh, voxel_options(description, threads_));
        if (with_entities)
          associate(description.name, part, {.threads = threads_, .declared = description.declared.get()}, voxels);
        return voxels;
      });
}

void BodyMaker::voxelize_body(const World& world, const BodyDescription& description, Body& body) const {
  Part part = merged(description.parts);
  if (!description.use_brep) forget_brep(part);
  const bool with_entities = body.method->needs_entities() && (part.has_brep() || description.declared);
  body.voxels = std::make_shared<VoxelBody>(voxels_of(description, part, with_entities));
  if (world.parameters.contact == ContactMethod::fcl) body.mesh = std::make_unique<MeshTree>(part.mesh);
}

}  // namespace verisim

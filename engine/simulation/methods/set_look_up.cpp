#include "engine/simulation/methods/set_look_up.hpp"

#include <algorithm>

#include "engine/simulation/world.hpp"
#include "engine/voxel/association.hpp"

namespace verisim {

namespace {

/// to[i] = of[at[i]]; 0 where nothing is associated. Written so that nothing but the columns is read in the loop.
void fetch(const std::vector<std::uint32_t>& at, std::uint32_t count, const std::vector<FeatureSetId>& of,
           std::vector<FeatureSetId>& to) {
  if (of.empty()) {
    std::fill_n(to.begin(), count, FeatureSetId{0});
    return;
  }
  const std::uint32_t* const from = at.data();
  const FeatureSetId* const sets = of.data();
  FeatureSetId* const out = to.data();
  for (std::uint32_t i = 0; i < count; ++i) out[i] = sets[from[i]];
}

ConstraintOptions options_of(const Pair& pair) {
  ConstraintOptions options;
  options.measure = pair.parameters.alignment;
  options.reduction = pair.parameters.reduction;
  options.scales.voxel_size = std::max(pair.map().voxels->voxmap.voxel_size, pair.points().voxels->voxmap.voxel_size);
  return options;
}

}  // namespace

SetLookUp::SetLookUp(const Pair& pair)
    : map_(pair.map().voxels.get()),
      points_(pair.points().voxels.get()),
      constraints_(*pair.map().entities, *pair.points().entities, options_of(pair)),
      set_a_(points_->shell.size()),
      set_b_(points_->shell.size()) {}

ContactColumns SetLookUp::columns_of(const ContactList& contacts) {
  const VoxelBody& map = *map_;
  const Pointshell& shell = points_->shell;
  fetch(contacts.slot, contacts.size, map.slot_sets, set_a_);
  if (shell.voxel.empty()) {
    fetch(contacts.point, contacts.size, shell.features, set_b_);
  } else {
    for (std::uint32_t i = 0; i < contacts.size; ++i) set_b_[i] = feature_of_point(shell, contacts.point[i]);
  }
  ContactColumns columns;
  columns.size = contacts.size;
  columns.x = contacts.x.data();
  columns.y = contacts.y.data();
  columns.z = contacts.z.data();
  columns.set_a = set_a_.data();
  columns.set_b = set_b_.data();
  columns.origin = map.voxmap.origin;
  return columns;
}

void SetLookUp::note(const RestoreResult& result) {
  const MemoCounts& counts = constraints_.counts();
  look_ups_ = {result.kind,
               result.alpha,
               result.hits,
               result.misses,
               counts.recognitions - counted_.recognitions,
               counts.misses_null - counted_.misses_null,
               counts.overflows - counted_.overflows};
  counted_ = counts;
}

bool SetLookUp::restore_normals(ContactList& contacts, const Pose& X_AB) {
  constraints_.begin_frame(X_AB);
  ContactColumns columns = columns_of(contacts);
  columns.fx = contacts.nx.data();
  columns.fy = contacts.ny.data();
  columns.fz = contacts.nz.data();
  const RestoreResult result = constraints_.restore_contacts(columns);
  note(result);
  return result.restored > 0;
}

void SetLookUp::look_up(const ContactList& contacts, const Pose& X_AB) {
  constraints_.begin_frame(X_AB);
  note(constraints_.look_up_contacts(columns_of(contacts)));
}

}  // namespace verisim

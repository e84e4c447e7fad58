#include "engine/simulation/hybrid_link.hpp"

#include <algorithm>

#include "engine/voxel/association.hpp"

namespace verisim {

std::vector<bool> precisely_known(const BodyFeatures& features) {
  std::vector<bool> known;
  for (std::size_t id = 0; id < features.sets.size(); ++id) {
    bool any = false;
    bool all = true;
    for (const EntityNumber entity : features.sets[static_cast<FeatureSetId>(id)]) {
      if (!features.is_face(entity)) continue;
      any = true;
      all = all && !std::holds_alternative<OtherSurface>(features.face(entity).surface);
    }
    known.push_back(any && all);
  }
  return known;
}

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

}  // namespace

HybridLink::HybridLink(const Side& map, const Side& points, const ConstraintOptions& options)
    : map_(map),
      points_(points),
      constraints_(*map.entities, *points.entities, options),
      map_known_(precisely_known(map.voxels->features)),
      points_known_(precisely_known(points.voxels->features)) {
  const std::size_t capacity = points.voxels->shell.size();
  set_a_.resize(capacity);
  set_b_.resize(capacity);
}

ContactColumns HybridLink::columns_of(const ContactList& contacts) {
  const VoxelBody& map = *map_.voxels;
  const Pointshell& shell = points_.voxels->shell;
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

RestoreResult HybridLink::restore(ContactList& contacts, const Pose& X_AB, std::vector<float>& x, std::vector<float>& y,
                                  std::vector<float>& z) {
  constraints_.begin_frame(X_AB);
  ContactColumns columns = columns_of(contacts);
  columns.fx = x.data();
  columns.fy = y.data();
  columns.fz = z.data();
  return constraints_.restore_contacts(columns);
}

RestoreResult HybridLink::restore_forces(ContactList& contacts, const Pose& X_AB) {
  return restore(contacts, X_AB, contacts.fx, contacts.fy, contacts.fz);
}

RestoreResult HybridLink::restore_normals(ContactList& contacts, const Pose& X_AB) {
  return restore(contacts, X_AB, contacts.nx, contacts.ny, contacts.nz);
}

RestoreResult HybridLink::look_up(const ContactList& contacts, const Pose& X_AB) {
  constraints_.begin_frame(X_AB);
  return constraints_.look_up_contacts(columns_of(contacts));
}

void HybridLink::drop_known(ContactList& contacts) const {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < contacts.size; ++i) {
    const bool known = map_known_[feature_at(*map_.voxels, contacts.slot[i])] &&
                       points_known_[feature_of_point(points_.voxels->shell, contacts.point[i])];
    if (known) continue;
    contacts.point[kept] = contacts.point[i];
    contacts.slot[kept] = contacts.slot[i];
    for (auto* column :
         {&contacts.x, &contacts.y, &contacts.z, &contacts.nx, &contacts.ny, &contacts.nz, &contacts.depth})
      (*column)[kept] = (*column)[i];
    ++kept;
  }
  contacts.size = kept;
}

}  // namespace verisim

// The hybrid method of one pair of bodies, between the contacts that the voxels found and their sum.
//
// Source: dissertation sections 6.4.2 and 8.2.2. Brings together what knows voxels (contacts, feature sets of voxels)
// and what does not (constraints): fetches the two sets of every contact, and hands columns over. Coordinates as in the
// contact list: A is the body with the voxmap, B the one with the points. Nothing allocates after construction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/constraint/constraint_link.hpp"
#include "engine/contact/query.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// Set by set: is there a precise surface for every face in it, and at least one face?
[[nodiscard]] std::vector<bool> precisely_known(const BodyFeatures& features);

class HybridLink {
 public:
  /// One side of the pair; all must outlive the link.
  struct Side {
    const VoxelBody* voxels;
    const EntitySets* entities;
  };
  HybridLink(const Side& map, const Side& points, const ConstraintOptions& options);

  /// Restores the contacts' forces in place.
  RestoreResult restore_forces(ContactList& contacts, const Pose& X_AB);
  /// The same before there are forces: of each normal stays what the same restoration leaves of a force along it, and
  /// so of unit length or shorter. The law is the same for a force of any size: what is computed from these normals
  /// is restored. That holds for matrices too, and a damper along them leaves free what the constraint leaves free.
  RestoreResult restore_normals(ContactList& contacts, const Pose& X_AB);
  /// Looks all contacts up and leaves them as they are.
  RestoreResult look_up(const ContactList& contacts, const Pose& X_AB);
  /// What this frame's contacts stand under. Valid until the next restore or look_up.
  [[nodiscard]] std::span<const Engaged> engaged() const { return constraints_.engaged(); }

  /// Drops the contacts between voxels of which both bodies' surfaces are precisely known. Keeps the order.
  void drop_known(ContactList& contacts) const;

  /// Look-ups and recognitions since the pair was made.
  [[nodiscard]] const MemoCounts& counts() const { return constraints_.counts(); }

 private:
  [[nodiscard]] ContactColumns columns_of(const ContactList& contacts);
  RestoreResult restore(ContactList& contacts, const Pose& X_AB, std::vector<float>& x, std::vector<float>& y,
                        std::vector<float>& z);

  Side map_, points_;
  ConstraintLink constraints_;
  std::vector<FeatureSetId> set_a_, set_b_;     ///< of this frame's contacts
  std::vector<bool> map_known_, points_known_;  ///< by set id
};

}  // namespace verisim

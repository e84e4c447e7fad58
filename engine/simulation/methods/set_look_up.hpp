// The feature sets of a pair's voxel contacts, looked up and acted on: between contacts that know voxels and
// constraints that do not.
//
// Source: dissertation sections 6.4.2 and 8.2.2. Fetches the two sets of every contact and hands columns over to a
// ConstraintLink. Coordinates as in the contact list: A is the body with the voxmap, B the one with the points. Nothing
// allocates after construction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/constraint/constraint_link.hpp"
#include "engine/contact/query.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

class SetLookUp {
 public:
  explicit SetLookUp(const Pair& pair);

  /// Restores the contacts' normals, before there are forces: of each stays what the restoration leaves of a force
  /// along it, and so of unit length or shorter. The law is the same for a force of any size: what is computed from
  /// these normals is restored. That holds for matrices too, and a damper along them leaves free what the constraint
  /// leaves free. Returns whether a constraint holds anywhere: else the normals are the voxels'.
  bool restore_normals(ContactList& contacts, const Pose& X_AB);
  /// Looks all contacts up and leaves them as they are.
  void look_up(const ContactList& contacts, const Pose& X_AB);
  /// What this frame's contacts stand under. Valid until the next restore or look_up.
  [[nodiscard]] std::span<const Engaged> engaged() const { return constraints_.engaged(); }

  /// Of the last restore or look_up.
  [[nodiscard]] const LookUps& look_ups() const { return look_ups_; }

 private:
  [[nodiscard]] ContactColumns columns_of(const ContactList& contacts);
  void note(const RestoreResult& result);

  const VoxelBody* map_;
  const VoxelBody* points_;
  ConstraintLink constraints_;
  std::vector<FeatureSetId> set_a_, set_b_;  ///< of this frame's contacts
  MemoCounts counted_;                       ///< up to the last look-up
  LookUps look_ups_;
};

}  // namespace verisim

// Which faces and edges of a part pass through which of its surface voxels.
//
// Source: dissertation chapter 7 (association of voxels with b-rep features). A face passes through a voxel if a point
// of it, of the precise surface within the precise bounds, lies in the voxel's closed box; an edge likewise. None is
// missed and none invented, within 2^-21 of a voxel outward. What is not plane, cylinder, cone, sphere, torus, line,
// circle or ellipse is known by its triangles and polyline, so right within the deflection of the tessellation.
//
// Surface voxels come from the triangles, so some hold no point of any face: the triangles pass through a corner of
// the box and the faces, up to the deflection away, do not. Such a voxel gets the faces of its triangles (a STAND-IN):
// the nearest precise surface is known there and a contact in it is a contact with that face. With the empty set the
// answer would change to the voxel's own, by up to half a voxel, in the middle of a face. The report counts them.
#pragma once

#include <string>

#include "engine/geometry/part.hpp"
#include "engine/voxel/declared_features.hpp"

namespace verisim {

struct AssociateOptions {
  std::size_t most_sets = FeatureSets::kMostSets;  ///< more is an Error(input)
  unsigned threads = 1;                            ///< same result for any number
  const DeclaredFeatures* declared = nullptr;      ///< by hand; see there how they and the part's live together
};

struct AssociationReport {
  std::uint32_t stand_ins = 0;    ///< voxels that no face or edge passes through, only triangles
  std::uint32_t without = 0;      ///< voxels with the empty set: only triangles that belong to no face
  std::uint32_t loose_faces = 0;  ///< faces whose bounds do not close; their triangles take the bounds' place
};

/// Fills body.shell.features and body.features (the part's faces and edges, and the sets). Sets are numbered in the
/// order of the first surface voxel that has them, after those declared. 0.07 to 0.2 us per surface voxel. A part
/// without b-rep has the declared sets alone. Throws Error(input) starting with `name` if the part has more different
/// sets than options allow.
/// @pre body was voxelized from part.mesh, which has a face for every triangle or the part no b-rep; faces name edges
/// and edges faces of the part; what is declared was assigned to a body of the same voxels
AssociationReport associate(const std::string& name, const Part& part, const AssociateOptions& options,
                            VoxelBody& body);

/// The set of the voxel at `slot` (block * 512 + cell, as contacts name it), behind the surface that of the surface
/// voxel in front (slot_sets.hpp); 0 outside, or where nothing is associated.
[[nodiscard]] inline FeatureSetId feature_at(const VoxelBody& body, std::uint32_t slot) {
  return body.slot_sets.empty() ? FeatureSetId{0} : body.slot_sets[slot];
}

/// The set of the voxel that a pointshell point stands for; 0 where nothing is associated.
[[nodiscard]] inline FeatureSetId feature_of_point(const Pointshell& shell, std::uint32_t point) {
  if (shell.features.empty()) return 0;
  return shell.features[shell.voxel.empty() ? point : shell.voxel[point]];
}

}  // namespace verisim

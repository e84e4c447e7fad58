// Association of surface voxels with the faces and edges of the part that pass through them.
//
// Source: dissertation chapter 7 (association of voxels with b-rep features). A face passes through a voxel if a point
// of its precise surface, within its precise bounds, lies in the voxel's closed box; an edge likewise. The result is
// exact to 2^-21 of a voxel outward. Freeform faces and edges are represented by their triangles and polylines; for
// them the result is exact to the deflection of the tessellation.
//
// Stand-ins. Surface voxels come from the triangles, so some hold no point of any face: the triangles pass through a
// corner of the box, the faces (up to the deflection away) do not. Such a voxel gets the faces of its triangles. With
// the empty set a contact there would not be recognized, in the middle of a face. The report counts stand-ins.
#pragma once

#include <string>

#include "engine/geometry/part.hpp"
#include "engine/voxel/declared_features.hpp"

namespace verisim {

struct AssociateOptions {
  std::size_t most_sets = FeatureSets::kMostSets;  ///< more is an Error(input)
  unsigned threads = 1;                            ///< same result for any number
  const DeclaredFeatures* declared = nullptr;      ///< by a script; see declared_features.hpp
};

struct AssociationReport {
  std::uint32_t stand_ins = 0;    ///< voxels that no face or edge passes through, only triangles
  std::uint32_t without = 0;      ///< voxels with the empty set: only triangles that belong to no face
  std::uint32_t loose_faces = 0;  ///< faces whose bounds do not close; their triangles are used instead
};

/// Fills body.shell.features and body.features (the part's faces and edges, and the sets). Sets are numbered in the
/// order of the first surface voxel that has them, after those declared. 0.07 to 0.2 us per surface voxel. A part
/// without b-rep has the declared sets alone. Throws Error(input) starting with `name` if the part has more different
/// sets than options allow.
/// @pre body was voxelized from part.mesh, which has a face for every triangle or the part no b-rep; faces name edges
/// and edges faces of the part; what is declared was assigned to a body of the same voxels
AssociationReport associate(const std::string& name, const Part& part, const AssociateOptions& options,
                            VoxelBody& body);

// The two below are asked for every contact. What they are asked for is not asserted here, but comes from a query,
// which asserts that map and shell are whole.

/// The set of the voxel at `slot` (block * 512 + cell, as in ContactList). Behind the surface: that of the surface
/// voxel in front (slot_sets.hpp). 0 outside, or if association has not been run.
[[nodiscard]] inline FeatureSetId feature_at(const VoxelBody& body, std::uint32_t slot) {
  return body.slot_sets.empty() ? FeatureSetId{0} : body.slot_sets[slot];
}

/// The set of the surface voxel of a pointshell point; 0 if association has not been run.
[[nodiscard]] inline FeatureSetId feature_of_point(const Pointshell& shell, std::uint32_t point) {
  if (shell.features.empty()) return 0;
  return shell.features[shell.voxel.empty() ? point : shell.voxel[point]];
}

}  // namespace verisim

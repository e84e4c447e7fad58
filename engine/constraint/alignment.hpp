// Alignment of a recognized constraint in a pose: alpha in [0, 1], 1 = fully aligned.
//
// Source: dissertation section 8.3.4 (eq. 8.1, 8.2) and the wish in section 9.1: "a few degrees of misalignment for a
// cylindrical pin-in-hole conceptually suggests a very different alignment factor than the same number of degrees of
// misalignment between two planes".
//
// Three measures:
//   faas     0.5 e^(-theta / theta0) + 0.5 e^(-d / d0)      eq. 8.1; theta0 = voxel / engagement length, d0 = voxel
//   pavlik   0.5 e^(-theta) + 0.5 e^(-c d / dc)             eq. 8.2; dc the clearance, c = 10 as published
//   by_type  this project's, see below
//
// Why a third measure. Both published ones are sums: a pin with 90 degrees of tilt, or one that is a metre beside its
// hole, keeps half of its alignment, and 1 degree of tilt costs the same for a needle as for a coin. `by_type` measures
// one length for every constraint: the misalignment x [m] by which the mating surfaces miss each other, beyond the
// clearance. It compares x with the voxel size s, below which contacts cannot resolve it:
//       alpha = 1 - max(0, x) / s, at least 0.
//   axes        x = offset + (engagement length / 2) tan(theta) - clearance. For x < 0 the pin stands freely in its
//               hole (x = 0 is the two-point contact of ORACLES section 2, to first order), so alpha = 1. A degree of
//               tilt costs a long pin much and a short one little.
//               If x > 0, alpha is multiplied by engagement length / s, at most 1 (s: at most the length of the
//               shorter side). Reason: before the end of a pin has passed the rim, no walls face each other; a pin
//               that stands on the rim a little beside its hole would lose the force that holds it. Below x = s / 10
//               the factor goes over into 1: a pin that stands freely before its hole touches nothing, whatever the
//               voxels report.
//   centres     x = distance - clearance. Angles have no meaning.
//   ball, axis  x = distance from the axis, and past the end of the tube, - clearance.
//   planes      and edges or rollers on planes: alpha = 1 - tan^2(theta), at least 0. 1 - alpha is the share that stays
//               of the voxels' own push along the plane. Of second order, for what rests on voxels stands 1e-4 to
//               1e-3 rad askew: of first order it was left a push of as much of its weight, and without friction
//               nothing stops what that sets moving (1 to 12 mm in 4 s). A degree costs 0.03 %, ten 3 %.
// alpha is continuous in the pose, also through parallel axes. It is 0 if the pose is not finite.
//
// d is the distance of the two axes within the bounded length of the hole, not of infinite lines. That of infinite
// lines jumps from the offset to 0 as two parallel axes tilt by a hair, because they then meet far away. d is
// continuous through parallel axes. It equals the published distance if the axes are closest within the bounded length.
#pragma once

#include "engine/constraint/constraint.hpp"

namespace verisim {

enum class AlignmentMeasure { faas, pavlik, by_type };

struct AlignmentScales {
  double voxel_size = 0.0045;  ///< m, > 0: of the coarser of the two bodies
  double steepness = 10;       ///< c of eq. 8.2, from the published code
};

/// The misalignment of a constraint's two sides in one pose.
struct Misalignment {
  double sine = 0;                   ///< of theta, >= 0
  double cosine = 1;                 ///< of theta; negative beyond 90 degrees where a direction's sense matters
  double distance = 0;               ///< d of eq. 8.1 and 8.2 [m]
  double offset = 0;                 ///< the same in the middle of the engaged length [m]
  double engagement_length = 0;      ///< over which the two sides overlap along the axis [m]
  double local_clearance = 0;        ///< of the fit at this place [m], >= 0: a cone's grows as it is pulled out
  double engagement_length_max = 0;  ///< length of the shorter side [m]
};

/// Pure; about 50 ns. Zero and NaN lengths cannot occur (entities.hpp). A pose that is not finite gives members that
/// are not finite. @param X_AB places body B in A @pre constraint.kind is not `none`: nothing else of it means anything
[[nodiscard]] Misalignment misalignment(const Constraint& constraint, const Pose& X_AB);

/// alpha, from 0 to 1; 0 if a number is not finite. Cost: `by_type` a division, the others two pinned exp and an atan2.
/// @pre scales.voxel_size > 0, scales.steepness >= 0, both finite
[[nodiscard]] double alignment(AlignmentMeasure measure, const Constraint& constraint, const Misalignment& m,
                               const AlignmentScales& scales);

/// How far a pin's end is clear of its hole: 0 while it covers any part of the hole (the axes are closer than the sum
/// of both radii), rising to 1 a voxel farther out. 0 if a number is not finite. Does not depend on the measure.
/// @pre `round` is axis_axis; scales.voxel_size > 0
[[nodiscard]] double clear_of_hole(const Constraint& round, const Misalignment& m, const AlignmentScales& scales);

}  // namespace verisim

// How well a recognized constraint is aligned in this pose: alpha in [0, 1], 1 = fully.
//
// Source: dissertation section 8.3.4 (eq. 8.1, 8.2) and the wish in section 9.1: "a few degrees of misalignment for a
// cylindrical pin-in-hole conceptually suggests a very different alignment factor than the same number of degrees of
// misalignment between two planes".
//
// Three measures:
//   faas     0.5 e^(-theta / theta0) + 0.5 e^(-d / d0)      eq. 8.1; theta0 = voxel / engaged length, d0 = voxel
//   pavlik   0.5 e^(-theta) + 0.5 e^(-c d / dc)             eq. 8.2; dc the clearance, c = 10 as published
//   by_type  below
// Both published ones are sums: a pin with 90 degrees of tilt, or one that is a metre beside its hole, keeps half of
// its alignment, and 1 degree of tilt costs the same whether the pin is a needle or a coin. `by_type` asks one question
// of every constraint, in metres: by how much do the surfaces that should mate miss each other (x), beyond what the fit
// allows, compared with the voxel size s, below which contact cannot tell?
//       alpha = 1 - max(0, x) / s, at least 0.
//   axes     x = offset + (engaged / 2) tan(theta) - clearance. While it is below 0 the pin stands freely in its hole
//            (x = 0 is the two-point contact of ORACLES section 2 to first order): nothing is misaligned, alpha = 1.
//            A degree costs a long pin much and a short one little. If x > 0, times engaged / s, at most 1 (s: no more
//            than the shorter side): before the pin's end has passed the rim no wall faces another, and a pin that
//            stands on the rim a little beside its hole would lose the push that holds it. Below x = s / 10 this goes
//            over into 1: a pin that stands freely before its hole touches nothing, whatever the voxels say.
//   centres  x = distance - clearance. Angles mean nothing: a ball is round.
//   ball on an axis: x = distance from the axis, and past the tube's end, - clearance.
//   planes, and edges or rollers on planes: a plate that is tilted still slides; what a tilt spoils is which way the
//            normal points. Of a force along one normal the share tan(theta) is read as friction, so
//            alpha = 1 - tan(theta), at least 0: the same formula with x / s = tan(theta). A degree costs 1.7 %.
// alpha is continuous in the pose, through parallel axes too, and 0 if the pose is not finite.
//
// d is the distance of the two axes within the hole's bounded stretch, not of infinite lines: that one jumps from the
// offset to 0 as two parallel axes tilt by a hair, because they then meet far away. For parallel axes d is the
// distance of a point from a line; d is continuous through parallel, and agrees with the published one when the place
// where the axes are nearest lies in the stretch.
#pragma once

#include "engine/constraint/constraint.hpp"

namespace verisim {

enum class AlignmentMeasure { faas, pavlik, by_type };

struct AlignmentScales {
  double voxel_size = 0.0045;  ///< m, > 0: of the coarser of the two bodies
  double steepness = 10;       ///< c of eq. 8.2, from the published code
};

/// How two sides stand to each other in one pose.
struct Misalignment {
  double sine = 0;      ///< of theta, >= 0
  double cosine = 1;    ///< of theta; negative beyond 90 degrees where a direction's sense matters
  double distance = 0;  ///< d of eq. 8.1 and 8.2 [m]
  double offset = 0;    ///< the same in the middle of the engaged stretch [m]
  double engaged = 0;   ///< length over which the two lie side by side [m]
  double play = 0;      ///< what the fit allows at this place [m], >= 0
  double mating = 0;    ///< the most that can be engaged: length of the shorter side [m]
};

/// @param X_AB places body B in A. Pure; about 50 ns. Zero and NaN lengths cannot occur (entities.hpp); a pose that is
/// not finite gives members that are not finite. @pre constraint.kind is not `none`: nothing else of it means anything
[[nodiscard]] Misalignment misalignment(const Constraint& constraint, const Pose& X_AB);

/// alpha, from 0 to 1; 0 if anything is not finite. Cost: `by_type` a division, the others two pinned exp and an atan2.
/// @pre scales.voxel_size > 0, scales.steepness >= 0, both finite
[[nodiscard]] double alignment(AlignmentMeasure measure, const Constraint& constraint, const Misalignment& m,
                               const AlignmentScales& scales);

/// Does a pin stand wholly beside its hole? From 0, while its end covers any part of the hole (the axes are nearer than
/// both radii together), to 1, a voxel farther out. Whatever the measure; 0 if not finite.  @pre `round` is axis_axis;
/// scales.voxel_size > 0
[[nodiscard]] double wholly_beside(const Constraint& round, const Misalignment& m, const AlignmentScales& scales);

}  // namespace verisim

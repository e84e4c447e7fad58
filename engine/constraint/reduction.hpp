// From several candidates to what is done at one voxel: the reduction of dissertation section 6.3.1 (eq. 6.5).
//
// Two voxels hold sets of entities, so several constraints may be recognized between them. A policy says what then
// holds:
//
//   exactly_one     the dissertation's: the constraint if exactly one was recognized, else none.
//   common_freedom  every recognized constraint that is aligned in this pose holds, and what is restored is what all of
//                   them leave free.
//
// Why the second. A rim voxel of a bored block holds the top plane, the wall of the hole and the circle between them; a
// pin's wall against it gives cylinder-cylinder, circle-cylinder and plane-cylinder: three, so `exactly_one` says none,
// just where a pin is when it enters. Picking a favourite instead ("round before flat") is wrong for a pin with a
// collar that sits on that rim: there wall and top both hold, and a favourite would let the collar sink. The common
// freedom is right for both without knowing which is which: of a force at x, the span of the engaged constraints'
// normals n_i(x) is kept and the rest restored. A box's edge in the corner of two walls keeps both walls' pushes and
// loses only the false friction along the edge; at a corner of three walls nothing is free and the force stays as it
// is.
//
//   Merging: two constraints about the same axis on both bodies (the wall of a hole and its rim, against the same pin)
//   are one; the one whose entities have the higher dimension stays.
//   Handing over: a pin's flat end and the face around its hole mate as planes only where the pin stands wholly beside
//   the hole. While the end covers any part of the hole the two rims cross. What touches there is edge on edge: its
//   normal lies anywhere between end and side, as they tilt, and leans towards the hole's axis. To hold such a contact
//   to the planes' normal takes away just the part of the force that guides the pin in, and the pin glides off and
//   falls over. So the planar constraint's alpha is multiplied by wholly_beside() of the round one (alignment.hpp), and
//   until then the voxels' answer stands. This is asked of the two bodies' faces and not of the two voxels' sets: a
//   voxel beside the rim does not know of the hole. Only for convex rims on both bodies: a collar that hangs on a rim
//   touches end to face and wall to wall at once.
//   Degrees: alpha_i is read as the probability that constraint i holds, independent of the others; f' is the
//   expectation over all subsets S of the force with the span of S kept:  f' = sum_S  w_S P_S f,  P_(empty) = 1.
//   With one constraint this is eq. 8.8 and 8.9 again; it is continuous in every alpha and never lengthens f.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/constraint/restoration.hpp"

namespace verisim {

enum class Reduction { exactly_one, common_freedom };

/// Are a and b the same constraint, because their axes are the same line on both bodies? Pose plays no part.
[[nodiscard]] bool same_axes(const Constraint& a, const Constraint& b);

/// Is `planar` the meeting of the flat ends of what `round` mates, with a convex rim on both bodies? (Handing over.)
[[nodiscard]] bool hands_over(const Constraint& planar, const Constraint& round);

/// How many constraints may hold at one contact: three normals span everything.
inline constexpr std::size_t kHoldingMax = 3;

/// f' under all constraints of `holding` at once (common_freedom). @pre holding.size() <= kHoldingMax,
/// an alpha for each
[[nodiscard]] Vector3d restore_common(std::span<const ActiveConstraint* const> holding, std::span<const double> alpha,
                                      const Vector3d& x, const Vector3d& f);

}  // namespace verisim

// Reduction: from several candidate constraints at one voxel to the effect on its force. Source: dissertation section
// 6.3.1 (eq. 6.5).
//
// Two voxels hold sets of entities, so several constraints may be recognized between them. Two policies:
//   exactly_one     the dissertation's: the constraint if exactly one was recognized, else none.
//   common_freedom  all recognized constraints that are aligned in this pose are active. Restored is what all of them
//                   leave free: of a force at x, the span of the active constraints' normals n_i(x) is kept.
//
// Why the second. A rim voxel of a bored block holds the top plane, the wall of the hole and the circle between them. A
// pin's wall against it gives three constraints: cylinder-cylinder, circle-cylinder and plane-cylinder. `exactly_one`
// then takes none, just where a pin enters. A fixed priority ("curved before flat") is wrong for a pin with a collar
// that sits on that rim: there wall and top are both active, and the collar would sink. The common freedom is right for
// both. A box's edge in the corner of two walls keeps the forces of both walls and loses only the false friction along
// the edge. At a corner of three walls nothing is free, and the force is unchanged.
//
// Merging. Two constraints about the same axes on both bodies are one, as the wall of a hole and its rim against the
// same pin. The one whose entities have the higher dimension remains.
//
// Gating: which constraint owns a contact at a rim. A pin's flat end and the face around its hole mate as planes only
// where the pin is clear of the hole. While the end covers any part of the hole, the two rims cross, and edge touches
// edge. The normal of such a contact lies between those of end and side and is tilted towards the hole's axis. The
// planes' normal would remove just the component that guides the pin in, and the pin would glide off and fall over. So
// the planar constraint's alpha is multiplied by clear_of_hole() of the axial constraint (alignment.hpp); until then
// the forces of the voxels stand. Gates are found among the faces of the two bodies, not among the sets of the two
// voxels, because a voxel beside the rim does not know of the hole. Only convex rims on both bodies are gated: a collar
// that hangs on a rim touches end to face and wall to wall at once.
//
// Partial alignment. alpha_i is read as the probability that constraint i is active, independent of the others. f' is
// the expectation over all subsets S of the force with the span of S kept:  f' = sum_S  w_S P_S f,  P_(empty) = 1. With
// one constraint this is eq. 8.8 and 8.9. It is continuous in every alpha and never lengthens f.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/constraint/restoration.hpp"

namespace verisim {

enum class Reduction { exactly_one, common_freedom };

/// True if the axes of a and b are the same line on both bodies, in any pose: the two constraints are one.
[[nodiscard]] bool same_axes(const Constraint& a, const Constraint& b);

/// True if `planar` mates the flat ends of the shapes that `round` mates, with a convex rim on both bodies (gating).
[[nodiscard]] bool is_gated_by(const Constraint& planar, const Constraint& round);

/// Active constraints at one contact: three normals span space.
inline constexpr std::size_t kActiveMax = 3;

/// f' under all constraints of `active` together (common_freedom). @pre active.size() <= kActiveMax,
/// an alpha for each
[[nodiscard]] Vector3d restore_common(std::span<const ActiveConstraint* const> active, std::span<const double> alpha,
                                      const Vector3d& x, const Vector3d& f);

}  // namespace verisim

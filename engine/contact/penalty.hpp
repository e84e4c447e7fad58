// Penalty forces of a list of contacts, and their sum as one wrench. A hybrid method may change forces in between.
//
// Source: tangent-plane penalty force (McNeely 1999); stability: ORACLES section 2, discrete mass-spring-damper.
//
// Stability rule. With n_i the normal and r_i the arm of contact i about B's centre of mass, J_i = (n_i, r_i x n_i) and
// W = sum J_i J_i^T, a penalty of stiffness k and damping b per contact acts on B (mass matrix M) as K = k W, D = b W.
// Semi-implicit Euler is stable iff  lambda (k dt^2 + 2 b dt) < 4  for the largest eigenvalue lambda of M^-1 W. The
// Frobenius norm of M^-1/2 W M^-1/2 bounds lambda from above, so  k dt^2 + 2 b dt <= kSafety * 4 / norm  is enough.
#pragma once

#include "engine/contact/query.hpp"

namespace verisim {

/// k dt^2 lambda + 2 b dt lambda of all that acts on a body at the start of a step stays below it.
inline constexpr double kStabilityBudget = 4;

/// W = sum over contacts of J J^T about the point `about` (body coordinates of A relative to its grid origin), where
/// the contacts' own coordinates live. Eight fixed strands, then a fixed tree: same bits for every SIMD target.
/// @pre contacts.size <= contacts.capacity(), here and below: whole vectors are read, to the end of the padding
[[nodiscard]] Matrix6d contact_matrix(const ContactList& contacts, const Vector3d& about);

/// Forces f_i = max(0, k depth_i - b v_i) n_i with v_i the velocity of B's point against A along n_i (positive when
/// leaving). `velocity` is B's relative to A: linear at `about`, angular; body coordinates of A.
/// @pre stiffness >= 0, damping >= 0
void apply_penalty(ContactList& contacts, const Vector3d& about, const Twist& velocity, double stiffness,
                   double damping);

/// Sum of the forces and of their torques about `about`, and the deepest depth. Fixed order as above.
struct ContactSum {
  Wrench wrench;         ///< on B, body coordinates of A
  double depth_max = 0;  ///< m
};
[[nodiscard]] ContactSum sum(const ContactList& contacts, const Vector3d& about);

/// What apply_penalty and sum would give, and W of the contacts that push: their force changes with the motion. One
/// that does not push does not resist, for it would not pull.
struct Pushing {
  ContactSum sum;
  Matrix6d W = Matrix6d::Zero();
};
/// In one pass. Single forces are neither stored nor rounded to single precision.
/// @pre stiffness >= 0, damping >= 0
[[nodiscard]] Pushing pushing(const ContactList& contacts, const Vector3d& about, const Twist& velocity,
                              double stiffness, double damping);

}  // namespace verisim

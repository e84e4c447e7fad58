// What two entities of two bodies can be to each other: one geometric constraint, with its data in the coordinates of
// each of the two bodies. A value of fixed size: recognition returns it, the memo keeps it, no heap.
//
// Source: dissertation chapters 7 and 8. Names: the pair of bodies is (A, B), as everywhere in this folder: A is the
// body in whose coordinates contacts are given, forces act on B. m, rad.
#pragma once

#include <array>
#include <cstdint>

#include "engine/base/pose.hpp"

namespace verisim {

/// The numbers that a run file stores (`/state/link/A~B/constraint`).
enum class ConstraintKind : std::uint8_t { none, planar, cylindrical, conical, spherical, annular, other };

/// What is compared to tell how well the two sides are aligned.
enum class Pairing : std::uint8_t {
  axis_axis,    ///< two lines: angle between them, distance between them
  plane_plane,  ///< two planes that face each other
  point_point,  ///< two centres: distance; no angle means anything
  point_axis,   ///< a ball's centre and the axis of what it lies in: distance; no angle
  axis_plane,   ///< a line that should lie along a plane: angle out of the plane
  point_plane   ///< a ball on a plane: always aligned
};

/// Where contact forces that are right point: the normals by which restoration splits a force (restoration.hpp).
enum class NormalField : std::uint8_t {
  constant,     ///< one direction everywhere
  about_line,   ///< away from a line
  about_point,  ///< away from a point
  about_cone,   ///< the cone's own normal: away from its axis, leaning back by the half angle
  about_ring    ///< away from the nearest point of a circle (a torus's core)
};

enum class Side : std::uint8_t { a, b, neither };

[[nodiscard]] inline Side opposite(Side side) {
  if (side == Side::neither) return side;
  return side == Side::a ? Side::b : Side::a;
}

/// One body's half of a constraint, in that body's coordinates.
struct ConstraintSide {
  Vector3d point;      ///< of an axis or a plane: the middle of the bounded stretch; of a ball: its centre
  Vector3d direction;  ///< unit: an axis, or a plane's normal out of the material
  double radius;       ///< of the round shape at `point` (a torus: of its core circle); 0 for planes and lines
  double half_length;  ///< of the bounded stretch along `direction` (planes: of its shorter edge)
  double detail;       ///< a cone's tangent of the half angle, a torus's tube radius; else 0
};

struct Constraint {
  ConstraintKind kind;
  // Everything below has a meaning only if kind is not `none`: most pairs are nothing, and are not paid for.
  Pairing pairing;
  NormalField field;
  Side guide;        ///< whose data gives the field of normals; `neither`: both alike
  Side pin;          ///< the side that is inside the other
  bool pushes_only;  ///< a force along the wrong sense of the normal is an artefact too (eq. 8.9)
  double clearance;  ///< hole's radius minus pin's; 0 where radii mean nothing
  ConstraintSide a, b;

  /// No constraint.
  Constraint() : kind(ConstraintKind::none) {}
  [[nodiscard]] const ConstraintSide& side(Side s) const { return s == Side::b ? b : a; }
};

/// The same constraint seen from the other body.
[[nodiscard]] inline Constraint mirrored(const Constraint& c) {
  if (c.kind == ConstraintKind::none) return {};
  Constraint m = c;
  m.a = c.b;
  m.b = c.a;
  m.guide = opposite(c.guide);
  m.pin = opposite(c.pin);
  return m;
}

inline constexpr std::array<const char*, 7> kConstraintKindNames = {"none",      "planar",  "cylindrical", "conical",
                                                                    "spherical", "annular", "other"};

}  // namespace verisim

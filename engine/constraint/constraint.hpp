// A geometric constraint between an entity of body A and one of body B, with its data in the coordinates of each of the
// two bodies. A value of fixed size without heap memory: recognition returns it, the memo stores it.
//
// Source: dissertation chapters 7 and 8. In this folder the pair of bodies is (A, B): contacts are given in the
// coordinates of A, and forces act on B. Units: m, rad.
#pragma once

#include <array>
#include <cstdint>

#include "engine/base/pose.hpp"

namespace verisim {

/// A run file stores these numbers (`/state/link/A~B/constraint`).
enum class ConstraintKind : std::uint8_t { none, planar, cylindrical, conical, spherical, annular, other };

/// The pair of geometries that alignment compares.
enum class Pairing : std::uint8_t {
  axis_axis,    ///< two lines: angle between them, distance between them
  plane_plane,  ///< two planes that face each other
  point_point,  ///< two centres: distance; angles have no meaning
  point_axis,   ///< a ball's centre and the axis of a tube or cone: distance; no angle
  axis_plane,   ///< a line that should lie along a plane: angle out of the plane
  point_plane   ///< a ball on a plane: always aligned
};

/// The field of contact normals, by which restoration decomposes a force (restoration.hpp).
enum class NormalField : std::uint8_t {
  constant,     ///< one direction everywhere
  about_line,   ///< away from a line
  about_point,  ///< away from a point
  about_cone,   ///< normal to a cone: away from its axis, tilted by the half angle
  about_ring    ///< away from the nearest point of a circle (a torus's core)
};

enum class Side : std::uint8_t { a, b, neither };

[[nodiscard]] inline Side opposite(Side side) {
  if (side == Side::neither) return side;
  return side == Side::a ? Side::b : Side::a;
}

/// One body's half of a constraint, in that body's coordinates.
struct ConstraintSide {
  Vector3d point;      ///< of an axis or a plane: middle of its bounded part; of a ball: its centre
  Vector3d direction;  ///< unit: an axis, or a plane's normal out of the material
  double radius;       ///< of the curved shape at `point` (a torus: of its core circle); 0 for planes and lines
  double half_length;  ///< of the bounded part along `direction` (planes: of its shorter side)
  double detail;       ///< a cone's tangent of the half angle, a torus's tube radius; else 0
};

struct Constraint {
  ConstraintKind kind;
  // The members below are set only if kind is not `none`: most pairs give none, and they shall cost nothing.
  Pairing pairing;
  NormalField field;
  Side normal_source;  ///< the side whose data gives the field of normals; `neither`: two equal planes
  Side pin;            ///< the side that is inside the other
  bool unilateral;     ///< can push but not pull: a force of the wrong sense is an artefact too (eq. 8.9)
  double clearance;    ///< hole's radius minus pin's [m]; 0 where radii have no meaning
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
  m.normal_source = opposite(c.normal_source);
  m.pin = opposite(c.pin);
  return m;
}

inline constexpr std::array<const char*, 7> kConstraintKindNames = {"none",      "planar",  "cylindrical", "conical",
                                                                    "spherical", "annular", "other"};

}  // namespace verisim

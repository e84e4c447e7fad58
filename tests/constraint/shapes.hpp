// Entities by a line each, as recognizer tests need them: about z, in the middle of the coordinates unless moved.
#pragma once

#include "engine/constraint/entities.hpp"

namespace verisim::test {

inline Entity from_surface(const Surface& surface, double half_length) {
  Face face;
  face.surface = surface;
  face.u_range = face.v_range = {-half_length, half_length};
  return entity_of(face);
}

inline const Vector3d kX = Vector3d::UnitX(), kZ = Vector3d::UnitZ(), kOrigin = Vector3d::Zero();

inline Entity plane(const Vector3d& normal, const Vector3d& point = kOrigin, double half = 0.1) {
  return from_surface(Plane{point, normal, normal.unitOrthogonal()}, half);
}
inline Entity cylinder(double radius, bool hole, double half = 0.1, const Vector3d& point = kOrigin,
                       const Vector3d& direction = kZ) {
  return from_surface(Cylinder{point, direction, direction.unitOrthogonal(), radius, hole}, half);
}
inline Entity cone(double radius, double half_angle, bool hole, double half = 0.02) {
  return from_surface(Cone{kOrigin, kZ, kX, radius, half_angle, hole}, half);
}
inline Entity sphere(double radius, bool hole, const Vector3d& center = kOrigin) {
  return from_surface(Sphere{center, kZ, kX, radius, hole}, 1);
}
inline Entity torus(double major, double minor, bool hole) {
  return from_surface(Torus{kOrigin, kZ, kX, major, minor, hole}, 1);
}
inline Entity line(const Vector3d& direction, const Vector3d& point = kOrigin, double half = 0.1) {
  Edge edge;
  edge.curve = Line{point, direction};
  edge.t_range = {-half, half};
  return entity_of(edge, {});
}
inline Entity ellipse(double major, double minor) {
  Edge edge;
  edge.curve = Ellipse{kOrigin, kZ, kX, major, minor};
  edge.t_range = {0, 6.283185307179586};
  return entity_of(edge, {});
}
/// The rim of a hole, of a pin, or of nothing round.
inline Entity circle(double radius, Role role, const Vector3d& center = kOrigin) {
  Edge edge;
  edge.curve = Circle{center, kZ, kX, radius};
  edge.t_range = {0, 6.283185307179586};
  Face beside;
  beside.surface = Cylinder{center, kZ, kX, radius, role == Role::hole};
  if (role != Role::unknown) edge.faces = {0};
  return entity_of(edge, {&beside, 1});
}

}  // namespace verisim::test

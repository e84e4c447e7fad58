// Rounding of the kernel's numbers, whose last bits differ between CPUs (with and without fused multiply-add). No such
// bit reaches a state hash (loader.hpp states the rule).
#pragma once

#include <cmath>

#include "engine/base/pose.hpp"

namespace verisim::cad {

/// To a multiple of 2^-36 m (15 pm).
inline double round_coordinate(double metres) {
  return std::nearbyint(metres * 0x1p36) * 0x1p-36 + 0.0;
}

inline Vector3d round_point(const Vector3d& metres) {
  return {round_coordinate(metres.x()), round_coordinate(metres.y()), round_coordinate(metres.z())};
}

/// To 40 significant bits: lengths of radii, areas, volumes.
inline double round_number(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, 40)), exponent - 40) + 0.0;
}

/// To a multiple of 2^-40 rad.
inline double round_angle(double radians) {
  return std::nearbyint(radians * 0x1p40) * 0x1p-40 + 0.0;
}

/// Components to 2^-40, then unit again: square root and division give the same bits everywhere.
inline Vector3d round_direction(const Vector3d& unit) {
  return Vector3d(round_angle(unit.x()), round_angle(unit.y()), round_angle(unit.z())).normalized();
}

/// An x axis, made exactly normal to its (rounded) direction.
inline Vector3d round_x_axis(const Vector3d& unit, const Vector3d& direction) {
  const Vector3d rounded = round_direction(unit);
  return (rounded - direction.dot(rounded) * direction).normalized();
}

}  // namespace verisim::cad

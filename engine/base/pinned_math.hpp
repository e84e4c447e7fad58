// The elementary functions that enter the state of a simulation, from one pinned implementation.
//
// glibc's sin, cos, exp, pow … give different bits on CPUs with and without fused multiply-add; a state hash must not.
// These call SLEEF's deterministic scalar variants (within 1.0 ulp, no fused multiply-add, no run-time dispatch).
// sqrt is exactly rounded everywhere: use std::sqrt. Angles in rad.
#pragma once

namespace verisim::pinned {

[[nodiscard]] double sin(double x);
[[nodiscard]] double cos(double x);
[[nodiscard]] double tan(double x);
[[nodiscard]] double asin(double x);
[[nodiscard]] double acos(double x);
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double exp(double x);
[[nodiscard]] double log(double x);
[[nodiscard]] double pow(double x, double y);

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kFullTurn = 2 * kPi;

}  // namespace verisim::pinned

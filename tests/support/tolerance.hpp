// Tolerances of tests, in one place so that they can be taken away: VERISIM_TOL_SCALE=0 ctest -R oracles fails wherever
// a residual is not exactly zero and so prints every residual.
#pragma once

#include <cstdlib>

namespace verisim::test {

/// `t` times the environment's VERISIM_TOL_SCALE (1 if unset).
[[nodiscard]] inline double tolerance(double t) {
  const char* scale = std::getenv("VERISIM_TOL_SCALE");
  return scale == nullptr ? t : t * std::strtod(scale, nullptr);
}

}  // namespace verisim::test

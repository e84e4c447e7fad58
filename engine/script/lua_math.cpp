// Replacements of the C library's functions for Lua's archive (CMakeLists.txt): the same bits on every CPU.
#include <cmath>
#include <cstdint>

#include "engine/base/pinned_math.hpp"
#include "engine/script/work.hpp"

namespace {

namespace pinned = verisim::pinned;
using verisim::script::work;

constexpr std::uint64_t kCallWork = 10;  // some 50 to 100 ns, while the instruction `^` counts as one

// Below 1 the difference of two exponentials cancels; the Taylor series has converged after x^21/21! < 2e-20.
double sinh_small(double x) {
  double term = x;
  double sum = x;
  for (int n = 3; n <= 21; n += 2) {
    term *= x * x / (n * (n - 1));
    sum += term;
  }
  return sum;
}

double hyperbolic_sine(double x) {
  return std::abs(x) < 1 ? sinh_small(x) : 0.5 * (pinned::exp(x) - pinned::exp(-x));
}
double hyperbolic_cosine(double x) {
  return 0.5 * (pinned::exp(x) + pinned::exp(-x));
}

}  // namespace

extern "C" {

double verisim_lua_sin(double x) {
  work.used += kCallWork;
  return pinned::sin(x);
}
double verisim_lua_cos(double x) {
  work.used += kCallWork;
  return pinned::cos(x);
}
double verisim_lua_tan(double x) {
  work.used += kCallWork;
  return pinned::tan(x);
}
double verisim_lua_asin(double x) {
  work.used += kCallWork;
  return pinned::asin(x);
}
double verisim_lua_acos(double x) {
  work.used += kCallWork;
  return pinned::acos(x);
}
double verisim_lua_atan(double x) {
  work.used += kCallWork;
  return pinned::atan2(x, 1);
}
double verisim_lua_atan2(double y, double x) {
  work.used += kCallWork;
  return pinned::atan2(y, x);
}
double verisim_lua_exp(double x) {
  work.used += kCallWork;
  return pinned::exp(x);
}
double verisim_lua_log(double x) {
  work.used += kCallWork;
  return pinned::log(x);
}

double verisim_lua_log10(double x) {
  work.used += kCallWork;
  constexpr double kLog10OfE = 0.43429448190325182765;
  const double result = pinned::log(x) * kLog10OfE;
  const double whole = std::round(result);
  return std::abs(result - whole) < 1e-12 && pinned::pow(10, whole) == x ? whole : result;
}

double verisim_lua_pow(double x, double y) {
  work.used += kCallWork;
  return y == 2 ? x * x : pinned::pow(x, y);
}
double verisim_lua_sinh(double x) {
  work.used += kCallWork;
  return hyperbolic_sine(x);
}
double verisim_lua_cosh(double x) {
  work.used += kCallWork;
  return hyperbolic_cosine(x);
}

double verisim_lua_tanh(double x) {
  work.used += kCallWork;
  if (std::abs(x) > 20) return x > 0 ? 1 : -1;  // 1 - tanh(20) < 2^-53
  return hyperbolic_sine(x) / hyperbolic_cosine(x);
}

// glibc divides bit by bit: the more, the further apart the two numbers are.
double verisim_lua_fmod(double x, double y) {
  constexpr std::uint64_t kDivisionWork = 500;
  work.used += kDivisionWork;
  return std::fmod(x, y);
}

}  // extern "C"

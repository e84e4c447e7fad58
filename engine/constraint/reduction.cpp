#include "engine/constraint/reduction.hpp"

#include <algorithm>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

constexpr double kSameLine = 1e-6;    ///< m, and rad: files round to 1e-7
constexpr double kSquareLow = 3e-4;   ///< sin^2 of 1 degree: normals closer than this are one
constexpr double kSquareHigh = 3e-2;  ///< sin^2 of 10 degrees: normals farther apart than this are two
constexpr double kPerSquare = 1 / (kSquareHigh - kSquareLow);

bool same_line(const ConstraintSide& a, const ConstraintSide& b) {
  return a.direction.cross(b.direction).squaredNorm() < kSameLine * kSameLine &&
         (b.point - a.point).cross(a.direction).squaredNorm() < kSameLine * kSameLine;
}

bool is_convex(const ConstraintSide& plane, const ConstraintSide& round) {
  return (round.point - plane.point).dot(plane.direction) < 0;
}

/// One normal at one contact. Of any length: nothing below needs a root.
struct Held {
  Vector3d n;
  double n_squared;
  double alpha;
  bool pushes_only;
};

/// What is held along the way through the subsets: normals, each square to those before, and how much of each counts
/// (0 where it only repeats another) over its square.
struct Basis {
  std::array<Vector3d, kHoldingMax> m;
  std::array<double, kHoldingMax> scale;
};

/// Sum over all subsets of held[i], held[i + 1] … of weight x what is left of f when the span of the subset, and of the
/// `size` normals in the basis, is taken away. `rest` is what is left so far. The empty subset adds nothing. The
/// recursion is unrolled by the compiler: numbers of constraints are template arguments.
template <std::size_t i, std::size_t size, std::size_t count>
inline Vector3d free_part(const std::array<Held, count>& held, Basis& basis, const Vector3d& rest, double weight) {
  if constexpr (i == count) {
    if constexpr (size == 0) return Vector3d::Zero();
    return weight * rest;
  } else {
    const Held& h = held[i];
    Vector3d total = Vector3d::Zero();
    if (h.alpha < 1) total = free_part<i + 1, size>(held, basis, rest, weight * (1 - h.alpha));
    Vector3d m = h.n;
    for (std::size_t k = 0; k < size; ++k) m -= basis.scale[k] * m.dot(basis.m[k]) * basis.m[k];
    const double square = m.squaredNorm();
    const double share = square / h.n_squared;  // sin^2 of the angle between n and what is held already
    const double own = std::clamp((share - kSquareLow) * kPerSquare, 0.0, 1.0);
    basis.m[size] = m;
    basis.scale[size] = own > 0 ? own / square : 0;
    Vector3d left = rest;
    const double along = rest.dot(m);
    if (!h.pushes_only || along < 0) left -= basis.scale[size] * along * m;
    return total + free_part<i + 1, size + 1>(held, basis, left, weight * h.alpha);
  }
}

/// One constraint that has a normal at x, or none.
bool hold(const ActiveConstraint& c, double alpha, const Vector3d& x, Held& held) {
  const Vector3d n = normal_at(c, x);
  const double square = n.squaredNorm();
  if (square == 0) return false;
  held = {n, square, alpha, c.pushes_only};
  return true;
}

template <std::size_t count>
Vector3d restore_held(const std::array<Held, kHoldingMax>& all, const Vector3d& f) {
  std::array<Held, count> held;
  std::copy_n(all.begin(), count, held.begin());
  Basis basis;
  return f - free_part<0, 0>(held, basis, f, 1.0);
}

}  // namespace

bool same_axes(const Constraint& a, const Constraint& b) {
  if (a.kind != b.kind || a.pairing != Pairing::axis_axis || b.pairing != Pairing::axis_axis) return false;
  return a.field == NormalField::about_line && b.field == a.field && a.pin == b.pin && same_line(a.a, b.a) &&
         same_line(a.b, b.b);
}

bool hands_over(const Constraint& planar, const Constraint& round) {
  if (planar.kind != ConstraintKind::planar) return false;
  if (round.field != NormalField::about_line && round.field != NormalField::about_cone) return false;
  return is_convex(planar.a, round.a) && is_convex(planar.b, round.b);
}

Vector3d restore_common(std::span<const ActiveConstraint* const> holding, std::span<const double> alpha,
                        const Vector3d& x, const Vector3d& f) {
  VERISIM_ASSERT(holding.size() <= kHoldingMax);
  VERISIM_ASSERT(holding.size() == alpha.size());
  std::array<Held, kHoldingMax> held;
  std::size_t n = 0;
  for (std::size_t i = 0; i < holding.size(); ++i) n += hold(*holding[i], alpha[i], x, held[n]) ? 1U : 0U;
  switch (n) {
    case 0:
      return f;
    case 1:
      return restore_held<1>(held, f);
    case 2:
      return restore_held<2>(held, f);
    default:
      return restore_held<3>(held, f);
  }
}

}  // namespace verisim

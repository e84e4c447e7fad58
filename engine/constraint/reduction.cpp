#include "engine/constraint/reduction.hpp"

#include <algorithm>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

constexpr double kSameLine = 1e-6;    ///< m, and rad: files round to 1e-7
constexpr double kSquareLow = 3e-4;   ///< sin^2 of 1 degree: closer normals count as one
constexpr double kSquareHigh = 3e-2;  ///< sin^2 of 10 degrees: farther normals count as two
constexpr double kPerSquare = 1 / (kSquareHigh - kSquareLow);

bool same_line(const ConstraintSide& a, const ConstraintSide& b) {
  return a.direction.cross(b.direction).squaredNorm() < kSameLine * kSameLine &&
         (b.point - a.point).cross(a.direction).squaredNorm() < kSameLine * kSameLine;
}

bool is_convex(const ConstraintSide& plane, const ConstraintSide& round) {
  return (round.point - plane.point).dot(plane.direction) < 0;
}

/// The normal of one constraint at one contact, of any length: no square root is needed.
struct ActiveNormal {
  Vector3d n;
  double n_squared;
  double alpha;
  bool unilateral;
};

/// Orthogonal basis of the normals of one subset. `scale`: how much a vector counts (0 if it repeats the others), over
/// its squared length.
struct Basis {
  std::array<Vector3d, kActiveMax> m;
  std::array<double, kActiveMax> scale;
};

/// Sum over all subsets of normals[i], normals[i + 1] … of weight x the part of f outside the span of the subset and of
/// the basis. The empty subset adds nothing. The compiler unrolls the recursion: numbers of constraints are template
/// arguments.
/// @param size  vectors in the basis
/// @param rest  part of f outside the span of the basis
template <std::size_t i, std::size_t size, std::size_t count>
inline Vector3d free_part(const std::array<ActiveNormal, count>& normals, Basis& basis, const Vector3d& rest,
                          double weight) {
  if constexpr (i == count) {
    if constexpr (size == 0) return Vector3d::Zero();
    return weight * rest;
  } else {
    const ActiveNormal& h = normals[i];
    Vector3d total = Vector3d::Zero();
    if (h.alpha < 1) total = free_part<i + 1, size>(normals, basis, rest, weight * (1 - h.alpha));
    Vector3d m = h.n;
    for (std::size_t k = 0; k < size; ++k) m -= basis.scale[k] * m.dot(basis.m[k]) * basis.m[k];
    const double square = m.squaredNorm();
    const double sine_squared = square / h.n_squared;  // of the angle between n and the span of the basis
    const double independence = std::clamp((sine_squared - kSquareLow) * kPerSquare, 0.0, 1.0);
    basis.m[size] = m;
    basis.scale[size] = independence > 0 ? independence / square : 0;
    Vector3d left = rest;
    // A wall thinner than a voxel has two faces there that push opposite ways. The first left what it does not push.
    const Vector3d repeated = h.n - m;
    const double opposed = rest.dot(repeated);
    if (h.unilateral && opposed < 0) left -= (1 - independence) * opposed / repeated.squaredNorm() * repeated;
    const double along = rest.dot(m);
    if (!h.unilateral || along < 0) left -= basis.scale[size] * along * m;
    return total + free_part<i + 1, size + 1>(normals, basis, left, weight * h.alpha);
  }
}

/// Sets the normal of a constraint at x. False if there is none.
bool has_normal(const ActiveConstraint& c, double alpha, const Vector3d& x, ActiveNormal& normals) {
  const Vector3d n = normal_at(c, x);
  const double square = n.squaredNorm();
  if (square == 0) return false;
  normals = {n, square, alpha, c.unilateral};
  return true;
}

template <std::size_t count>
Vector3d restore_active(const std::array<ActiveNormal, kActiveMax>& all, const Vector3d& f) {
  std::array<ActiveNormal, count> normals;
  std::copy_n(all.begin(), count, normals.begin());
  Basis basis;
  return f - free_part<0, 0>(normals, basis, f, 1.0);
}

}  // namespace

bool same_axes(const Constraint& a, const Constraint& b) {
  if (a.kind != b.kind || a.pairing != Pairing::axis_axis || b.pairing != Pairing::axis_axis) return false;
  return a.field == NormalField::about_line && b.field == a.field && a.pin == b.pin && same_line(a.a, b.a) &&
         same_line(a.b, b.b);
}

bool is_gated_by(const Constraint& planar, const Constraint& round) {
  if (planar.kind != ConstraintKind::planar) return false;
  if (round.field != NormalField::about_line && round.field != NormalField::about_cone) return false;
  return is_convex(planar.a, round.a) && is_convex(planar.b, round.b);
}

Vector3d restore_common(std::span<const ActiveConstraint* const> active, std::span<const double> alpha,
                        const Vector3d& x, const Vector3d& f) {
  VERISIM_ASSERT(active.size() <= kActiveMax);
  VERISIM_ASSERT(active.size() == alpha.size());
  std::array<ActiveNormal, kActiveMax> normals;
  std::size_t n = 0;
  for (std::size_t i = 0; i < active.size(); ++i) n += has_normal(*active[i], alpha[i], x, normals[n]) ? 1U : 0U;
  switch (n) {
    case 0:
      return f;
    case 1:
      return restore_active<1>(normals, f);
    case 2:
      return restore_active<2>(normals, f);
    default:
      return restore_active<3>(normals, f);
  }
}

}  // namespace verisim

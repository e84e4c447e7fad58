#include "engine/constraint/reduction.hpp"

#include <algorithm>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

constexpr double kSameLine = 1e-6;    ///< m, and rad: files round to 1e-7
constexpr double kSquareLow = 3e-4;   ///< sin^2 of 1 degree: normals closer than this are one
constexpr double kSquareHigh = 3e-2;  ///< sin^2 of 10 degrees: normals farther apart than this are two

bool same_line(const ConstraintSide& a, const ConstraintSide& b) {
  return a.direction.cross(b.direction).squaredNorm() < kSameLine * kSameLine &&
         (b.point - a.point).cross(a.direction).squaredNorm() < kSameLine * kSameLine;
}

bool is_convex(const ConstraintSide& plane, const ConstraintSide& round) {
  return (round.point - plane.point).dot(plane.direction) < 0;
}

/// One normal at one contact, prepared: orthogonal parts are taken of it below.
struct Held {
  Vector3d n;  ///< unit
  double alpha;
  bool pushes_only;
};

/// Sum over all subsets of held[i], held[i + 1] … of weight x what the span of the subset, together with `basis`,
/// leaves of f. `rest` is what is left so far; `changed`: the subset is not empty.
class FreePart {
 public:
  FreePart(std::span<const Held> held) : held_(held) {}
  Vector3d expect(std::size_t i, std::size_t basis, const Vector3d& rest, double weight) {
    if (weight == 0) return Vector3d::Zero();
    if (i == held_.size()) {
      if (!any_) return Vector3d::Zero();
      return weight * rest;
    }
    const Held& h = held_[i];
    Vector3d total = expect(i + 1, basis, rest, weight * (1 - h.alpha));
    Vector3d m = h.n;
    for (std::size_t k = 0; k < basis; ++k) m -= own_[k] * m.dot(basis_[k]) * basis_[k];
    const double square = m.squaredNorm();  // sin^2 of the angle between n and what is held already
    const double own = std::clamp((square - kSquareLow) / (kSquareHigh - kSquareLow), 0.0, 1.0);
    Vector3d left = rest;
    std::size_t basis_with = basis;
    if (own > 0) {
      m /= std::sqrt(square);
      const double along = rest.dot(m);
      if (!h.pushes_only || along < 0) left -= own * along * m;
      own_[basis_with] = own;
      basis_[basis_with++] = m;
    }
    const bool before = any_;
    any_ = true;
    total += expect(i + 1, basis_with, left, weight * h.alpha);
    any_ = before;
    return total;
  }

 private:
  std::span<const Held> held_;
  std::array<Vector3d, kHoldingMax> basis_;   ///< orthogonal, unit
  std::array<double, kHoldingMax> own_ = {};  ///< how much of each counts: 0 where it only repeats another
  bool any_ = false;
};

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
  std::array<Held, kHoldingMax> held;
  std::size_t n = 0;
  for (std::size_t i = 0; i < holding.size(); ++i) {
    const Vector3d normal = normal_at(*holding[i], x);
    const double length = normal.norm();
    if (length > 0) held[n++] = {normal / length, alpha[i], holding[i]->pushes_only};
  }
  return f - FreePart({held.data(), n}).expect(0, 0, f, 1);
}

}  // namespace verisim

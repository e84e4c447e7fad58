// Contacts are taken eight at a time; contact i belongs to strand i % 8, whatever the vector width, and a vector of N
// doubles works on N neighbouring strands. The last eight are filled up with contacts of no normal and no force.
#include "engine/contact/penalty.hpp"

#include <array>

#include "engine/base/error.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/contact/penalty.cpp"
#include "hwy/foreach_target.h"  // compiles this file once per target
#include "hwy/highway.h"

#ifndef VERISIM_CONTACT_PENALTY_TYPES
#define VERISIM_CONTACT_PENALTY_TYPES
namespace verisim {
inline constexpr std::size_t kStrands = 8;
static_assert(kStrands <= ContactList::kPadding);
using Strands = std::array<double, kStrands>;
using MatrixStrands = std::array<Strands, 21>;  ///< upper triangle of W, row by row
struct SumStrands {
  std::array<Strands, 6> wrench;
  Strands depth;
};
struct PenaltyLaw {
  Vector3d about;
  Twist velocity;
  double stiffness, damping;
};
struct PushingStrands {
  SumStrands sum;
  MatrixStrands matrix;
};
}  // namespace verisim
#endif

HWY_BEFORE_NAMESPACE();
namespace verisim::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kStrands>;
using Floats = hn::Rebind<float, Doubles>;
using V = hn::Vec<Doubles>;
constexpr Doubles kD;
constexpr Floats kF;
constexpr std::size_t kLanes = hn::MaxLanes(kD);

struct Triple {
  V x, y, z;
};

HWY_INLINE V load(const std::vector<float>& column, std::size_t i) {
  return hn::PromoteTo(kD, hn::LoadU(kF, column.data() + i));
}

HWY_INLINE Triple broadcast(const Vector3d& v) {
  return {hn::Set(kD, v.x()), hn::Set(kD, v.y()), hn::Set(kD, v.z())};
}

HWY_INLINE Triple arm(const ContactList& c, std::size_t i, const Triple& about) {
  return {hn::Sub(load(c.x, i), about.x), hn::Sub(load(c.y, i), about.y), hn::Sub(load(c.z, i), about.z)};
}

HWY_INLINE Triple cross(const Triple& a, const Triple& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE Triple normal(const ContactList& c, std::size_t i) {
  return {load(c.nx, i), load(c.ny, i), load(c.nz, i)};
}

/// Lanes of contacts i, i + 1, … that exist; the columns' padding makes the loads beyond the end harmless.
HWY_INLINE hn::Mask<Doubles> existing(const ContactList& c, std::size_t i) {
  return hn::FirstN(kD, i < c.size ? c.size - i : 0);
}

/// The upper triangle of J J^T, added to `sums`.
HWY_INLINE void add_square(const Triple& n, const Triple& turn, V* sums) {
  const V J[6] = {n.x, n.y, n.z, turn.x, turn.y, turn.z};
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column, ++sums) *sums = hn::Add(*sums, hn::Mul(J[row], J[column]));
  }
}

HWY_INLINE Triple only(const hn::Mask<Doubles>& mask, const Triple& v) {
  return {hn::IfThenElseZero(mask, v.x), hn::IfThenElseZero(mask, v.y), hn::IfThenElseZero(mask, v.z)};
}

void matrix_strands(const ContactList& c, const Vector3d& about_A, MatrixStrands& out) {
  const Triple about = broadcast(about_A);
  for (std::size_t strand = 0; strand < kStrands; strand += kLanes) {
    V sums[21];
    for (V& s : sums) s = hn::Zero(kD);
    for (std::size_t i = strand; i < c.size + strand; i += kStrands) {
      const Triple n = only(existing(c, i), normal(c, i));
      add_square(n, cross(arm(c, i, about), n), sums);
    }
    for (std::size_t k = 0; k < out.size(); ++k) hn::StoreU(sums[k], kD, out[k].data() + strand);
  }
}

/// The penalty law with its numbers in all lanes.
struct Penalty {
  Triple about, linear, angular;
  V k, b;

  HWY_INLINE explicit Penalty(const PenaltyLaw& law)
      : about(broadcast(law.about)),
        linear(broadcast(law.velocity.linear)),
        angular(broadcast(law.velocity.angular)),
        k(hn::Set(kD, law.stiffness)),
        b(hn::Set(kD, law.damping)) {}

  /// N, along n, at `arm`; not above 0 where it would pull.
  HWY_INLINE V wanted(const ContactList& c, std::size_t i, const Triple& n, const Triple& arm) const {
    const Triple turning = cross(angular, arm);
    const V along_x = hn::Mul(hn::Add(linear.x, turning.x), n.x);
    const V along_y = hn::Mul(hn::Add(linear.y, turning.y), n.y);
    const V along_z = hn::Mul(hn::Add(linear.z, turning.z), n.z);
    const V leaving = hn::Add(hn::Add(along_x, along_y), along_z);
    return hn::Sub(hn::Mul(k, load(c.depth, i)), hn::Mul(b, leaving));
  }
};

HWY_INLINE Triple times(const V& s, const Triple& v) {
  return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}

void penalty_columns(ContactList& c, const PenaltyLaw& law) {
  const Penalty penalty(law);
  for (std::size_t i = 0; i < c.size; i += kLanes) {
    const Triple n = normal(c, i);
    const V wanted = penalty.wanted(c, i, n, arm(c, i, penalty.about));
    const Triple f = times(hn::IfThenElseZero(hn::Gt(wanted, hn::Zero(kD)), wanted), n);  // it pushes, it never pulls
    hn::StoreU(hn::DemoteTo(kF, f.x), kF, c.fx.data() + i);
    hn::StoreU(hn::DemoteTo(kF, f.y), kF, c.fy.data() + i);
    hn::StoreU(hn::DemoteTo(kF, f.z), kF, c.fz.data() + i);
  }
}

/// Sums of a strand: of forces, of their torques, and the deepest depth.
struct Sums {
  Triple force, torque;
  V deepest;

  HWY_INLINE Sums() : force(broadcast(Vector3d::Zero())), torque(force), deepest(hn::Zero(kD)) {}
  HWY_INLINE void add(const Triple& f, const Triple& arm, const V& depth) {
    const Triple t = cross(arm, f);
    force = {hn::Add(force.x, f.x), hn::Add(force.y, f.y), hn::Add(force.z, f.z)};
    torque = {hn::Add(torque.x, t.x), hn::Add(torque.y, t.y), hn::Add(torque.z, t.z)};
    deepest = hn::Max(deepest, depth);
  }
  HWY_INLINE void store(std::size_t strand, SumStrands& out) const {
    const V sums[6] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (std::size_t k = 0; k < 6; ++k) hn::StoreU(sums[k], kD, out.wrench[k].data() + strand);
    hn::StoreU(deepest, kD, out.depth.data() + strand);
  }
};

void sum_strands(const ContactList& c, const Vector3d& about_A, SumStrands& out) {
  const Triple about = broadcast(about_A);
  for (std::size_t strand = 0; strand < kStrands; strand += kLanes) {
    Sums sums;
    for (std::size_t i = strand; i < c.size + strand; i += kStrands) {
      const auto real = existing(c, i);
      const Triple f = {load(c.fx, i), load(c.fy, i), load(c.fz, i)};
      sums.add(only(real, f), arm(c, i, about), hn::IfThenElseZero(real, load(c.depth, i)));
    }
    sums.store(strand, out);
  }
}

void pushing_strands(const ContactList& c, const PenaltyLaw& law, PushingStrands& out) {
  const Penalty penalty(law);
  for (std::size_t strand = 0; strand < kStrands; strand += kLanes) {
    Sums sums;
    V square[21];
    for (V& s : square) s = hn::Zero(kD);
    for (std::size_t i = strand; i < c.size + strand; i += kStrands) {
      const auto real = existing(c, i);
      const Triple r = arm(c, i, penalty.about);
      Triple n = normal(c, i);
      const V wanted = penalty.wanted(c, i, n, r);
      n = only(hn::And(real, hn::Gt(wanted, hn::Zero(kD))), n);
      sums.add(times(wanted, n), r, hn::IfThenElseZero(real, load(c.depth, i)));
      add_square(n, cross(r, n), square);
    }
    sums.store(strand, out.sum);
    for (std::size_t k = 0; k < out.matrix.size(); ++k) hn::StoreU(square[k], kD, out.matrix[k].data() + strand);
  }
}

}  // namespace verisim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim {
namespace {

HWY_EXPORT(matrix_strands);
HWY_EXPORT(penalty_columns);
HWY_EXPORT(sum_strands);
HWY_EXPORT(pushing_strands);

/// The strands' sum, always in this order.
double tree(const Strands& s) {
  return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
}

ContactSum sum_of(const SumStrands& s) {
  ContactSum result;
  result.wrench.force = {tree(s.wrench[0]), tree(s.wrench[1]), tree(s.wrench[2])};
  result.wrench.torque = {tree(s.wrench[3]), tree(s.wrench[4]), tree(s.wrench[5])};
  for (const double depth : s.depth) result.depth_max = depth > result.depth_max ? depth : result.depth_max;
  return result;
}

Matrix6d matrix_of(const MatrixStrands& strands) {
  Matrix6d W;
  std::size_t k = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) W(row, column) = W(column, row) = tree(strands[k++]);
  }
  return W;
}

}  // namespace

Matrix6d contact_matrix(const ContactList& contacts, const Vector3d& about) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  MatrixStrands strands;
  HWY_DYNAMIC_DISPATCH(matrix_strands)(contacts, about, strands);
  return matrix_of(strands);
}

void apply_penalty(ContactList& contacts, const Vector3d& about, const Twist& velocity, double stiffness,
                   double damping) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  VERISIM_ASSERT(stiffness >= 0);
  VERISIM_ASSERT(damping >= 0);
  HWY_DYNAMIC_DISPATCH(penalty_columns)(contacts, {about, velocity, stiffness, damping});
}

ContactSum sum(const ContactList& contacts, const Vector3d& about) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  SumStrands s;
  HWY_DYNAMIC_DISPATCH(sum_strands)(contacts, about, s);
  return sum_of(s);
}

Pushing pushing(const ContactList& contacts, const Vector3d& about, const Twist& velocity, double stiffness,
                double damping) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  VERISIM_ASSERT(stiffness >= 0);
  VERISIM_ASSERT(damping >= 0);
  PushingStrands strands;
  HWY_DYNAMIC_DISPATCH(pushing_strands)(contacts, {about, velocity, stiffness, damping}, strands);
  return {sum_of(strands.sum), matrix_of(strands.matrix)};
}

}  // namespace verisim
#endif

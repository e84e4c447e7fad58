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

/// Lanes of contacts i, i + 1, … that exist; the columns' padding makes the loads beyond the end harmless.
HWY_INLINE hn::Mask<Doubles> existing(const ContactList& c, std::size_t i) {
  return hn::FirstN(kD, i < c.size ? c.size - i : 0);
}

void matrix_strands(const ContactList& c, const Vector3d& about_A, MatrixStrands& out) {
  const Triple about = broadcast(about_A);
  for (std::size_t strand = 0; strand < kStrands; strand += kLanes) {
    V sums[21];
    for (V& s : sums) s = hn::Zero(kD);
    for (std::size_t i = strand; i < c.size + strand; i += kStrands) {
      const auto real = existing(c, i);
      const Triple n = {hn::IfThenElseZero(real, load(c.nx, i)), hn::IfThenElseZero(real, load(c.ny, i)),
                        hn::IfThenElseZero(real, load(c.nz, i))};
      const Triple turn = cross(arm(c, i, about), n);
      const V J[6] = {n.x, n.y, n.z, turn.x, turn.y, turn.z};
      V* s = sums;
      for (int row = 0; row < 6; ++row) {
        for (int column = row; column < 6; ++column, ++s) *s = hn::Add(*s, hn::Mul(J[row], J[column]));
      }
    }
    for (std::size_t k = 0; k < out.size(); ++k) hn::StoreU(sums[k], kD, out[k].data() + strand);
  }
}

/// The penalty law with its numbers in all lanes.
struct Penalty {
  Triple about, linear, angular;
  V k, b;

  explicit Penalty(const PenaltyLaw& law)
      : about(broadcast(law.about)),
        linear(broadcast(law.velocity.linear)),
        angular(broadcast(law.velocity.angular)),
        k(hn::Set(kD, law.stiffness)),
        b(hn::Set(kD, law.damping)) {}

  HWY_INLINE Triple force(const ContactList& c, std::size_t i) const {
    const Triple n = {load(c.nx, i), load(c.ny, i), load(c.nz, i)};
    const Triple turning = cross(angular, arm(c, i, about));
    const V along_x = hn::Mul(hn::Add(linear.x, turning.x), n.x);
    const V along_y = hn::Mul(hn::Add(linear.y, turning.y), n.y);
    const V along_z = hn::Mul(hn::Add(linear.z, turning.z), n.z);
    const V leaving = hn::Add(hn::Add(along_x, along_y), along_z);
    const V wanted = hn::Sub(hn::Mul(k, load(c.depth, i)), hn::Mul(b, leaving));
    const V strength = hn::IfThenElseZero(hn::Gt(wanted, hn::Zero(kD)), wanted);  // a surface pushes, it never pulls
    return {hn::Mul(strength, n.x), hn::Mul(strength, n.y), hn::Mul(strength, n.z)};
  }
};

void penalty_columns(ContactList& c, const PenaltyLaw& law) {
  const Penalty penalty(law);
  for (std::size_t i = 0; i < c.size; i += kLanes) {
    const Triple f = penalty.force(c, i);
    hn::StoreU(hn::DemoteTo(kF, f.x), kF, c.fx.data() + i);
    hn::StoreU(hn::DemoteTo(kF, f.y), kF, c.fy.data() + i);
    hn::StoreU(hn::DemoteTo(kF, f.z), kF, c.fz.data() + i);
  }
}

/// Sums what `force_at` says of each contact.
template <class ForceAt>
HWY_INLINE void sum_forces(const ContactList& c, const Vector3d& about_A, const ForceAt& force_at, SumStrands& out) {
  const Triple about = broadcast(about_A);
  for (std::size_t strand = 0; strand < kStrands; strand += kLanes) {
    Triple force = broadcast(Vector3d::Zero());
    Triple torque = force;
    V deepest = hn::Zero(kD);
    for (std::size_t i = strand; i < c.size + strand; i += kStrands) {
      const auto real = existing(c, i);
      const Triple any = force_at(i);
      const Triple f = {hn::IfThenElseZero(real, any.x), hn::IfThenElseZero(real, any.y),
                        hn::IfThenElseZero(real, any.z)};
      const Triple t = cross(arm(c, i, about), f);
      force = {hn::Add(force.x, f.x), hn::Add(force.y, f.y), hn::Add(force.z, f.z)};
      torque = {hn::Add(torque.x, t.x), hn::Add(torque.y, t.y), hn::Add(torque.z, t.z)};
      deepest = hn::Max(deepest, hn::IfThenElseZero(real, load(c.depth, i)));
    }
    const V sums[6] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (std::size_t k = 0; k < 6; ++k) hn::StoreU(sums[k], kD, out.wrench[k].data() + strand);
    hn::StoreU(deepest, kD, out.depth.data() + strand);
  }
}

void sum_strands(const ContactList& c, const Vector3d& about, SumStrands& out) {
  sum_forces(
      c, about,
      [&](std::size_t i) {
        return Triple{load(c.fx, i), load(c.fy, i), load(c.fz, i)};
      },
      out);
}

void penalty_strands(const ContactList& c, const PenaltyLaw& law, SumStrands& out) {
  const Penalty penalty(law);
  sum_forces(
      c, law.about, [&](std::size_t i) { return penalty.force(c, i); }, out);
}

}  // namespace verisim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim {
namespace {

HWY_EXPORT(matrix_strands);
HWY_EXPORT(penalty_columns);
HWY_EXPORT(sum_strands);
HWY_EXPORT(penalty_strands);

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

}  // namespace

Matrix6d contact_matrix(const ContactList& contacts, const Vector3d& about) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  MatrixStrands strands;
  HWY_DYNAMIC_DISPATCH(matrix_strands)(contacts, about, strands);
  Matrix6d W;
  std::size_t k = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) W(row, column) = W(column, row) = tree(strands[k++]);
  }
  return W;
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

ContactSum penalty_sum(const ContactList& contacts, const Vector3d& about, const Twist& velocity, double stiffness,
                       double damping) {
  VERISIM_ASSERT(contacts.size <= contacts.capacity());
  VERISIM_ASSERT(stiffness >= 0);
  VERISIM_ASSERT(damping >= 0);
  SumStrands s;
  HWY_DYNAMIC_DISPATCH(penalty_strands)(contacts, {about, velocity, stiffness, damping}, s);
  return sum_of(s);
}

}  // namespace verisim
#endif

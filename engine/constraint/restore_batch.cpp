#include "engine/constraint/restore_batch.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/constraint/restore_batch.cpp"
#include "hwy/foreach_target.h"  // compiles this file once per target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace verisim::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Three {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Three<D> load(D d, const float* x, const float* y, const float* z) {
  const hn::Rebind<float, D> floats;
  return {hn::PromoteTo(d, hn::LoadU(floats, x)), hn::PromoteTo(d, hn::LoadU(floats, y)),
          hn::PromoteTo(d, hn::LoadU(floats, z))};
}

template <class D>
HWY_INLINE Three<D> broadcast(D d, const Vector3d& v) {
  return {hn::Set(d, v.x()), hn::Set(d, v.y()), hn::Set(d, v.z())};
}

template <class D>
HWY_INLINE hn::Vec<D> dot(D /*d*/, const Three<D>& a, const Three<D>& b) {
  return hn::Add(hn::Mul(a.x, b.x), hn::Add(hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)));  // as Eigen sums three
}

/// normal_at() for fields that need no square root.
template <NormalField field, class D>
HWY_INLINE Three<D> normals(D d, const ActiveConstraint& c, const Three<D>& p) {
  if constexpr (field == NormalField::constant) return broadcast(d, c.direction);
  const Three<D> point = broadcast(d, c.point);
  const Three<D> q = {hn::Sub(p.x, point.x), hn::Sub(p.y, point.y), hn::Sub(p.z, point.z)};
  if constexpr (field == NormalField::about_point) return q;
  const Three<D> v = broadcast(d, c.direction);
  const hn::Vec<D> height = dot(d, v, q);
  return {hn::Sub(q.x, hn::Mul(height, v.x)), hn::Sub(q.y, hn::Mul(height, v.y)), hn::Sub(q.z, hn::Mul(height, v.z))};
}

/// Restores whole vectors from contact i on. @returns the first contact that remains
template <NormalField field, bool unilateral, class D>
HWY_INLINE std::uint32_t restore_vectors(D d, const ContactBatch& batch, std::uint32_t i, const ActiveConstraint& c) {
  const hn::Rebind<float, D> floats;
  constexpr auto kLanes = static_cast<std::uint32_t>(hn::MaxLanes(d));
  const hn::Vec<D> zero = hn::Zero(d);
  const hn::Vec<D> one = hn::Set(d, 1.0);
  const hn::Vec<D> alpha = hn::Set(d, c.alpha);
  for (; i + kLanes <= batch.count; i += kLanes) {
    const Three<D> n = normals<field>(d, c, load(d, batch.x + i, batch.y + i, batch.z + i));
    const Three<D> f = load(d, batch.fx + i, batch.fy + i, batch.fz + i);
    const hn::Vec<D> n_squared = dot(d, n, n);
    const hn::Vec<D> along = dot(d, f, n);
    const auto has_none = hn::Eq(n_squared, zero);
    hn::Vec<D> part = hn::Mul(alpha, hn::Div(along, hn::IfThenElse(has_none, one, n_squared)));
    if constexpr (unilateral) part = hn::IfThenElse(hn::Ge(along, zero), zero, part);
    const hn::Vec<D> kept = hn::IfThenElse(has_none, one, hn::Sub(one, alpha));
    const auto store = [&](const hn::Vec<D>& force, const hn::Vec<D>& normal, float* to) {
      hn::StoreU(hn::DemoteTo(floats, hn::Add(hn::Mul(kept, force), hn::Mul(part, normal))), floats, to);
    };
    store(f.x, n.x, batch.fx + i);
    store(f.y, n.y, batch.fy + i);
    store(f.z, n.z, batch.fz + i);
  }
  return i;
}

template <NormalField field, bool unilateral>
void restore_field(const ContactBatch& batch, const ActiveConstraint& c) {
  std::uint32_t i = restore_vectors<field, unilateral>(hn::CappedTag<double, 8>(), batch, 0, c);
  i = restore_vectors<field, unilateral>(hn::CappedTag<double, 2>(), batch, i, c);
  (void)restore_vectors<field, unilateral>(hn::CappedTag<double, 1>(), batch, i, c);
}

void restore_without_roots(const ContactBatch& batch, const ActiveConstraint& c) {
  const auto by_sense = [&]<NormalField field>() {
    return c.unilateral ? restore_field<field, true>(batch, c) : restore_field<field, false>(batch, c);
  };
  if (c.field == NormalField::constant) return by_sense.template operator()<NormalField::constant>();
  if (c.field == NormalField::about_line) return by_sense.template operator()<NormalField::about_line>();
  return by_sense.template operator()<NormalField::about_point>();
}

}  // namespace verisim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim {
namespace {
HWY_EXPORT(restore_without_roots);
}  // namespace

void restore_batch(const ContactBatch& batch, const ActiveConstraint& active) {
  VERISIM_ASSERT(batch.count == 0 || (batch.x != nullptr && batch.y != nullptr && batch.z != nullptr));
  VERISIM_ASSERT(batch.count == 0 || (batch.fx != nullptr && batch.fy != nullptr && batch.fz != nullptr));
  VERISIM_ASSERT(is_fraction(active.alpha));
  if (active.field != NormalField::about_cone && active.field != NormalField::about_ring) {
    HWY_DYNAMIC_DISPATCH(restore_without_roots)(batch, active);
    return;
  }
  for (std::uint32_t i = 0; i < batch.count; ++i) {
    const Vector3d f = restore(active, {batch.x[i], batch.y[i], batch.z[i]}, {batch.fx[i], batch.fy[i], batch.fz[i]});
    batch.fx[i] = static_cast<float>(f.x());
    batch.fy[i] = static_cast<float>(f.y());
    batch.fz[i] = static_cast<float>(f.z());
  }
}

}  // namespace verisim
#endif

#include "engine/constraint/constraint_link.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/lanes.hpp"

namespace verisim {
namespace {

constexpr double kAlphaLeast = 1e-9;  ///< below, a constraint changes no bit of a force in float

Vector3d point_of(const ContactColumns& c, std::uint32_t i) {
  return c.origin + Vector3d(c.x[i], c.y[i], c.z[i]);
}
Vector3d force_of(const ContactColumns& c, std::uint32_t i) {
  return Vector3d(c.fx[i], c.fy[i], c.fz[i]);
}
void set_force(const ContactColumns& c, std::uint32_t i, const Vector3d& f) {
  c.fx[i] = static_cast<float>(f.x());
  c.fy[i] = static_cast<float>(f.y());
  c.fz[i] = static_cast<float>(f.z());
}

struct Run {
  std::uint32_t begin, end;
};

/// Vectors of two contacts, component by component.
struct Two {
  Double2 x, y, z;
};
Double2 dot(const Two& a, const Two& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);  // as Eigen sums three
}
Two both(const Vector3d& v) {
  return {Double2{v.x(), v.x()}, Double2{v.y(), v.y()}, Double2{v.z(), v.z()}};
}

/// normal_at() of two contacts. Only for fields that need no square root.
template <NormalField field>
Two normals_at(const ActiveConstraint& c, const Two& p) {
  if constexpr (field == NormalField::constant) return both(c.direction);
  const Two point = both(c.point);
  const Two q = {p.x - point.x, p.y - point.y, p.z - point.z};
  if constexpr (field == NormalField::about_point) return q;
  const Two v = both(c.direction);
  const Double2 height = dot(v, q);
  return {q.x - height * v.x, q.y - height * v.y, q.z - height * v.z};
}

/// restore() of contacts i and i + 1.
template <NormalField field, bool pushes_only>
void restore_two(const ContactColumns& c, std::uint32_t i, const ActiveConstraint& active) {
  const Two n = normals_at<field>(active, {load2(c.x + i), load2(c.y + i), load2(c.z + i)});
  const Two f = {load2(c.fx + i), load2(c.fy + i), load2(c.fz + i)};
  const Double2 zero = {0, 0};
  const Double2 one = {1, 1};
  const Double2 n_squared = dot(n, n);
  const Double2 f_along = dot(f, n);
  const auto has_none = n_squared == zero;
  Double2 part = active.alpha * (f_along / (has_none ? one : n_squared));
  const Double2 kept = has_none ? one : one - active.alpha;
  if constexpr (pushes_only) part = f_along >= zero ? zero : part;
  store2(kept * f.x + part * n.x, c.fx + i);
  store2(kept * f.y + part * n.y, c.fy + i);
  store2(kept * f.z + part * n.z, c.fz + i);
}

/// restore() of restoration.hpp over a run of contacts, for one kind of field: nothing is decided inside the loop.
template <NormalField field, bool pushes_only>
void restore_run(const ContactColumns& c, Run run, ActiveConstraint active) {
  active.field = field;
  active.point -= c.origin;
  std::uint32_t i = run.begin;
  if constexpr (field != NormalField::about_cone && field != NormalField::about_ring) {
    for (; i + 1 < run.end; i += 2) restore_two<field, pushes_only>(c, i, active);
  }
  for (; i < run.end; ++i) {
    const Vector3d n = normal_at(active, Vector3d(c.x[i], c.y[i], c.z[i]));
    set_force(c, i, restore_along(n, force_of(c, i), active.alpha, pushes_only));
  }
}

void restore_run(const ContactColumns& c, Run run, const ActiveConstraint& active) {
  const auto by_sense = [&]<NormalField field>() {
    return active.pushes_only ? restore_run<field, true>(c, run, active) : restore_run<field, false>(c, run, active);
  };
  switch (active.field) {
    case NormalField::constant:
      return by_sense.operator()<NormalField::constant>();
    case NormalField::about_line:
      return by_sense.operator()<NormalField::about_line>();
    case NormalField::about_point:
      return by_sense.operator()<NormalField::about_point>();
    case NormalField::about_cone:
      return by_sense.operator()<NormalField::about_cone>();
    case NormalField::about_ring:
      return by_sense.operator()<NormalField::about_ring>();
  }
}

}  // namespace

ConstraintLink::ConstraintLink(const EntitySets& a, const EntitySets& b, const ConstraintOptions& options)
    : options_(options),
      memo_(a, b, options.reduction, options.tolerances, options.limits),
      in_frame_(memo_.constraints_max()),
      holdings_(memo_.candidates_max()) {
  engaged_.reserve(memo_.constraints_max());
}

void ConstraintLink::begin_frame(const Pose& X_AB) {
  X_AB_ = X_AB;
  pose_is_finite_ = X_AB.position.allFinite() && X_AB.rotation.coeffs().allFinite();
  ++stamp_;
  engaged_.clear();
}

const ActiveConstraint& ConstraintLink::active(std::uint32_t constraint) {
  InFrame& state = in_frame_[constraint];
  if (state.stamp == stamp_) return state.active;
  const Constraint& c = memo_.constraint(constraint);
  const double alpha = alignment(options_.measure, c, misalignment(c, X_AB_), options_.scales);
  state = {.stamp = stamp_, .engaged = 0, .active = activate(c, X_AB_, alpha)};
  return state.active;
}

void ConstraintLink::fill(Holding& h, const Candidates& found) {
  std::array<double, Candidates::kMax> alpha = {};
  for (std::size_t i = 0; i < found.count; ++i) alpha[i] = active(found.constraint[i]).alpha;
  for (std::size_t i = 0; i < found.count; ++i) {
    double left = alpha[i];
    for (std::size_t j = 0; j < found.count; ++j) {
      if ((found.yields_to[i] >> j & 1U) != 0) left *= 1 - alpha[j];
    }
    if (!(left > kAlphaLeast)) continue;
    std::size_t place = h.count;
    if (place == kHoldingMax) {  // three normals span everything: of more, the three best aligned
      place = static_cast<std::size_t>(std::min_element(h.alpha.begin(), h.alpha.end()) - h.alpha.begin());
      if (h.alpha[place] >= left) continue;
    } else {
      ++h.count;
    }
    h.constraint[place] = found.constraint[i];
    h.alpha[place] = left;
    h.active[place] = &in_frame_[found.constraint[i]].active;
  }
}

const ConstraintLink::Holding& ConstraintLink::holding(std::uint32_t candidates) {
  Holding& h = holdings_[candidates];
  // The last place is for pairs that found no room in the memo: it belongs to another pair at every look-up.
  const bool is_spare = candidates + 1 == holdings_.size();
  if (h.stamp == stamp_ && !is_spare) return h;
  h.stamp = stamp_;
  h.count = 0;
  if (pose_is_finite_) fill(h, memo_.candidates(candidates));
  return h;
}

void ConstraintLink::count_engaged(const Holding& h, std::uint32_t contacts) {
  for (std::size_t k = 0; k < h.count; ++k) {
    InFrame& state = in_frame_[h.constraint[k]];
    if (state.engaged == 0) {
      engaged_.push_back({&memo_.constraint(h.constraint[k]), 0, 0});
      state.engaged = static_cast<std::uint32_t>(engaged_.size());
    }
    Engaged& e = engaged_[state.engaged - 1];
    e.alpha = std::max(e.alpha, h.alpha[k]);
    e.contacts += contacts;
  }
}

void ConstraintLink::restore_under(const Holding& h, const ContactColumns& c, std::uint32_t begin, std::uint32_t end) {
  if (h.count == 1) {
    ActiveConstraint only = *h.active[0];
    only.alpha = h.alpha[0];
    return restore_run(c, {begin, end}, only);
  }
  for (std::uint32_t i = begin; i < end; ++i) {
    set_force(c, i,
              restore_common({h.active.data(), h.count}, {h.alpha.data(), h.count}, point_of(c, i), force_of(c, i)));
  }
}

/// Neighbouring contacts mostly lie in voxels of the same sets: a run of equal pairs is looked up once, and counted as
/// the hits that it is.
template <bool restore_forces>
RestoreResult ConstraintLink::walk(const ContactColumns& c) {
  RestoreResult result;
  const std::uint64_t misses_before = memo_.counts().misses();
  for (std::uint32_t begin = 0, end = 0; begin < c.size; begin = end) {
    const FeatureSetId a = c.set_a[begin];
    const FeatureSetId b = c.set_b[begin];
    for (end = begin + 1; end < c.size && c.set_a[end] == a && c.set_b[end] == b;) ++end;
    const std::uint32_t length = end - begin;
    const Holding& h = holding(memo_.look_up(a, b));
    memo_.count_hits(length - 1);
    if (h.count == 0) continue;
    result.restored += length;
    count_engaged(h, length);
    for (std::size_t k = 0; k < h.count; ++k) {
      if (h.alpha[k] <= result.alpha) continue;
      result.alpha = h.alpha[k];
      result.kind = h.active[k]->kind;
    }
    if constexpr (restore_forces) restore_under(h, c, begin, end);
  }
  result.misses = static_cast<std::uint32_t>(memo_.counts().misses() - misses_before);
  result.hits = c.size - result.misses;
  return result;
}

RestoreResult ConstraintLink::restore_contacts(const ContactColumns& contacts) {
  return walk<true>(contacts);
}
RestoreResult ConstraintLink::look_up_contacts(const ContactColumns& contacts) {
  return walk<false>(contacts);
}

}  // namespace verisim

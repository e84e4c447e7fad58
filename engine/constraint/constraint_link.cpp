#include "engine/constraint/constraint_link.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/constraint/restore_batch.hpp"

namespace verisim {
namespace {

constexpr double kAlphaMin = 1e-9;  ///< below, a constraint changes no bit of a force in float

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

}  // namespace

ConstraintLink::ConstraintLink(const EntitySets& a, const EntitySets& b, const ConstraintOptions& options)
    : options_(options),
      memo_(a, b, options.reduction, options.tolerances, options.limits),
      in_frame_(memo_.constraints_max()),
      active_sets_(memo_.candidates_max()) {
  VERISIM_ASSERT(is_positive(options.scales.voxel_size));
  engaged_.reserve(memo_.constraints_max());
}

void ConstraintLink::begin_frame(const Pose& X_AB) {
  X_AB_ = X_AB;
  pose_is_finite_ = X_AB.position.allFinite() && X_AB.rotation.coeffs().allFinite();
  VERISIM_ASSERT(!pose_is_finite_ || is_unit(X_AB.rotation));
  ++stamp_;
  engaged_.clear();
}

const ActiveConstraint& ConstraintLink::active(std::uint32_t constraint) {
  InFrame& state = in_frame_[constraint];
  if (state.stamp == stamp_) return state.active;
  const Constraint& c = memo_.constraint(constraint);
  double alpha = alignment(options_.measure, c, misalignment(c, X_AB_), options_.scales);
  for (const std::uint16_t number : memo_.gates_of(constraint)) {
    const Constraint& round = memo_.constraint(number);
    alpha *= clear_of_hole(round, misalignment(round, X_AB_), options_.scales);
  }
  state = {.stamp = stamp_, .engaged = 0, .active = activate(c, X_AB_, alpha)};
  return state.active;
}

void ConstraintLink::fill(ActiveSet& h, const Candidates& found) {
  for (std::size_t i = 0; i < found.count; ++i) {
    const double alpha = active(found.constraint[i]).alpha;
    if (!(alpha > kAlphaMin)) continue;
    std::size_t place = h.count;
    if (place == kActiveMax) {  // three normals span space: keep the three best aligned
      place = static_cast<std::size_t>(std::min_element(h.alpha.begin(), h.alpha.end()) - h.alpha.begin());
      if (h.alpha[place] >= alpha) continue;
    } else {
      ++h.count;
    }
    h.constraint[place] = found.constraint[i];
    h.alpha[place] = alpha;
    h.active[place] = &in_frame_[found.constraint[i]].active;
  }
}

const ConstraintLink::ActiveSet& ConstraintLink::active_set(std::uint32_t candidates) {
  ActiveSet& h = active_sets_[candidates];
  // The last element is for pairs for which the memo has no room: it belongs to another pair at every look-up.
  const bool is_overflow = candidates + 1 == active_sets_.size();
  if (h.stamp == stamp_ && !is_overflow) return h;
  h.stamp = stamp_;
  h.count = 0;
  if (pose_is_finite_) fill(h, memo_.candidates(candidates));
  return h;
}

void ConstraintLink::count_engaged(const ActiveSet& h, std::uint32_t contacts) {
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

void ConstraintLink::restore_by(const ActiveSet& h, const ContactColumns& c, std::uint32_t begin, std::uint32_t end) {
  if (h.count == 1) {
    ActiveConstraint only = *h.active[0];
    only.alpha = h.alpha[0];
    only.point -= c.origin;
    return restore_batch({c.x + begin, c.y + begin, c.z + begin, c.fx + begin, c.fy + begin, c.fz + begin, end - begin},
                         only);
  }
  for (std::uint32_t i = begin; i < end; ++i) {
    set_force(c, i,
              restore_common({h.active.data(), h.count}, {h.alpha.data(), h.count}, point_of(c, i), force_of(c, i)));
  }
}

/// Neighbouring contacts mostly have the same pair of sets. A sequence of equal pairs is looked up once and counted as
/// so many hits.
template <bool restore_forces>
RestoreResult ConstraintLink::walk(const ContactColumns& c) {
  VERISIM_ASSERT(c.size == 0 || c.set_a != nullptr);
  VERISIM_ASSERT(c.size == 0 || c.set_b != nullptr);
  RestoreResult result;
  const std::uint64_t misses_before = memo_.counts().misses();
  for (std::uint32_t begin = 0, end = 0; begin < c.size; begin = end) {
    const FeatureSetId a = c.set_a[begin];
    const FeatureSetId b = c.set_b[begin];
    for (end = begin + 1; end < c.size && c.set_a[end] == a && c.set_b[end] == b;) ++end;
    const std::uint32_t length = end - begin;
    const ActiveSet& h = active_set(memo_.look_up(a, b));
    memo_.count_hits(length - 1);
    if (h.count == 0) continue;
    result.restored += length;
    count_engaged(h, length);
    for (std::size_t k = 0; k < h.count; ++k) {
      if (h.alpha[k] <= result.alpha) continue;
      result.alpha = h.alpha[k];
      result.kind = h.active[k]->kind;
    }
    if constexpr (restore_forces) restore_by(h, c, begin, end);
  }
  result.misses = static_cast<std::uint32_t>(memo_.counts().misses() - misses_before);
  result.hits = c.size - result.misses;
  return result;
}

RestoreResult ConstraintLink::restore_contacts(const ContactColumns& contacts) {
  const ContactColumns& c = contacts;
  VERISIM_ASSERT(c.size == 0 || (c.x != nullptr && c.y != nullptr && c.z != nullptr));
  VERISIM_ASSERT(c.size == 0 || (c.fx != nullptr && c.fy != nullptr && c.fz != nullptr));
  VERISIM_ASSERT(is_finite(c.origin));
  return walk<true>(c);
}
RestoreResult ConstraintLink::look_up_contacts(const ContactColumns& contacts) {
  return walk<false>(contacts);
}

}  // namespace verisim

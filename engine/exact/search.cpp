#include "engine/exact/search.hpp"

#include "engine/exact/edge_crossing.hpp"
#include "engine/exact/edge_ownership.hpp"
#include "engine/exact/ownership_culling.hpp"
#include "engine/exact/search_class.hpp"

namespace verisim::exact {

namespace {

/// Is it the side of a pin or cone?
bool meets_axes(const AnalyticSurface& surface) {
  return surface.is_convex() && (surface.kind() == SurfaceKind::cylinder || surface.kind() == SurfaceKind::cone);
}

}  // namespace

double Search::run(NodePairs& stack) {
  near_.find(pair_.base.face_tree, stack, [&](std::uint32_t block, std::uint32_t face) { test_block(block, face); });
  near_.find(pair_.base.edge_tree, stack, [&](std::uint32_t block, std::uint32_t edge) { cross_block(block, edge); });
  return depth_max_;
}

void Search::test_block(std::uint32_t r, std::uint32_t face) {
  const RelativeMotion& motion = pair_.motion;
  const SampleBlock& block = pair_.mover.blocks[r];
  const Feature& feature = pair_.mover.features[block.feature];
  const AnalyticSurface& surface = *pair_.base.faces[face].surface;
  if (feature.is_axis && !meets_axes(surface)) return;
  if (surface.kind() == SurfaceKind::plane && is_back_facing(block, surface.axis())) return;
  const PlacedFeature& placed = placed_feature(block);
  // Along a straight curve the distance from a plane and its change are linear. All that is left of the curve is its
  // slope (closest_place).
  const bool is_straight = !placed.is_arc() && surface.kind() == SurfaceKind::plane;
  CurveFromSurface curve;
  if (is_straight) {
    curve.is_arc = false;
    curve.surface.kind = SurfaceKind::plane;
    curve.x = {0, 0, surface.axis().dot(placed.x)};
  } else {
    curve = pair_.seen_from(surface, placed, motion.free_twist);
  }
  const std::uint32_t count = block.end - block.begin;
  const double* c = &pair_.mover.sample_c[block.begin];
  PerSample gaps_now;    // m, estimated
  PerSample gaps_ahead;  // m, likewise, at the end of the step without contact
  // A place as deep as this gives no row. Along a straight segment the place that is closest to a plane is the deepest.
  const double deepest = is_straight ? -pair_.base.options.spacing - kSlack : -kOutOfReach;
  measures_begin_ = block.begin;
  bool any = false;
  const auto note = [&](std::uint32_t i, const Measure& m, double nearest_ahead) {
    const double radius = feature.radius_at(c[i]);
    const double nearest = nearest_of(m, feature.half_width, feature.radius_slope) - radius;
    measures_[i] = m;
    const bool may_be_row = nearest < motion.margin && nearest > deepest;
    gaps_now[i] = nearest;
    gaps_ahead[i] = may_be_row ? std::min(nearest + m.change, nearest_ahead - radius) : kOutOfReach;
    any = any || may_be_row;
  };
  if (is_straight) {
    const Vector3d& n = surface.axis();
    const double distance = n.dot(placed.origin - surface.point());
    const double change = n.dot(pair_.moved(placed.origin, motion.free_twist));
    const double more = motion.dt * n.dot(motion.free_twist.angular.cross(placed.x));
    const double rise = feature.half_width * std::abs(curve.x.z() + more - feature.radius_slope);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Measure m{distance + c[i] * curve.x.z(), curve.x.z(), 0, change + c[i] * more};
      note(i, m, m.distance + m.change - rise);
    }
  } else {
    pair_.measure_all(curve, block, [&](std::uint32_t i, const Measure& m) { note(i, m, kOutOfReach); });
  }
  cost_.samples += count;
  if (!any) return;
  if (feature.own_face == kNoFace && count > feature.group)
    cull_unowned_samples(pair_, placed, block, face, measures_, gaps_ahead);
  for (std::uint32_t i = 0; i < count; i += feature.group) {
    const std::uint32_t size = std::min(feature.group, count - i);
    reduce_group(placed, curve, block.begin + i, std::span(gaps_now).subspan(i, size),
                 std::span(gaps_ahead).subspan(i, size), face);
  }
}

/// Contact reduction: one row for a group of samples. Among the candidates that the face accepts it is the one with the
/// smallest gap at the end of the step without contact. If its weight is too small (a segment's end on a slope), the
/// candidate with the largest weight among those that will touch carries the rest. A coincident group has rows at its
/// ends too. What overlaps now and leaves within the step has no row, but its depth is told.
/// @param now        estimated gaps
/// @param remaining  likewise, at the end of the step; kOutOfReach: no candidate. Both are overwritten
void Search::reduce_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                          std::span<double> now, std::span<double> remaining, std::uint32_t face) {
  const BodyPair& m = pair_;
  const auto count = static_cast<std::uint32_t>(remaining.size());
  std::array<double, kGroupMax> estimates;
  for (std::uint32_t i = 0; i < count; ++i) {
    estimates[i] = remaining[i];
    if (remaining[i] == kOutOfReach) now[i] = kOutOfReach;
  }
  Candidate best;
  Candidate strongest;
  Candidate beside;  // the closest place is not on the face; of a hollow one others may be that are hardly farther
  best.gap_ahead = beside.gap_ahead = kOutOfReach;
  strongest.weight = 0;
  while (true) {
    const auto next = std::min_element(remaining.begin(), remaining.end());
    const bool is_enough = best.gap_ahead == kOutOfReach || best.weight >= m.motion.thresholds.weight_enough;
    if (!(*next < (is_enough ? best.gap_ahead : std::max(best.gap_ahead, 0.0)))) break;
    Candidate c;
    c.group = begin;
    c.sample = begin + static_cast<std::uint32_t>(next - remaining.begin());
    *next = now[c.sample - begin] = kOutOfReach;
    if (!evaluate_segment(placed, curve, count, face, c)) {
      if (beside.gap_ahead == kOutOfReach && c.gap < m.motion.margin && c.gap > -m.base.options.spacing) beside = c;
      continue;
    }
    if (is_passed_by(placed, curve, c)) continue;
    if (c.gap_ahead < best.gap_ahead) {
      best = c;
      ask_beyond_the_end(placed, best, remaining);
    }
    if (c.gap_ahead < 0 && c.weight > strongest.weight) strongest = c;
  }
  const bool is_corner = placed.feature->half_width == 0;
  const bool may_conform = placed.feature->own_face != kNoFace || is_corner;
  if (best.gap_ahead == kOutOfReach) {
    if (may_conform && beside.gap_ahead != kOutOfReach) add_conforming(placed, curve, beside, count, face);
    return;
  }
  while (true) {
    const auto next = std::min_element(now.begin(), now.end());
    if (!(*next < -depth_max_ - m.motion.thresholds.coincident)) break;
    Candidate c;
    c.sample = begin + static_cast<std::uint32_t>(next - now.begin());
    *next = kOutOfReach;
    (void)evaluate_segment(placed, curve, count, face, c);  // counts its depth
  }
  if (best.weight < m.motion.thresholds.weight_enough && strongest.weight > best.weight) {
    strongest.weight -= best.weight;
    add_face_row(placed, strongest, count, face);
  }
  add_along(placed, curve, best, count, face);
  if (may_conform) add_conforming(placed, curve, best, count, face);
  if (placed.feature->half_width > 0 && best.gap_ahead < (is_plane(face) ? m.motion.margin : kSlack))
    add_group_ends(placed, curve, best, std::span(estimates).first(count), face);
  add_face_row(placed, best, count, face);
}

/// A closest place at the end of its segment may go on in the next one, whose estimate, a parabola's about its middle,
/// can be above by what a parabola leaves out (63 nm were seen): that segment is evaluated in any case.
void Search::ask_beyond_the_end(const PlacedFeature& placed, const Candidate& best, std::span<double> remaining) {
  const double half = placed.feature->half_width;
  if (half == 0 || std::abs(best.place.t) < half) return;
  const std::size_t here = best.sample - best.group;
  const std::size_t beyond = best.place.t > 0 ? here + 1 : here - 1;  // wraps to one that is not there
  if (beyond < remaining.size() && remaining[beyond] != kOutOfReach)
    remaining[beyond] = std::min(remaining[beyond], best.gap_ahead - kClosestPlaceGain);
}

/// Likewise of the closest place of the candidate's segment. A straight one that comes down on a plane with its other
/// end is closest there at the end of the step.
bool Search::evaluate_segment(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t count,
                              std::uint32_t face, Candidate& c) {
  const double at_c = pair_.mover.sample_c[c.sample];
  const double at_s = pair_.mover.sample_s[c.sample];
  const Feature& feature = *placed.feature;
  c.place = closest_place(curve, at_c, at_s, feature.half_width, feature.radius_slope,
                          &measures_[c.sample - measures_begin_]);
  const bool is_row = evaluate_candidate(placed, face, count, c);
  if (placed.is_arc() || feature.half_width == 0 || !is_plane(face)) return is_row;
  const Vector3d& n = pair_.base.faces[face].surface->axis();
  const double slope_ahead = n.dot(turned(placed.x)) - feature.radius_slope;
  if (!(slope_ahead * (n.dot(placed.x) - feature.radius_slope) < 0)) return is_row;
  Candidate ahead;
  ahead.group = c.group;
  ahead.sample = c.sample;
  ahead.comes_down = true;
  ahead.place = place_at(false, at_c, at_s, slope_ahead > 0 ? -feature.half_width : feature.half_width);
  if (!evaluate_candidate(placed, face, count, ahead) || (is_row && ahead.gap_ahead >= c.gap_ahead)) return is_row;
  c = ahead;
  return true;
}

/// Computes gap, normal and weight of a candidate from its sample and place; it stands for `count` segments. False if
/// it gives no row.
bool Search::evaluate_candidate(const PlacedFeature& placed, std::uint32_t face, std::uint32_t count, Candidate& c) {
  const RelativeMotion& motion = pair_.motion;
  ++cost_.closest_places;
  c.p = placed.point(c.place);
  c.at = pair_.base.faces[face].surface->at(c.p);
  c.gap = c.at.distance - placed.feature->radius_at(c.place.c);
  if (c.gap >= motion.margin || c.gap < -pair_.base.options.spacing) return false;
  c.normal = c.at.normal;
  if (!accept_candidate(pair_, placed, face, c) || !is_near(placed, count, c)) return false;
  c.weight *= pair_.normal_cone_weight(c.sample, c.normal);
  if (c.weight > 0) depth_max_ = std::max(depth_max_, -c.gap);
  return true;
}

/// Computes what an accepted candidate's gap and weight say. False if they give no row.
bool Search::is_near(const PlacedFeature& placed, std::uint32_t count, Candidate& c) const {
  const RelativeMotion& motion = pair_.motion;
  if (c.gap >= motion.margin || c.gap < -pair_.base.options.spacing) return false;
  c.gap_ahead = c.gap + c.normal.dot(pair_.moved(c.p, motion.free_twist));
  c.weight *= touching_fraction(placed, c, count);
  return true;
}

/// Is the candidate's place the end of a segment beyond which the curve goes on?
bool Search::is_between(const PlacedFeature& placed, const Candidate& c) const {
  const Feature& feature = *placed.feature;
  return feature.half_width > 0 && std::abs(c.place.t) >= feature.half_width && feature.goes_on(c.sample, c.place.t);
}

/// True if the curve rolls round within a hollow face, or as a hollow one round a face, its closest place lies in
/// another segment, and by the end of the step it will not have come to this end. What slides round a hole then has the
/// one contact that keeps its speed; a second, at an angle, would brake it. Where the hollow is hardly wider than the
/// curve, the closest place passes along much of the curve within a step, and ends are needed.
/// They are needed, too, where a body was put deep inside: its closest place may be too deep for a row.
bool Search::is_passed_by(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& c) const {
  constexpr double kDeep = 1e-4;  // m: deeper than motions lead
  if (!placed.is_arc() || !is_between(placed, c) || c.gap < -kDeep) return false;
  const RelativeMotion& motion = pair_.motion;
  const Measure here = measure_at(curve, c.place);
  const double clearance = clearance_along(placed, here, c);
  if (!(clearance > 0 && slide(c.p) < motion.thresholds.conforms * clearance)) return false;
  const double length = placed.tangent(c.place).norm();
  const Vector3d axis = placed.x.cross(placed.y).normalized();  // turns about it move the curve along itself
  const auto tilt = [&](const Vector3d& omega) { return motion.dt * (omega - omega.dot(axis) * axis).norm(); };
  const double tilts = motion.thresholds.coincident / placed.feature->half_length +
                       std::max(tilt(motion.free_twist.angular), tilt(motion.last_twist.angular));
  constexpr double kGain =
      1e-9;  // m, above that of closest_place: at the limit of two segments one of them has the row
  if (here.slope * here.slope < 2 * kGain * here.bend) return false;
  return std::abs(here.slope) / length > tilts;
}

/// The end of a group on the given side (-1 or 1), if it may be where the bodies touch at the end of the step. On a
/// plane that is any end in reach: a blow elsewhere turns the body, and what lay flush is pressed in at its other end.
/// Else it is one that may be closer than the closest place then: a contact that stops one place by some distance turns
/// the bodies by about that distance over their size. If the face does not accept the end, the outermost segment that
/// it accepts is taken.
std::optional<Search::GroupEnd> Search::group_end(const PlacedFeature& placed, const CurveFromSurface& curve,
                                                  const Candidate& best, std::span<const double> gaps_ahead, int side,
                                                  std::uint32_t face) {
  const double half = placed.feature->half_width;
  const int count = static_cast<int>(gaps_ahead.size());
  const int here = static_cast<int>(best.sample - best.group);
  const double reach = is_plane(face) ? pair_.motion.margin : -kOutOfReach;
  const auto is_coincident = [&](double gap_ahead, double away) {
    return gap_ahead < best.gap_ahead * (1 - away / pair_.motion.size) + kSlack;
  };
  const auto may_touch = [&](double gap_ahead, double away) {
    return gap_ahead < reach || is_coincident(gap_ahead, away);
  };
  for (int i = side > 0 ? count - 1 : 0; side * (i - here) >= 0; i -= side) {
    const double offset = side * (2 * half * (i - here) - best.place.t) + half;  // in t, from the closest place
    if (offset < pair_.motion.thresholds.end_apart * (2 * half * count)) break;
    const double ahead = gaps_ahead[static_cast<std::size_t>(i)];
    if (ahead == kOutOfReach) continue;
    if (!may_touch(ahead, offset / half * placed.feature->half_length)) break;
    Candidate c;
    c.group = best.group;
    c.sample = best.group + static_cast<std::uint32_t>(i);
    c.place = place_at(placed.is_arc(), pair_.mover.sample_c[c.sample], pair_.mover.sample_s[c.sample], side * half);
    if (!evaluate_candidate(placed, face, 1, c)) continue;
    const double away = (c.p - best.p).norm();
    if (is_passed_by(placed, curve, c) || !may_touch(c.gap_ahead, away)) break;
    return GroupEnd{c, is_coincident(c.gap_ahead, away)};
  }
  return std::nullopt;
}

/// What part of an evenly spread stiffness the end of a line carries, of three springs: at both ends, `mine` and
/// `other` [m] away, and between them. All three have the line's sum, centre and second moment (a sixth at each end if
/// the third is in the middle). Where that asks for a spring that pulls, two of them have its sum and centre.
double Search::share_of_end(double mine, double other) {
  return mine > 2 * other ? (mine - other) / (2 * mine) : std::max(2 * mine - other, 0.0) / (6 * mine);
}

/// Adds the rows of a group's ends. Where all places are about equally near, the closest one changes from frame to
/// frame, and a single row would let the body tip over it. Ends that are as near take from the closest place's weight
/// so that the rows together resist as the group does.
void Search::add_group_ends(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best,
                            std::span<const double> gaps_ahead, std::uint32_t face) {
  const auto count = static_cast<std::uint32_t>(gaps_ahead.size());
  std::array<std::optional<GroupEnd>, 2> ends{group_end(placed, curve, best, gaps_ahead, -1, face),
                                              group_end(placed, curve, best, gaps_ahead, 1, face)};
  const auto lever = [&](std::size_t i) { return ends[i] && ends[i]->shares ? (ends[i]->place.p - best.p).norm() : 0; };
  const std::array<double, 2> levers{lever(0), lever(1)};
  double left = 1;
  for (const std::size_t i : {0, 1}) {
    if (!ends[i]) continue;
    Candidate& end = ends[i]->place;
    if (ends[i]->shares) {
      const double share = share_of_end(levers[i], levers[1 - i]);
      left -= share;
      end.weight *= share;
    }
    add_row(placed, end, count, face, curving(pair_, after_, placed, end, face, 0));
  }
  best.weight *= left;
}

/// Fraction of a group's length that touches. A group that slopes towards the surface leaves it where the rise has used
/// up the overlap at the closest place; one that comes down, at the end of the step.
double Search::touching_fraction(const PlacedFeature& placed, const Candidate& c, std::uint32_t count) const {
  const Vector3d tangent = placed.tangent(c.place);
  const double slope = c.normal.dot(c.comes_down ? turned(tangent) : tangent) - placed.feature->radius_slope;
  const double rise = std::abs(slope) * 2 * placed.feature->half_width * count;
  const double overlap = pair_.motion.thresholds.touching + std::max(0.0, -(c.comes_down ? c.gap_ahead : c.gap));
  return rise > overlap ? overlap / rise : 1;
}

/// Back-face culling: true if a plane's normal is outside of the normal cone of every sample of a block.
bool Search::is_back_facing(const SampleBlock& block, const Vector3d& normal) const {
  const Vector3d n = pair_.motion.now.R.transpose() * normal;
  for (std::uint32_t i = block.begin; i < block.end; ++i)
    if (pair_.outside_normal_cone(i, n) < pair_.motion.thresholds.cone_none) return false;
  return true;
}

/// Adds the row of a candidate that touches the face's surface, not a plane beside it.
void Search::add_face_row(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t face) {
  add_row(placed, c, count, face, curving(pair_, after_, placed, c, face, count));
}

/// Adds the row of a candidate that stands for `count` segments.
/// @param entity  of the base: a face's number, or an edge's beyond those of the faces
void Search::add_row(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t entity,
                     double curving) {
  const RelativeMotion& motion = pair_.motion;
  const Feature& feature = *placed.feature;
  if (c.weight == 0) return;
  const double point = pair_.mover.options.line_stiffness * pair_.mover.options.point_length;
  const double stiffness = c.weight * (count * feature.stiffness + c.edge_fraction * point);
  const Vector3d normal = motion.R_WB * c.normal;
  const Vector3d place = motion.R_WB * (c.p - feature.radius_at(c.place.c) * c.normal) + motion.p_WB;
  const auto entities = static_cast<std::uint32_t>(pair_.base.faces.size() + pair_.base.edges.size());
  const std::uint32_t source = (c.group * entities + entity) << 1 | static_cast<std::uint32_t>(motion.mover_is_second);
  rows_.add({motion.mover_is_second ? normal : Vector3d(-normal), place, c.gap, stiffness, source, curving});
  ++cost_.rows;
}

double search(const ExactBody& mover, const ExactBody& base, const RelativeMotion& motion, NodePairs& stack,
              RowList& rows, SearchCost& cost) {
  return Search(mover, base, motion, rows, cost).run(stack);
}

}  // namespace verisim::exact

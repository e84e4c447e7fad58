// Rows of what fits closely, beside its closest place (conforming_normals.hpp).
#include "engine/exact/conforming_normals.hpp"
#include "engine/exact/search_class.hpp"

namespace verisim::exact {

/// How far it moves a body until an arc's closest place has turned by a radian, where it rolls round within a hollow
/// face, or as a hollow one round a face [m]; else below 0.
double Search::clearance_along(const PlacedFeature& placed, const Measure& here, const Candidate& c) {
  const double square = placed.tangent(c.place).squaredNorm();
  const double bend = here.bend / square;  // 1/m, of the gap along the curve
  const double of_curve = c.at.normal.dot(placed.origin - c.p) / square;
  const double of_face = of_curve - bend;
  return bend > 0 && of_face * of_curve > 0 ? bend / (of_face * of_curve) : -1;
}

/// How the distance from a surface changes along an arc, at a place.
Measure Search::measure_at(const CurveFromSurface& curve, const Place& place) {
  Measure here{};
  with_measure(curve, [&](auto&& measure) { here = measure(place.c, place.s); });
  return here;
}

/// How far a place slides within the step, at most: without contact, or as it did in the last one [m].
double Search::slide(const Vector3d& p) const {
  const RelativeMotion& motion = pair_.motion;
  return std::max(pair_.moved(p, motion.free_twist).norm(), pair_.moved(p, motion.last_twist).norm());
}

/// Likewise along what it is pressed on.
double Search::slide_along(const Candidate& c) const {
  const auto of = [&](const Twist& twist) {
    const Vector3d way = pair_.moved(c.p, twist);
    return (way - std::min(way.dot(c.normal), 0.0) * c.normal).norm();
  };
  return std::max(of(pair_.motion.free_twist), of(pair_.motion.last_twist));
}

/// How far an arc is moved in its plane within the step [m]: along its axis it stays as far from what it turns about.
double Search::way_across(const PlacedFeature& placed, const Twist& twist) const {
  const Vector3d way = pair_.moved(placed.origin, twist);
  const Vector3d axis = placed.x.cross(placed.y).normalized();
  return (way - way.dot(axis) * axis).norm();
}

/// Adds rows along an arc that fits closely and is held: its closest place may come to any place of it within the step,
/// and one tangent plane says little of the others (conforming_normals.hpp). The candidate keeps the part that is
/// nearest to it. What moves farther than its clearance in a step has another place each time, and forces that change
/// with it.
void Search::add_along(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best, std::uint32_t count,
                       std::uint32_t face) {
  constexpr double kFlush = 1e-7;    // m: less is no clearance, and all of the curve touches
  constexpr double kClosely = 0.01;  // of its radius: what slides round in more room needs one row
  if (!placed.is_arc() || placed.feature->own_face != kNoFace) return;
  const RelativeMotion& motion = pair_.motion;
  const Measure here = measure_at(curve, best.place);
  if (lies_beyond(placed, curve, best, here, count)) return;
  const double clearance = clearance_along(placed, here, best);
  if (!(clearance > kFlush)) return;
  const double last = way_across(placed, motion.last_twist);
  const double way = std::max(last, way_across(placed, motion.free_twist));
  const SearchThresholds& least = motion.thresholds;
  const double fits = clearance < kClosely * placed.x.norm() ? least.held : least.conforms;
  if (!(way > fits * clearance && last < clearance)) return;
  const double half = placed.feature->half_width;
  const Candidate closest = closest_of_group(placed, curve, best.group, count);
  const bool moves = pair_.moved(best.p, motion.during).norm() > motion.thresholds.slow;
  const double of_one = moves ? kTurnAlongOfOneMoving : kTurnAlongOfOne;
  if (!add_beside(placed, curve, closest, of_one, count, face)) return;
  const double away = std::abs(2 * half * (best.sample - best.group) + best.place.t - closest.place.t);
  best.weight *= std::min(1.0, part_beside(away, of_one));
}

/// Is the closest place of an arc, as it is now, beyond a group's end? It is where the gap still falls there. Most
/// groups of an arc end here: closest_of_group costs more.
/// @param here  at the candidate
bool Search::lies_beyond(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& best,
                         const Measure& here, std::uint32_t count) const {
  const double half = placed.feature->half_width;
  const double sense = here.slope > 0 ? -1 : 1;  // in which the gap falls
  const std::uint32_t last = best.group + (sense > 0 ? count - 1 : 0);
  const bool is_at_end = best.sample == last && sense * best.place.t >= half;
  const Measure end =
      is_at_end
          ? here
          : measure_at(curve, place_at(true, pair_.mover.sample_c[last], pair_.mover.sample_s[last], sense * half));
  return sense * end.slope < -half * end.bend;
}

/// The closest place of a group as it is now: the candidate, which is closest at the end of the step without contact,
/// may be that of another segment from step to step. It is given from the group's first sample on.
Candidate Search::closest_of_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t group,
                                   std::uint32_t count) const {
  const double half = placed.feature->half_width;
  const double to_middle = half * (count - 1);
  const Place middle = place_at(true, pair_.mover.sample_c[group], pair_.mover.sample_s[group], to_middle);
  Candidate closest;
  closest.group = closest.sample = group;
  closest.place = closest_place(curve, middle.c, middle.s, half * count);
  closest.place.t += to_middle;
  return closest;
}

/// Which part of a group's stiffness a row has that lies at this angle from the closest place (conforming_normals.hpp).
/// @param of_one  rad, angle at which it has all of it
double Search::part_beside(double turn, double of_one) {
  const double part = std::max(turn, kTurnsAlong.front()) / of_one;
  return part * part;
}

/// The candidate at an angle along an arc from a place. Nothing beyond the arc's end, and if it gives no row.
std::optional<Candidate> Search::candidate_beside(const PlacedFeature& placed, const Candidate& closest, double turn,
                                                  std::uint32_t face) {
  const Feature& feature = *placed.feature;
  const double half = feature.half_width;
  const double t = closest.place.t + turn;  // from the middle of the sample's segment
  const double segments = std::round(t / (2 * half));
  double number = closest.sample + segments;
  const double samples = feature.end - feature.begin;
  if (feature.closed) number -= samples * std::floor((number - feature.begin) / samples);
  if (!(number >= feature.begin && number < feature.end)) return std::nullopt;
  Candidate c;
  c.group = closest.group;
  c.sample = static_cast<std::uint32_t>(number);
  c.place = place_at(true, pair_.mover.sample_c[c.sample], pair_.mover.sample_s[c.sample], t - 2 * half * segments);
  if (!evaluate_candidate(placed, face, 1, c)) return std::nullopt;
  return c;
}

/// Is the face closer to an arc at one place than at others? Else a group's ends say how it lies.
bool Search::is_bent(const Measure& here) {
  return here.bend * kTurnsAlong.back() * kTurnsAlong.back() >= 2 * kSlack;
}

/// Adds rows along an arc beside a place, at kTurnsAlong. None if the place is the end of its segments and not the
/// closest, or all are as close. @returns whether there is one
bool Search::add_beside(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& closest,
                        double of_one, std::uint32_t count, std::uint32_t face) {
  const Measure here = measure_at(curve, closest.place);
  if (!is_bent(here) || !(std::abs(here.slope) <= placed.feature->half_width * here.bend)) return false;
  bool any = false;
  for (const double turn : kTurnsAlong) {
    for (const double sense : {-1.0, 1.0}) {
      std::optional<Candidate> c = candidate_beside(placed, closest, sense * turn, face);
      if (!c || !(std::min(c->gap, c->gap_ahead) < kSlack)) continue;
      c->weight *= part_beside(turn, of_one);
      add_row(placed, *c, count, face, curving(pair_, after_, placed, *c, face, 0));
      any = true;
    }
  }
  return any;
}

/// Adds the rows of a ball or a corner that may come to other places of a hollow within the step
/// (conforming_normals.hpp), of a ring beside the place that is closest now, too, and of a corner where the motions
/// that are assumed lead it.
void Search::add_conforming(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best,
                            std::uint32_t count, std::uint32_t face) {
  constexpr double kTouches = 0.01, kStays = 0.05;  // of the clearance
  const RelativeMotion& motion = pair_.motion;
  const AnalyticSurface& surface = *pair_.base.faces[face].surface;
  if (!hollow_place(surface, best.p)) return;
  std::optional<Candidate> of_ring;
  if (placed.is_arc() && is_bent(measure_at(curve, best.place)))
    of_ring = candidate_beside(placed, closest_of_group(placed, curve, best.group, count), 0, face);
  const Candidate& closest = of_ring ? *of_ring : best;
  const std::optional<HollowPlace> in = hollow_place(surface, closest.p);
  if (!in || !(slide(closest.p) > motion.thresholds.conforms * in->radius)) return;
  const bool is_corner = placed.feature->own_face == kNoFace;
  bool any = false;
  const auto add = [&](const Vector3d& normal, double part) {
    Candidate c = closest;
    c.normal = normal;
    c.at = {closest.at.distance + (c.normal - closest.normal).dot(closest.p - in->pivot), c.normal};
    c.gap = c.at.distance - placed.feature->radius_at(c.place.c);
    c.weight = 1;
    if (!(c.gap < motion.margin) || !accept_candidate(pair_, placed, face, c)) return;
    c.weight *= part;
    if (is_corner) c.weight *= pair_.normal_cone_weight(c.sample, c.normal);
    add_row(placed, c, count, face, 0);
    any = true;
  };
  const bool touches = closest.gap < std::max(kTouches * in->radius, motion.thresholds.coincident);
  const bool stays = touches && slide_along(closest) < kStays * in->radius;
  const ConformingNormals around = conforming_normals(*in, closest.normal, touches, stays);
  for (std::size_t i = 0; i < around.count; ++i) add(around.normals[i], around.parts[i]);
  if (of_ring) (void)add_beside(placed, curve, closest, kTurnAlongRingOfOne, count, face);
  // The closest row of what moves knows how that curves (curving.hpp).
  const bool moves = pair_.moved(closest.p, motion.during).norm() > motion.thresholds.slow;
  if (any && !moves) best.weight *= around.part_of_closest;
  if (!is_corner) return;
  for (const Placement* there : {&motion.ahead(), &motion.after()})
    add(surface.at(placed_by(*there, *placed.feature).point(best.place)).normal, around.part_of_closest);
}

}  // namespace verisim::exact

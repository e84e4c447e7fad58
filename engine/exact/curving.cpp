#include "engine/exact/curving.hpp"

#include <algorithm>

#include "engine/exact/edge_crossing.hpp"
#include "engine/exact/edge_ownership.hpp"

namespace verisim::exact {
namespace {

/// Of a place that goes along `way`: what curves, if it is a curve and no kink, and takes from the gap.
double taken_along(const BodyPair& pair, const Vector3d& way, double curves) {
  return curves < -pair.motion.thresholds.kink * way.norm() ? 0 : std::min(0.0, curves);
}

/// Likewise of a gap that also changes by `linear`. If what curves gives to it, a place that passes by another one
/// without touching it gets as much as keeps its row from acting.
double curving_along(const BodyPair& pair, const Vector3d& way, double gap, double linear, double curves) {
  const double end = gap + linear;
  if (!(curves > 0) || !(end < 0)) return taken_along(pair, way, curves);
  const double closest = std::min(1.0, -linear / (2 * curves));  // of the step
  const double least = gap + closest * (linear + closest * curves);
  return least < -pair.motion.thresholds.touching ? 0 : std::min(curves, -end);
}

/// What a place in front of a face lacks at the end of the step for its row not to act. Where others hold the body it
/// goes lower by nanometres. @param end  its gap then, by its linear change [m]
double lacks(const BodyPair& pair, const Candidate& c, double end) {
  const double touching = pair.motion.thresholds.touching;
  return c.gap > touching ? std::max(0.0, touching - end) : 0;
}

/// What curves of the gap of a place in front of a round face, if it passes by without touching on the way that the
/// bodies are taken to go: a ball comes over an edge that is flush. 0 if it does not.
/// @param linear  the gap's linear change [m]   @param gap_at  the gap at a place of the base's coordinates
template <typename F>
double of_passing(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, double linear, F&& gap_at) {
  constexpr int kLooks = 8;
  const double end = c.gap + linear;
  const double lack = lacks(pair, c, end);
  if (lack == 0) return 0;
  double gap = 0;
  for (int i = 1; i <= kLooks; ++i) {
    const Placement there = pair.motion.after_part(static_cast<double>(i) / kLooks);
    gap = gap_at(placed_by(there, *placed.feature).point(c.place));
    if (gap < -pair.motion.thresholds.touching) return 0;
  }
  return std::clamp(gap - end, 0.0, lack);
}

/// The place of `count` segments from `first` on that is closest to a face.
Place closest_of(const BodyPair& pair, const Feature& feature, const CurveFromSurface& seen, std::uint32_t first,
                 std::uint32_t count) {
  const Place middle = place_at(seen.is_arc, pair.mover.sample_c[first], pair.mover.sample_s[first],
                                feature.half_width * (static_cast<double>(count) - 1));
  return closest_place(seen, middle.c, middle.s, count * feature.half_width, feature.radius_slope);
}

/// Is the closest place of the candidate's segment that of its group: does the gap rise on both sides of it? Where it
/// has a maximum, the group's other end may be closer.
bool is_closest_of_group(const Feature& feature, const CurveFromSurface& seen, const Candidate& c, const Place& at,
                         std::uint32_t count) {
  if (std::abs(at.t) < feature.half_width) return true;
  if (c.sample != c.group + (at.t > 0 ? count - 1 : 0)) return false;
  double bend = 0;
  with_measure(seen, [&](auto&& measure_at) { bend = measure_at(at.c, at.s).bend; });
  return bend > 0;
}

/// The smallest gap to a face, and the normal there, of the candidate's segment; with a count of 0 that of its place.
/// If the group, of `count` segments, is nearer by more than what touches anyway, that of the group. A place that is
/// nearer by so much than the candidate's own has to be on the face: beyond its border there is nothing to touch, and
/// at the border edges cross.
SurfaceAt closest_gap(const BodyPair& pair, FeatureAfter& after, const Candidate& c, std::uint32_t face,
                      std::uint32_t count) {
  const AnalyticSurface& surface = *pair.base.faces[face].surface;
  const PlacedFeature& placed = after.placed();
  const double touching = pair.motion.thresholds.touching;
  const auto gap_at = [&](const Place& place) {
    SurfaceAt at = surface.at(placed.point(place));
    at.distance -= placed.feature->radius_at(place.c);
    return at;
  };
  SurfaceAt own = gap_at(c.place);
  if (count == 0 || placed.feature->half_width == 0) return own;
  const CurveFromSurface& seen = after.seen_from(pair, surface);
  Place nearest = closest_of(pair, *placed.feature, seen, c.sample, 1);
  SurfaceAt at = gap_at(nearest);
  if (!is_closest_of_group(*placed.feature, seen, c, nearest, count)) {
    const Place of_group = closest_of(pair, *placed.feature, seen, c.group, count);
    const SurfaceAt there = gap_at(of_group);
    if (there.distance < at.distance - touching) {
      nearest = of_group;
      at = there;
    }
  }
  const bool is_off =
      at.distance < own.distance - touching && !is_on_face(pair.base, face, surface.foot(placed.point(nearest)));
  return is_off ? own : at;
}

double curving_of_lines(const BodyPair& pair, const PlacedFeature& placed, const PlacedFeature& after,
                        const Candidate& c, const ExactEdge& edge) {
  constexpr double kAlike = 1e-6;  // of two normals: that of the lines is the contact's
  const auto normal_of = [&](const PlacedFeature& at) {
    const Vector3d across = at.x.cross(edge.direction).normalized();
    return across.dot(c.normal) < 0 ? Vector3d(-across) : across;
  };
  const Vector3d normal = normal_of(placed);
  if ((normal - c.normal).squaredNorm() > kAlike * kAlike) return 0;
  const auto gap = [&](const PlacedFeature& at, const Vector3d& n) { return n.dot(at.origin - edge.center); };
  const Vector3d way = pair.moved(c.p, pair.motion.during);
  return taken_along(pair, way, gap(after, normal_of(after)) - gap(placed, normal) - normal.dot(way));
}

/// True if the curve is inside of an edge at the end of the step, near the candidate.
bool cross_after(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const ExactEdge& edge) {
  const RelativeMotion no_motion = still(pair.motion, pair.motion.after());
  const BodyPair there{pair.mover, pair.base, no_motion};
  const Feature& feature = *placed.feature;
  const PlacedFeature after = placed_by(no_motion.now, feature);
  const std::uint32_t first = std::max(feature.begin + kGroupMax, c.sample) - kGroupMax;
  for (std::uint32_t i = first; i < std::min(feature.end, c.sample + kGroupMax + 1); ++i) {
    Candidate crossed = c;
    crossed.sample = i;
    if (cross_edge(there, after, edge, closest_places_to(there, after, edge, i), crossed) &&
        crossed.gap < -pair.motion.thresholds.touching)
      return true;
  }
  return false;
}

}  // namespace

void FeatureAfter::place(const BodyPair& pair, const Feature& feature) {
  if (placed_.feature == &feature) return;
  surface_ = nullptr;
  placed_ = placed_by(pair.motion.after(), feature);
}

const CurveFromSurface& FeatureAfter::seen_from(const BodyPair& pair, const AnalyticSurface& surface) {
  if (surface_ == &surface) return curve_;
  surface_ = &surface;
  return curve_ = pair.seen_from(surface, placed_, {});
}

double curving(const BodyPair& pair, FeatureAfter& after, const PlacedFeature& placed, const Candidate& c,
               std::uint32_t number, std::uint32_t count) {
  const ExactFace& face = pair.base.faces[number];
  const RelativeMotion& motion = pair.motion;
  const Feature& feature = *placed.feature;
  const Vector3d way = pair.moved(c.p, motion.during);
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  after.place(pair, feature);
  if (!placed.is_arc() && face.surface->kind() == SurfaceKind::plane)  // the way itself turns, and nothing else
    return taken_along(pair, way, face.surface->axis().dot(after.placed().point(c.place) - c.p - way));
  const SurfaceAt there = closest_gap(pair, after, c, number, count);
  const double linear = c.at.normal.dot(way);
  const auto gap_at = [&](const Vector3d& p) { return face.surface->at(p).distance - feature.radius_at(c.place.c); };
  if (there.distance > -motion.thresholds.touching)
    if (const double passing = of_passing(pair, placed, c, linear, gap_at); passing > 0) return passing;
  // A normal that turns so far says nothing of the one that it was: in a close fit other rows stop the body.
  if ((there.normal - c.at.normal).norm() > motion.thresholds.kink) return 0;
  return curving_along(pair, way, c.gap, linear, there.distance - c.gap - linear);
}

double passing_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const ExactEdge& edge) {
  const auto gap_at = [&](const Vector3d& p) {
    return std::max(pair.base.faces[edge.faces[0]].surface->at(p).distance,
                    pair.base.faces[edge.faces[1]].surface->at(p).distance);
  };
  const double passing = of_passing(pair, placed, c, c.normal.dot(pair.moved(c.p, pair.motion.during)), gap_at);
  return passing > 0 && !cross_after(pair, placed, c, edge) ? passing : 0;
}

double curving_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const ExactEdge& edge) {
  const RelativeMotion& motion = pair.motion;
  const Vector3d way = pair.moved(c.p, motion.during);
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  const PlacedFeature after = placed_by(motion.after(), *placed.feature);
  if (!placed.is_arc() && edge.extent == ExactEdge::Extent::line) return curving_of_lines(pair, placed, after, c, edge);
  if (const double passing = passing_of_edges(pair, placed, c, edge); passing > 0) return passing;
  const RelativeMotion no_motion = still(motion, motion.after());
  const BodyPair there{pair.mover, pair.base, no_motion};
  Candidate crossed = c;
  if (!cross_edge(there, after, edge, closest_places_to(there, after, edge, c.sample), crossed)) return 0;
  const double linear = c.normal.dot(way);
  return curving_along(pair, way, c.gap, linear, crossed.gap - c.gap - linear);
}

}  // namespace verisim::exact

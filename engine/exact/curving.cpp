#include "engine/exact/curving.hpp"

#include "engine/exact/edge_crossing.hpp"

namespace verisim::exact {
namespace {

/// Of a place that goes along `way`: what curves, if it is a curve and no kink, and takes from the gap.
double curving_along(const BodyPair& pair, const Vector3d& way, double curves) {
  return curves < -pair.motion.thresholds.kink * way.norm() ? 0 : std::min(0.0, curves);
}

/// Where the feature is after the step, if the bodies move as they are taken to.
PlacedFeature moved_on(const BodyPair& pair, const PlacedFeature& placed) {
  const RelativeMotion& motion = pair.motion;
  const Vector3d turn = motion.dt * motion.during.angular;
  const auto turned = [&](const Vector3d& v) { return Vector3d(v + turn.cross(v + 0.5 * turn.cross(v))); };
  const Vector3d moved = pair.moved(placed.origin, motion.during);
  return {placed.feature, placed.origin + moved + 0.5 * turn.cross(moved), turned(placed.x), turned(placed.y)};
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
  return curving_along(pair, way, gap(after, normal_of(after)) - gap(placed, normal) - normal.dot(way));
}

}  // namespace

double curving(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const AnalyticSurface& surface) {
  const RelativeMotion& motion = pair.motion;
  const Feature& feature = *placed.feature;
  const Vector3d way = pair.moved(c.p, motion.during);
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  if (!placed.is_arc() && surface.kind() == SurfaceKind::plane)  // the way itself turns, and nothing else
    return curving_along(pair, way, 0.5 * surface.axis().dot(motion.dt * motion.during.angular.cross(way)));
  const auto least = [&](const PlacedFeature& at) {
    double gap = 0;
    with_measure(pair.seen_from(surface, at, {}), [&](auto&& measure_at) {
      const Measure m = measure_at(c.place.c, c.place.s);
      const double slope = m.slope - feature.radius_slope;
      const double reach = 2 * feature.half_width;
      // Places farther away have rows of their own.
      const double t = std::abs(slope) < m.bend * reach ? -slope / m.bend : 0;
      gap = m.distance + t * (slope + 0.5 * t * m.bend);
    });
    return gap;
  };
  return curving_along(pair, way, least(moved_on(pair, placed)) - least(placed) - c.at.normal.dot(way));
}

double curving_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const ExactEdge& edge) {
  const RelativeMotion& motion = pair.motion;
  const Vector3d way = pair.moved(c.p, motion.during);
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  const PlacedFeature after = moved_on(pair, placed);
  if (!placed.is_arc() && edge.extent == ExactEdge::Extent::line) return curving_of_lines(pair, placed, after, c, edge);
  RelativeMotion still = motion;
  still.free_twist = still.last_twist = {};
  const BodyPair there{pair.mover, pair.base, still};
  const auto near = [&](std::size_t side) {
    return closest_place_to(there, *pair.base.faces[edge.faces[side]].surface, after, c.sample);
  };
  Candidate crossed = c;
  if (!cross_edge(there, after, edge, {near(0), near(1)}, crossed)) return 0;
  return curving_along(pair, way, crossed.gap - c.gap - c.normal.dot(way));
}

}  // namespace verisim::exact

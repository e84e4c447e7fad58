#include "engine/exact/curving.hpp"

namespace verisim::exact {
namespace {

/// Of a place that goes along `way`: what curves, if it is a curve and no kink, and takes from the gap.
double curving_along(const BodyPair& pair, const Vector3d& way, double curves) {
  return curves < -pair.motion.thresholds.kink * way.norm() ? 0 : std::min(0.0, curves);
}

/// Where the feature is after a step in which the bodies go on as they did in the last.
PlacedFeature moved_on(const BodyPair& pair, const PlacedFeature& placed) {
  const RelativeMotion& motion = pair.motion;
  const Vector3d turn = motion.dt * motion.last_twist.angular;
  const auto turned = [&](const Vector3d& v) { return Vector3d(v + turn.cross(v + 0.5 * turn.cross(v))); };
  const Vector3d moved = pair.moved(placed.origin, motion.last_twist);
  return {placed.feature, placed.origin + moved + 0.5 * turn.cross(moved), turned(placed.x), turned(placed.y)};
}

}  // namespace

double curving(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const AnalyticSurface& surface) {
  const RelativeMotion& motion = pair.motion;
  const Feature& feature = *placed.feature;
  const Vector3d way = pair.moved(c.p, motion.last_twist);
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  if (!placed.is_arc() && surface.kind() == SurfaceKind::plane)  // the way itself turns, and nothing else
    return curving_along(pair, way, 0.5 * surface.axis().dot(motion.dt * motion.last_twist.angular.cross(way)));
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
  constexpr double kAlike = 1e-6;  // of two normals: that of the lines is the contact's
  const RelativeMotion& motion = pair.motion;
  const Vector3d way = pair.moved(c.p, motion.last_twist);
  if (placed.is_arc() || edge.extent != ExactEdge::Extent::line) return 0;
  if (way.squaredNorm() < motion.thresholds.slow * motion.thresholds.slow) return 0;
  const auto normal_of = [&](const PlacedFeature& at) {
    const Vector3d across = at.x.cross(edge.direction).normalized();
    return across.dot(c.normal) < 0 ? Vector3d(-across) : across;
  };
  const Vector3d normal = normal_of(placed);
  if ((normal - c.normal).squaredNorm() > kAlike * kAlike) return 0;
  const PlacedFeature after = moved_on(pair, placed);
  const auto gap = [&](const PlacedFeature& at, const Vector3d& n) { return n.dot(at.origin - edge.center); };
  return curving_along(pair, way, gap(after, normal_of(after)) - gap(placed, normal) - normal.dot(way));
}

}  // namespace verisim::exact

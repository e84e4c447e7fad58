// Edges of the mover against convex edges of the base.
#include "engine/exact/curving.hpp"
#include "engine/exact/edge_crossing.hpp"
#include "engine/exact/search_class.hpp"

namespace verisim::exact {
namespace {

bool is_of_lines(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge) {
  const auto is_plane = [&](std::uint32_t face) { return pair.base.faces[face].surface->kind() == SurfaceKind::plane; };
  return !placed.is_arc() && is_plane(edge.faces[0]) && is_plane(edge.faces[1]);
}

/// True if a straight feature leaves both planes of an edge in the same direction, but not after the step.
bool slopes_turn(const BodyPair& pair, const PlacedFeature& placed, const PlacedFeature& there, const ExactEdge& edge) {
  const Vector3d& a = pair.base.faces[edge.faces[0]].surface->axis();
  const Vector3d& b = pair.base.faces[edge.faces[1]].surface->axis();
  return a.dot(placed.x) * b.dot(placed.x) >= 0 && a.dot(there.x) * b.dot(there.x) < 0;
}

}  // namespace

BodyPair Search::pair_at(When when) {
  const RelativeMotion& motion = pair_.motion;
  if (when == When::now) return pair_;
  const bool is_ahead = when == When::ahead;
  std::optional<RelativeMotion>& there = is_ahead ? still_ahead_ : still_after_;
  if (!there) there = still(motion, is_ahead ? motion.ahead() : motion.after());
  return {pair_.mover, pair_.base, *there};
}

/// A straight edge that slopes the same way from both faces of an edge crosses none, but may do so after the step.
void Search::cross_block(std::uint32_t r, std::uint32_t e) {
  const SampleBlock& block = pair_.mover.blocks[r];
  const Feature& feature = pair_.mover.features[block.feature];
  if (feature.own_face != kNoFace || feature.half_width == 0) return;
  const ExactEdge& edge = pair_.base.edges[e];
  const PlacedFeature& placed = placed_feature(block);
  if (!is_of_lines(pair_, placed, edge) || may_cross_edge(pair_, placed, edge))
    return cross_block(When::now, placed, block, e);
  for (const When when : {When::ahead, When::after}) {
    const PlacedFeature there = placed_by(pair_at(when).motion.now, feature);
    if (!slopes_turn(pair_, placed, there, edge) || !may_cross_edge(pair_at(when), there, edge)) continue;
    return cross_block(when, there, block, e);
  }
}

/// Edge against edge: one row for a group of samples, that of the crossing with the smallest gap at the end of the step
/// without contact. @param placed  the mover's curve then
void Search::cross_block(When when, const PlacedFeature& placed, const SampleBlock& block, std::uint32_t e) {
  const BodyPair pair = pair_at(when);
  const Feature& feature = *placed.feature;
  const ExactEdge& edge = pair.base.edges[e];
  const bool of_lines = is_of_lines(pair, placed, edge);
  const double longest = longest_way(placed, block);
  const double way = of_lines ? longest : kOutOfReach;
  if (of_lines && is_led_all_along(placed, block, edge, way)) return;
  std::array<std::array<Measure, kBlockSize>, 2> measures;
  const std::uint32_t count = block.end - block.begin;
  for (std::size_t side = 0; side < 2; ++side) {
    const AnalyticSurface& surface = *pair.base.faces[edge.faces[side]].surface;
    if (of_lines) {
      const double distance = (placed.origin - surface.point()).dot(surface.axis());
      const double slope = placed.x.dot(surface.axis());
      const double* t = &pair.mover.sample_c[block.begin];
      for (std::uint32_t i = 0; i < count; ++i) measures[side][i] = {distance + t[i] * slope, slope, 0, 0};
      continue;
    }
    pair.measure_all(pair.seen_from(surface, placed, pair.motion.free_twist), block,
                     [&](std::uint32_t i, const Measure& m) { measures[side][i] = m; });
  }
  cost_.samples += 2 * count;
  const bool moves = when == When::now && longest > pair.motion.thresholds.slow;
  for (std::uint32_t begin = 0; begin < count; begin += feature.group) {
    const std::uint32_t size = std::min(feature.group, count - begin);
    Candidate best;
    best.gap_ahead = kOutOfReach;
    for (std::uint32_t i = begin; i < begin + size; ++i) {
      if (!may_cross(feature, measures[0][i], measures[1][i], way)) continue;
      Candidate c;
      c.group = block.begin + begin;
      c.sample = block.begin + i;
      const bool crosses = cross_segment(when, edge, size, c) ||
                           (moves && (cross_segment(When::ahead, edge, size, c) ||
                                      (pair_.motion.is_found_again && cross_segment(When::after, edge, size, c))));
      if (crosses && c.gap_ahead < best.gap_ahead) best = c;
    }
    if (best.gap_ahead == kOutOfReach) continue;
    const double curves =
        best.comes_down ? passing_of_edges(pair_, placed_, best, edge) : curving_of_edges(pair_, placed, best, edge);
    add_row(placed, best, size, static_cast<std::uint32_t>(pair.base.faces.size()) + e, curves);
  }
}

/// What part of a group's stiffness a crossing has. Where the group lies on one of the faces to rounding, the crossing
/// is the end of what touches there, and has an end's share.
double Search::share_of_crossing(const Candidate& c, double length) const {
  const double share = share_of_end(1, 1);
  return share + (1 - share) * std::min(1.0, c.descent * length / pair_.motion.thresholds.coincident);
}

/// The crossing of a candidate's segment with an edge. That after the step is looked at from where it is now: its gap
/// is such that the motion which is assumed leads to it. @returns whether there is one
bool Search::cross_segment(When when, const ExactEdge& edge, std::uint32_t count, Candidate& c) {
  const BodyPair pair = pair_at(when);
  const PlacedFeature placed = when == When::now ? placed_ : placed_by(pair.motion.now, *placed_.feature);
  cost_.closest_places += 2;
  if (!cross_edge(pair, placed, edge, closest_places_to(pair, placed, edge, c.sample), c)) return false;
  c.comes_down = when != When::now;
  if (c.comes_down) {
    const RelativeMotion& motion = pair_.motion;
    c.p = placed_.point(c.place);
    c.gap -= c.normal.dot(pair_.moved(c.p, when == When::ahead ? motion.free_twist : motion.during));
    if (!(c.gap > motion.thresholds.coincident) || lies_already(pair_, edge, c)) return false;
  }
  if (!is_near(placed_, count, c)) return false;
  c.weight *= share_of_crossing(c, 2 * placed_.feature->half_width * count);
  c.weight *= pair.edge_cone_weight(c.sample, c.normal);
  // What only lies along a face is deeper elsewhere.
  if (c.weight > 0 && !c.comes_down && c.descent > 0) depth_max_ = std::max(depth_max_, -c.at.distance);
  return true;
}

/// True if may_cross() would be false of all segments of a straight block: one of two planes leads at both of its ends,
/// by more than a step may change.
bool Search::is_led_all_along(const PlacedFeature& placed, const SampleBlock& block, const ExactEdge& edge,
                              double way) const {
  const auto lead_at = [&](double t) {
    const Vector3d p = placed.origin + t * placed.x;
    const AnalyticSurface& a = *pair_.base.faces[edge.faces[0]].surface;
    const AnalyticSurface& b = *pair_.base.faces[edge.faces[1]].surface;
    return (p - a.point()).dot(a.axis()) - (p - b.point()).dot(b.axis());
  };
  const double half = placed.feature->half_width;
  const double first = lead_at(pair_.mover.sample_c[block.begin] - half);
  const double last = lead_at(pair_.mover.sample_c[block.end - 1] + half);
  return first * last > 0 && std::min(std::abs(first), std::abs(last)) > 2 * way + 2 * kSlack;
}

/// False if a segment is out of reach of the faces of an edge, or one of them is farther all along it. Of its middle's
/// distances. Along a straight segment the lead of one plane over the other is linear; unless the motion that a rule
/// looks at changes it, it is zero between the ends or nowhere.
/// @param way  m, longest of a place of the segment within a step; infinite if the segment or a face is curved
bool Search::may_cross(const Feature& feature, const Measure& a, const Measure& b, double way) const {
  const RelativeMotion& motion = pair_.motion;
  const double half = feature.half_width;
  if (std::max(nearest_of(a, half, 0), nearest_of(b, half, 0)) >= motion.margin) return false;
  // A parabola's error is less than itself, and rules of motion compare what the step may change.
  const double change = half * (std::abs(a.slope - b.slope) + half * (std::abs(a.bend) + std::abs(b.bend)));
  const bool runs_along = change < motion.thresholds.coincident;
  const double lead = std::abs(a.distance - b.distance);
  return !runs_along && lead < 2 * (change + motion.margin) && lead < change + 2 * way + kSlack;
}

/// Bound of the way of a block's places within a step [m], by either of the motions that the rules of ownership look
/// at.
double Search::longest_way(const PlacedFeature& placed, const SampleBlock& block) const {
  if (placed.is_arc()) {
    double way = 0;
    for (const Twist* twist : {&pair_.motion.free_twist, &pair_.motion.last_twist})
      way = std::max(
          way, pair_.moved(placed.origin, *twist).norm() + pair_.motion.dt * twist->angular.norm() * placed.x.norm());
    return way;
  }
  const double first = pair_.mover.sample_c[block.begin] - placed.feature->half_width;
  const double last = pair_.mover.sample_c[block.end - 1] + placed.feature->half_width;
  double way = 0;  // it is convex along the block: the longest is that of an end
  for (const Twist* twist : {&pair_.motion.free_twist, &pair_.motion.last_twist})
    for (const double c : {first, last})
      way = std::max(way, pair_.moved(placed.origin + c * placed.x, *twist).squaredNorm());
  return std::sqrt(way);
}

}  // namespace verisim::exact

#include "engine/exact/edge_ownership.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/exact/edge_crossing.hpp"

namespace verisim::exact {
namespace {

constexpr double kHardly = 0.01;  ///< of the depth below a face: the depth below another that says nothing of the first

/// True if a point lies beyond a smooth edge, seen from the face.
bool is_beyond(const ExactEdge& edge, std::uint32_t face, const Vector3d& p) {
  const ExactEdge::Mark* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const ExactEdge::Mark& mark : edge.marks) {
    const double distance = (mark.point - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = &mark;
  }
  return nearest != nullptr && nearest->outward[edge.faces[0] == face ? 0 : 1].dot(p - nearest->point) > 0;
}

/// The place of an edge that is nearest to a point whose foot on the face across is known.
Vector3d nearest_on(const ExactEdge& edge, const Vector3d& foot) {
  if (edge.extent != ExactEdge::Extent::line) return foot;
  return edge.center + std::clamp(edge.direction.dot(foot - edge.center), -edge.half, edge.half) * edge.direction;
}

/// m, from a point to a straight edge or arc, if what is nearest of it is not an end; else infinite.
double distance_to(const ExactEdge& edge, const Vector3d& p) {
  if (edge.extent == ExactEdge::Extent::all) return kOutOfReach;
  const Vector3d d = p - edge.center;
  const double a = edge.direction.dot(d);
  if (edge.extent == ExactEdge::Extent::line)
    return std::abs(a) < edge.half ? (d - a * edge.direction).norm() : kOutOfReach;
  const double b = edge.perpendicular.dot(d);
  const double radial = std::sqrt(a * a + b * b);
  if (!(a > edge.half * radial)) return kOutOfReach;
  const double off = radial - (edge.ends[0] - edge.center).norm();
  return std::sqrt(std::max(0.0, d.squaredNorm() - radial * radial) + off * off);
}

/// True if a place lies on that side of an edge on which the face is not. Asked of straight edges of curved faces: the
/// side of a pin opposite its key is behind a side of the key, too, but not beyond the key's edge.
bool is_beyond_edge(const ExactBody& base, const ExactEdge& edge, std::uint32_t face, const Vector3d& p) {
  const AnalyticSurface& surface = *base.faces[face].surface;
  if (edge.extent != ExactEdge::Extent::line || surface.kind() == SurfaceKind::plane) return true;
  const Vector3d place = nearest_on(edge, p);
  const Vector3d n = surface.at(place).normal;
  const Vector3d wall = base.faces[face_across(edge, face)].surface->at(place).normal;
  return (p - place).dot(wall - wall.dot(n) * n) < 0;
}

/// True if a place lies behind the face across a concave edge by more than `more` [m], and within the edge's extent:
/// beyond its end the face goes on.
bool is_behind(const ExactBody& base, const ExactEdge& edge, std::uint32_t face, const Vector3d& p, double distance,
               double more) {
  return distance < -more && edge.limits_face_at(face, p, 0) && is_beyond_edge(base, edge, face, p);
}

/// True if the curve ends at the place, at a concave corner: a convex one is a feature of its own.
bool ends_at_concave_corner(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c) {
  const Feature& feature = *placed.feature;
  if (feature.half_width == 0 || std::abs(c.place.t) < feature.half_width || feature.goes_on(c.sample, c.place.t))
    return false;
  const Vector3d end = feature.origin + c.place.c * feature.x + c.place.s * feature.y;
  return std::none_of(pair.mover.features.begin(), pair.mover.features.end(), [&](const Feature& f) {
    return f.kind == Feature::Kind::point && f.own_face == kNoFace &&
           (f.origin - end).norm() <= pair.mover.options.same_corner;
  });
}

/// True if a curve that ends at the place, where it has not yet entered the face, comes nearer to the other one the
/// farther it is from its end: that face has its row there, and nothing to push this end with. What lies along the
/// other one to rounding is held at its end as well.
bool falls_from_end(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const SurfaceAt& other) {
  const double coincident = pair.motion.thresholds.coincident;
  return c.at.distance > -coincident && 2 * c.place.t * other.normal.dot(placed.tangent(c.place)) > coincident &&
         ends_at_concave_corner(pair, placed, c);
}

/// True if the face's distance goes on falling beyond the end of the sample's segment at which the place lies, and the
/// curve crosses the edge to the face across near there: then the neighbouring segment has a better place for it, or
/// the crossing. What runs along the edge is held all along it. At a concave corner there is no neighbour.
bool falls_beyond_segment(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                          const SurfaceAt& other) {
  const double width = 2 * placed.feature->half_width;
  if (std::abs(c.place.t) < placed.feature->half_width) return false;
  const Vector3d tangent = placed.tangent(c.place);
  const double fall = std::abs(c.at.normal.dot(tangent)) * width;
  const double lead = std::abs(c.at.distance - other.distance);
  return fall > pair.motion.thresholds.coincident && lead < 2 * (fall + std::abs(other.normal.dot(tangent)) * width) &&
         !ends_at_concave_corner(pair, placed, c);
}

/// True if the foot of a place that is now beyond the borders will be within them after the step, without contact or as
/// the step was found to go: so a wall that comes to a cone's tip from the side is met before it is inside. What is
/// behind the face's surface already comes to it through another face, and what lies on another one does not fall
/// beside it.
bool comes_onto_face(const BodyPair& pair, std::uint32_t face, const Candidate& c) {
  if (-c.at.distance > pair.motion.overlap + pair.motion.thresholds.touching) return false;
  const AnalyticSurface& surface = *pair.base.faces[face].surface;
  const double reach = pair.base.faces[face].trim->reach_outside();
  const auto comes_by = [&](const Twist& twist) {
    const Vector3d way = pair.moved(c.p, twist);
    if (way.squaredNorm() < reach * reach) return false;
    const Vector3d after = c.p + way;
    const SurfaceAt there = surface.at(after);
    const Vector3d foot = after - there.distance * there.normal;
    return is_on_face(pair.base, face, foot) && !lies_across(pair, face, foot, c, kNoFace);
  };
  return comes_by(pair.motion.free_twist) || (pair.motion.is_found_again && comes_by(pair.motion.during));
}

/// True if a place behind a face came in through another one, the wall: on the straight way to its foot it enters
/// there, or it has hardly entered there and the wall can push it out. Its depth below the face is then of no meaning.
/// So a place above a thin plate, or just within it, is not a deep place of its far side.
bool comes_through(const BodyPair& pair, const Candidate& c, std::uint32_t other, const Vector3d& foot) {
  const AnalyticSurface& wall = *pair.base.faces[other].surface;
  const SurfaceAt before = wall.at(c.p);
  if (!(before.distance > 0)) {
    const double entered = pair.motion.overlap + pair.motion.thresholds.touching;
    return before.distance > -entered && before.distance > kHardly * c.at.distance &&
           pair.normal_cone_weight(c.sample, before.normal) >= 1 &&
           is_on_face(pair.base, other, c.p - before.distance * before.normal);
  }
  if (!(wall.at(foot).distance < 0)) return false;
  Vector3d outside = c.p, inside = foot;  // where the way comes in, to a thousandth of it
  for (int i = 0; i < 10; ++i) {
    const Vector3d middle = 0.5 * (outside + inside);
    (wall.at(middle).distance > 0 ? outside : inside) = middle;
  }
  const SurfaceAt there = wall.at(inside);
  return is_on_face(pair.base, other, inside - there.distance * there.normal);
}

bool comes_through_another(const BodyPair& pair, const Candidate& c, std::uint32_t face, const Vector3d& foot) {
  for (std::uint32_t other = 0; other < pair.base.faces.size(); ++other)
    if (other != face && pair.base.faces[other].surface && comes_through(pair, c, other, foot)) return true;
  return false;
}

/// True if a ball's contact point, as far below the surface as the ball is wide, is beyond a pin's axis: it is outside
/// again, or below the other side.
bool is_on_other_side(const AnalyticSurface& surface, const Candidate& touching) {
  return surface.is_convex() && surface.at(touching.p).normal.dot(touching.at.normal) < 0;
}

/// True if a ball's contact point lies on the face that the ball belongs to, to a tenth of what counts as on it,
/// whatever the step: its normal is across the curve, to sigma. The point, r sigma along the curve, is then no farther
/// from a tube of radius r round a circle of radius R than r sigma^2 R / (R - r). A cone's ball touches at a slope.
bool is_across(const PlacedFeature& placed, const Candidate& c, double near) {
  const Feature& feature = *placed.feature;
  if (feature.half_width == 0) return true;  // the middle of a ball
  if (feature.radius_slope != 0) return false;
  const double r = feature.radius;
  const Vector3d tangent = placed.tangent(c.place);
  const double along = c.at.normal.dot(tangent);
  const double R2 = tangent.squaredNorm();
  if (!placed.is_arc()) return r * along * along <= near * R2;
  const double R = std::sqrt(R2);
  return r * along * along <= near * R * (R - r);
}

/// How far a ball's contact point lies from the face that the ball belongs to [m]: the least within the step, for a
/// body that tilts comes down on other places than now.
double off_own_face(const BodyPair& pair, const PlacedFeature& placed, const AnalyticSurface& surface,
                    const Candidate& c) {
  const Feature& feature = *placed.feature;
  const AnalyticSurface& own = *pair.mover.faces[feature.own_face].surface;
  const Matrix3d to_mover = pair.motion.now.R.transpose();
  const Vector3d place = to_mover * (c.p - pair.motion.now.p);
  const auto off = [&](const Vector3d& normal) {
    return std::abs(own.at(place - feature.radius_at(c.place.c) * (to_mover * normal)).distance);
  };
  // The normal that the place meets where the step takes it, turned back to where the mover is now.
  const RelativeMotion& motion = pair.motion;
  const Vector3d there =
      feature.half_width > 0 ? surface.at(c.p + pair.moved(c.p, motion.free_twist)).normal : c.at.normal;
  const Vector3d after = there - motion.dt * motion.free_twist.angular.cross(there);
  const Vector3d tangent = placed.tangent(c.place);
  const double slope = c.at.normal.dot(tangent) - feature.radius_slope;
  const double slope_after = after.dot(tangent) - feature.radius_slope;
  if (feature.half_width > 0 && slope * slope_after < 0) return 0;
  return std::min(off(c.at.normal), off(after.normalized()));
}

/// How a place above a face comes down beside the one across an edge: over this face, past it, or neither. Of several
/// edges the first of these that is true of one counts.
enum class Slide : std::uint8_t { over, past, free };

/// What was led along the other face's border is pressed into it, no deeper than these bodies are. If that one can push
/// it, it goes past, and does not catch on an edge that it overlaps by nanometres.
Slide slide_past(const BodyPair& pair, const Candidate& c, const SurfaceAt& there) {
  constexpr double kRounding = 1e-9;  // m
  const double coincident = pair.motion.thresholds.coincident;
  if (there.distance < -pair.base.options.beyond_end) return Slide::free;  // that edge is far away
  if (there.distance < -pair.motion.overlap - kRounding) return Slide::over;
  const bool is_pressed =
      there.distance <= 0 ||
      (there.distance < kRounding && there.distance + there.normal.dot(pair.moved(c.p, pair.motion.free_twist)) <= 0);
  const bool is_pushed =
      is_pressed && c.at.distance > -coincident && pair.normal_cone_weight(c.sample, there.normal) >= 1;
  return is_pushed ? Slide::past : Slide::free;
}

/// What a face keeps of a place that the face across a convex edge owns: from 0, nothing, to 1. The face across can
/// push only along normals of the mover's normal cone; where its own is outside of that cone, and so is that of edge
/// against edge, nothing would push at all, and the place stays with this face; so does one flush with the face across.
double kept_share(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge, std::uint32_t face,
                  const SurfaceAt& there, const Candidate& c) {
  // A place that was inside of this face before, by more than these bodies are pressed into each other, did not come
  // through it: its own depth is of no meaning here.
  const double came = std::max(0.0, -c.at.normal.dot(pair.moved(c.p, pair.motion.last_twist))) + pair.motion.overlap;
  if (-c.at.distance > came + pair.motion.thresholds.touching) return 0;
  double least = compared_distances(pair, c.p, c.at, there).other;
  // At the end of a step that stopped it a place may lie on the edge to rounding, and go on in the next.
  if (c.at.distance > -pair.motion.thresholds.coincident)
    least = std::min(least, there.distance + there.normal.dot(pair.moved(c.p, pair.motion.last_twist)));
  const double depth = -least;
  const double taken = falls_from_end(pair, placed, c, there) ? 0 : pair.normal_cone_weight(c.sample, there.normal);
  if (taken >= 1 || depth <= -pair.motion.thresholds.coincident || falls_beyond_segment(pair, placed, c, there))
    return 0;
  std::array<Place, 2> near = {c.place, c.place};
  const std::size_t across = edge.faces[0] == face ? 1 : 0;
  near[across] = closest_place_to(pair, *pair.base.faces[edge.faces[across]].surface, placed, c.sample);
  Candidate crossed = c;
  const double by_edge =
      cross_edge(pair, placed, edge, near, crossed) ? pair.edge_cone_weight(crossed.sample, crossed.normal) : 0;
  return 1 - std::max(taken, by_edge);
}

}  // namespace

bool is_on_face(const ExactBody& base, std::uint32_t face, const Vector3d& foot) {
  if (base.faces[face].trim->is_whole()) return true;
  const Trim::Answer answer = base.faces[face].trim->find(*base.faces[face].surface, foot);
  if (answer.where != Trim::Where::border) return answer.where == Trim::Where::inside;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = base.edges[e];
    if (edge.convexity == Convexity::smooth) {
      if (is_beyond(edge, face, foot)) return false;
    } else {
      const SurfaceAt there = base.faces[face_across(edge, face)].surface->at(foot);
      if (!edge.limits_face_at(face, foot, there.distance)) continue;
      const bool is_off = edge.convexity == Convexity::convex ? there.distance > 0
                                                              : is_behind(base, edge, face, foot, there.distance, 0);
      if (is_off && !is_hidden(base, face, answer.edges, e, foot, there)) return false;
    }
  }
  return true;
}

bool is_hidden(const ExactBody& base, std::uint32_t face, std::span<const std::uint32_t> edges, std::uint32_t e,
               const Vector3d& p, const SurfaceAt& across) {
  constexpr double kBeyond = 1e-6;  // m: what is nearer to a wall lies on it
  const ExactEdge& edge = base.edges[e];
  const Vector3d place = nearest_on(edge, p - across.distance * across.normal);
  for (const std::uint32_t n : edges) {
    const ExactEdge& nearer = base.edges[n];
    if (n == e || nearer.convexity == Convexity::smooth) continue;
    const AnalyticSurface& wall = *base.faces[face_across(nearer, face)].surface;
    const double here = wall.at(p).distance;
    const double side = nearer.convexity == Convexity::convex ? -1 : 1;  // of the wall's distance: where the face is
    if (side * here > kBeyond && distance_to(nearer, p) < (p - place).norm() - kBeyond) return true;
    if (!(std::abs(here) < std::abs(across.distance)) || !nearer.limits_face_at(face, p, here)) continue;
    const auto is_beyond = [&](const Vector3d& x) { return side * wall.at(x).distance < -kBeyond; };
    if (!is_beyond(place)) continue;
    const bool faces_each_other =
        edge.extent == ExactEdge::Extent::line && is_beyond(edge.ends[0]) && is_beyond(edge.ends[1]);
    if (side * here >= -kBeyond || faces_each_other) return true;
  }
  return false;
}

OwnershipRule ownership_rule(double a, double b, double coincident) {
  if (a >= 0 && b >= 0) return OwnershipRule::by_free_motion;
  return std::max(a, b) >= 0 && std::min(a, b) > -coincident ? OwnershipRule::by_last_motion
                                                             : OwnershipRule::by_position;
}

std::uint32_t face_across(const ExactEdge& edge, std::uint32_t face) {
  return edge.faces[0] == face ? edge.faces[1] : edge.faces[0];
}

ComparedDistances compared_by(const BodyPair& pair, OwnershipRule rule, const Vector3d& p, const SurfaceAt& mine,
                              const SurfaceAt& other) {
  if (rule == OwnershipRule::by_position) return {mine.distance, other.distance};
  const Vector3d step =
      pair.moved(p, rule == OwnershipRule::by_free_motion ? pair.motion.free_twist : pair.motion.last_twist);
  return {mine.distance + mine.normal.dot(step), other.distance + other.normal.dot(step)};
}

ComparedDistances compared_distances(const BodyPair& pair, const Vector3d& p, const SurfaceAt& mine,
                                     const SurfaceAt& other) {
  const OwnershipRule rule = ownership_rule(mine.distance, other.distance, pair.motion.thresholds.coincident);
  return compared_by(pair, rule, p, mine, other);
}

bool owns_point(const BodyPair& pair, const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other, bool wins_tie) {
  const ComparedDistances at = compared_distances(pair, p, mine, other);
  return at.mine > at.other || (at.mine == at.other && wins_tie);
}

bool lies_across(const BodyPair& pair, std::uint32_t face, const Vector3d& foot, const Candidate& c,
                 std::uint32_t except) {
  const auto& faces = pair.base.faces;
  const Trim::Answer answer = faces[face].trim->find(*faces[face].surface, foot);
  return std::any_of(answer.edges.begin(), answer.edges.end(), [&](std::uint32_t e) {
    const ExactEdge& edge = pair.base.edges[e];
    const std::uint32_t other = face_across(edge, face);
    if (edge.convexity != Convexity::convex || other == except) return false;
    const SurfaceAt there = faces[other].surface->at(c.p);
    return std::abs(there.distance) < pair.motion.thresholds.coincident &&
           pair.normal_cone_weight(c.sample, there.normal) >= 1 && edge.limits_face_at(face, c.p, there.distance);
  });
}

bool accept_candidate(const BodyPair& pair, const PlacedFeature& placed, std::uint32_t face, Candidate& c) {
  VERISIM_ASSERT(face < pair.base.faces.size());
  VERISIM_ASSERT(is_unit(c.at.normal));
  const Feature& feature = *placed.feature;
  const Vector3d foot = c.p - c.at.distance * c.at.normal;
  if (feature.own_face != kNoFace) {
    Candidate touching = c;
    touching.p -= feature.radius_at(c.place.c) * c.at.normal;
    touching.at.distance = c.gap;
    if (c.gap < -kThinnest && (is_on_other_side(*pair.base.faces[face].surface, touching) ||
                               comes_through_another(pair, touching, face, foot)))
      return false;
    const Vector3d contact_point = pair.motion.now.R.transpose() * (touching.p - pair.motion.now.p);
    const SearchThresholds& fade = pair.motion.thresholds;
    if (is_across(placed, c, 0.1 * fade.own_face_full)) {
      c.weight = 1;
    } else {
      const double off = off_own_face(pair, placed, *pair.base.faces[face].surface, c);
      c.weight = std::min(1.0, (fade.own_face_none - off) / (fade.own_face_none - fade.own_face_full));
    }
    return c.weight > 0 && is_on_face(pair.base, face, foot) && is_on_face(pair.mover, feature.own_face, contact_point);
  }
  const Trim::Answer answer = pair.base.faces[face].trim->find(*pair.base.faces[face].surface, foot);
  if (answer.where == Trim::Where::outside) return comes_onto_face(pair, face, c);
  if (c.at.distance < -kThinnest && comes_through_another(pair, c, face, foot)) return false;
  Slide slides = Slide::free;
  // Beside the border the foot is off the face: only an edge that it lies beyond can say that the face owns it.
  bool is_limited = answer.where != Trim::Where::beside;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = pair.base.edges[e];
    const std::uint32_t other = face_across(edge, face);
    if (edge.convexity == Convexity::smooth && is_beyond(edge, face, foot)) return false;
    if (edge.convexity == Convexity::smooth) continue;
    const SurfaceAt there = pair.base.faces[other].surface->at(c.p);
    if (!edge.limits_face_at(face, c.p, there.distance)) continue;
    const bool is_convex = edge.convexity == Convexity::convex;
    // Far behind the face across: if the wall there is thin, the place is outside of the body, on its far side.
    const bool is_mine = is_convex ? owns_point(pair, c.p, c.at, there, face < other)
                                   : !is_behind(pair.base, edge, face, c.p, there.distance, pair.motion.margin);
    const bool counts = !is_limited && (is_convex || there.distance < 0);
    if ((!is_mine || counts) && is_hidden(pair.base, face, answer.edges, e, c.p, there)) continue;
    is_limited = is_limited || counts;
    if (is_mine && is_convex) slides = std::min(slides, slide_past(pair, c, there));
    if (is_mine) continue;
    if (!is_convex) return false;
    c.weight *= kept_share(pair, placed, edge, face, there, c);
    if (!(c.weight > 0)) return false;
  }
  return is_limited ? slides != Slide::past : comes_onto_face(pair, face, c);
}

}  // namespace verisim::exact

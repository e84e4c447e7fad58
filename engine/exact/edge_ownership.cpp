#include "engine/exact/edge_ownership.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::exact {
namespace {

constexpr double kSameDistance =
    1e-12;  // m, no heuristic but rounding, of two faces: a tenth of what double precision says of a body of metres

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

/// True if a point of a face's surface lies within the face.
bool is_on_face(const ExactBody& body, std::uint32_t face, const Vector3d& foot) {
  const Trim::Answer answer = body.faces[face].trim->find(*body.faces[face].surface, foot);
  if (answer.edges.empty()) return answer.where == Trim::Where::inside;
  bool is_limited = false;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = body.edges[e];
    if (edge.convexity == Convexity::smooth) {
      if (is_beyond(edge, face, foot)) return false;
    } else {
      const double distance = body.faces[face_across(edge, face)].surface->at(foot).distance;
      if (!edge.limits_face_at(face, foot, distance)) continue;
      if (edge.convexity == Convexity::convex ? distance > 0 : distance < 0) return false;
      is_limited = true;
    }
  }
  return is_limited || answer.where == Trim::Where::border;
}

ComparedDistances compared_by(const BodyPair& pair, OwnershipRule rule, const Vector3d& p, const SurfaceAt& mine,
                              const SurfaceAt& other) {
  if (rule == OwnershipRule::by_position) return {mine.distance, other.distance};
  const Vector3d step =
      pair.moved(p, rule == OwnershipRule::by_free_motion ? pair.motion.free_twist : pair.motion.last_twist);
  return {mine.distance + mine.normal.dot(step), other.distance + other.normal.dot(step)};
}

Place closest_place_to(const BodyPair& pair, const AnalyticSurface& surface, const PlacedFeature& placed,
                       std::uint32_t sample) {
  return closest_place(pair.seen_from(surface, placed, pair.motion.free_twist), pair.mover.sample_c[sample],
                       pair.mover.sample_s[sample], placed.feature->half_width);
}

/// The faces a and b of a convex edge, their distances compared by one rule, whatever the place.
class ComparedFaces {
 public:
  ComparedFaces(const BodyPair& pair, std::uint32_t a, std::uint32_t b, OwnershipRule rule)
      : pair_(pair), a_(a), b_(b), rule_(rule) {}

  struct At {
    SurfaceAt a, b;
    double lead;  ///< m: by how much face a is compared as farther than face b; above 0 it owns the place
  };
  [[nodiscard]] At at(const Vector3d& p) const {
    At at{surface(a_).at(p), surface(b_).at(p), 0};
    const ComparedDistances compared = compared_by(pair_, rule_, p, at.a, at.b);
    at.lead = compared.mine - compared.other;
    return at;
  }

  /// True if a place of the edge, where both are compared as equally far, lies within either face and inside of every
  /// third face that shares a convex edge with one of them.
  [[nodiscard]] bool are_outermost(const Vector3d& p) const {
    return is_outermost(p, a_, b_) && is_outermost(p, b_, a_);
  }

 private:
  [[nodiscard]] const AnalyticSurface& surface(std::uint32_t face) const { return *pair_.base.faces[face].surface; }

  [[nodiscard]] bool is_outermost(const Vector3d& p, std::uint32_t face, std::uint32_t other) const {
    const SurfaceAt here = surface(face).at(p);
    const Trim::Answer answer = pair_.base.faces[face].trim->find(surface(face), p - here.distance * here.normal);
    for (const std::uint32_t e : answer.edges) {
      const ExactEdge& edge = pair_.base.edges[e];
      const std::uint32_t third = face_across(edge, face);
      if (edge.convexity != Convexity::convex || third == other) continue;
      const SurfaceAt there = surface(third).at(p);
      const ComparedDistances compared = compared_by(pair_, rule_, p, here, there);
      if (compared.other > compared.mine && edge.limits_face_at(face, p, there.distance)) return false;
    }
    return answer.where != Trim::Where::outside;
  }

  const BodyPair& pair_;
  std::uint32_t a_, b_;
  OwnershipRule rule_;
};

/// The place where the sample's segment crosses the edge between two faces: there both distances are equal, as a rule
/// compares them, and the contact normal is perpendicular to both curves. If there is one, changes `c` into it and
/// returns true.
/// @param near_b  the segment's place that is closest to the other face
bool cross_edge_by(const ComparedFaces& faces, const BodyPair& pair, const PlacedFeature& placed, const Place& near_b,
                   Candidate& c) {
  double t_a = c.place.t;  // here b owns the place
  double t_b = near_b.t;   // here a should
  double d_a = faces.at(c.p).lead;
  double d_b = faces.at(placed.point(near_b)).lead;
  if (!(d_a < 0 && d_b > 0)) return false;
  ComparedFaces::At at{};
  constexpr int kStepsMax = 30;          // a bound of the work: about six are needed
  for (int i = 0; i < kStepsMax; ++i) {  // false position, with the Illinois rule
    const double t = t_a + (t_b - t_a) * (d_a / (d_a - d_b));
    c.place = place_at(placed.is_arc(), pair.mover.sample_c[c.sample], pair.mover.sample_s[c.sample], t);
    c.p = placed.point(c.place);
    at = faces.at(c.p);
    if (std::abs(at.lead) < kSameDistance) break;
    if (at.lead < 0) {
      t_a = t;
      d_a = at.lead;
      d_b *= 0.5;
    } else {
      t_b = t;
      d_b = at.lead;
      d_a *= 0.5;
    }
  }
  c.at = at.a;
  // The blend of both normals that is perpendicular to the segment.
  const Vector3d tangent = placed.tangent(c.place);
  const double slope_a = at.a.normal.dot(tangent);
  const double slope_b = at.b.normal.dot(tangent);
  if (slope_a * slope_b >= 0) return false;
  const double weight_a = slope_b / (slope_b - slope_a);
  const Vector3d mixed = weight_a * at.a.normal + (1 - weight_a) * at.b.normal;
  const double length = mixed.norm();
  if (length < pair.motion.thresholds.blade) return false;
  c.normal = mixed / length;
  c.gap = (weight_a * at.a.distance + (1 - weight_a) * at.b.distance) / length;
  c.edge_fraction = 4 * weight_a * (1 - weight_a);
  // A place that is outside by position is no overlap, whatever the edge by motion says of it.
  const double farthest = std::max(at.a.distance, at.b.distance);
  if (c.gap * length < std::min(0.0, farthest) - pair.motion.thresholds.coincident) return false;
  return c.gap > -pair.base.options.spacing && faces.are_outermost(c.p);
}

/// The crossing by position, or else by the rule of the candidate's place or, where that is the position's, of the
/// place that is closest to the other face: a segment may come to the edge within the step, or slide along one of the
/// faces towards it.
bool cross_edge(const BodyPair& pair, const PlacedFeature& placed, std::uint32_t face, std::uint32_t other,
                Candidate& c) {
  if (placed.feature->half_width == 0) return false;
  const AnalyticSurface& a = *pair.base.faces[face].surface;
  const AnalyticSurface& b = *pair.base.faces[other].surface;
  const Place near_b = closest_place_to(pair, b, placed, c.sample);
  const auto rule_at = [&](const Vector3d& p) {
    return ownership_rule(a.at(p).distance, b.at(p).distance, pair.motion.thresholds.coincident);
  };
  const OwnershipRule here = rule_at(c.p);
  const OwnershipRule by_motion = here == OwnershipRule::by_position ? rule_at(placed.point(near_b)) : here;
  for (const OwnershipRule rule : {OwnershipRule::by_position, by_motion}) {
    Candidate crossed = c;
    if (!cross_edge_by(ComparedFaces(pair, face, other, rule), pair, placed, near_b, crossed)) continue;
    c = crossed;
    return true;
  }
  return false;
}

/// Which of the two faces of an edge finds the places where a segment crosses it, so that one does: the one that the
/// search does not leave out for seeing the segment from behind, and of two the first.
bool finds_crossing(const BodyPair& pair, std::uint32_t sample, std::uint32_t face, std::uint32_t other) {
  const auto sees = [&](std::uint32_t f) {
    const AnalyticSurface& surface = *pair.base.faces[f].surface;
    return surface.kind() != SurfaceKind::plane || pair.normal_cone_weight(sample, surface.axis()) > 0;
  };
  return sees(face) == sees(other) ? face < other : sees(face);
}

/// True if the face's distance goes on falling beyond the end of the sample's segment at which the place lies: then the
/// neighbouring segment has a better place for it, or an edge of the base that the curve crosses there.
bool falls_beyond_segment(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c) {
  const double width = 2 * placed.feature->half_width;
  if (std::abs(c.place.t) < placed.feature->half_width) return false;
  return std::abs(c.at.normal.dot(placed.tangent(c.place))) * width > pair.motion.thresholds.coincident;
}

/// True if the foot of a place that is now beyond the borders will be within them after the step without contact: so a
/// wall that comes to a cone's tip from the side is met before it is inside.
bool comes_onto_face(const BodyPair& pair, std::uint32_t face, const Vector3d& p) {
  const AnalyticSurface& surface = *pair.base.faces[face].surface;
  const Vector3d after = p + pair.moved(p, pair.motion.free_twist);
  const SurfaceAt there = surface.at(after);
  return is_on_face(pair.base, face, after - there.distance * there.normal);
}

/// What a face keeps of a place that the face across a convex edge owns: from 0, nothing, to 1. The face across can
/// push only along normals of the mover's normal cone; where its own is outside of that cone, and so is that of edge
/// against edge, nothing would push at all, and the place stays with this face.
double kept_share(const BodyPair& pair, const PlacedFeature& placed, std::uint32_t face, std::uint32_t other,
                  const SurfaceAt& there, const Candidate& c) {
  // A place that was inside of this face before did not come through it: its own depth is of no meaning here.
  const double came = std::max(0.0, -c.at.normal.dot(pair.moved(c.p, pair.motion.last_twist)));
  if (-c.at.distance > came + pair.motion.thresholds.touching) return 0;
  double least = compared_distances(pair, c.p, c.at, there).other;
  // At the end of a step that stopped it a place may lie on the edge to rounding, and go on in the next.
  if (c.at.distance > -pair.motion.thresholds.coincident)
    least = std::min(least, there.distance + there.normal.dot(pair.moved(c.p, pair.motion.last_twist)));
  const double depth = -least;
  const double taken = pair.normal_cone_weight(c.sample, there.normal);
  if (taken >= 1 || depth <= pair.motion.thresholds.coincident || falls_beyond_segment(pair, placed, c)) return 0;
  Candidate crossed = c;
  const double by_edge =
      cross_edge(pair, placed, face, other, crossed) ? pair.normal_cone_weight(crossed.sample, crossed.normal) : 0;
  return 1 - std::max(taken, by_edge);
}

}  // namespace

OwnershipRule ownership_rule(double a, double b, double coincident) {
  if (a >= 0 && b >= 0) return OwnershipRule::by_free_motion;
  return std::max(a, b) >= 0 && std::min(a, b) > -coincident ? OwnershipRule::by_last_motion
                                                             : OwnershipRule::by_position;
}

std::uint32_t face_across(const ExactEdge& edge, std::uint32_t face) {
  return edge.faces[0] == face ? edge.faces[1] : edge.faces[0];
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

bool accept_candidate(const BodyPair& pair, const PlacedFeature& placed, std::uint32_t face, Candidate& c) {
  VERISIM_ASSERT(face < pair.base.faces.size());
  VERISIM_ASSERT(is_unit(c.at.normal));
  const Feature& feature = *placed.feature;
  const Vector3d foot = c.p - c.at.distance * c.at.normal;
  if (feature.own_face != kNoFace) {
    const Vector3d contact_point =
        pair.motion.R.transpose() * (c.p - feature.radius_at(c.place.c) * c.at.normal - pair.motion.p);
    const double off_own_face = std::abs(pair.mover.faces[feature.own_face].surface->at(contact_point).distance);
    const SearchThresholds& fade = pair.motion.thresholds;
    c.weight = std::min(1.0, (fade.own_face_none - off_own_face) / (fade.own_face_none - fade.own_face_full));
    return c.weight > 0 && is_on_face(pair.base, face, foot) && is_on_face(pair.mover, feature.own_face, contact_point);
  }
  const Trim::Answer answer = pair.base.faces[face].trim->find(*pair.base.faces[face].surface, foot);
  if (answer.where == Trim::Where::outside) return comes_onto_face(pair, face, c.p);
  bool is_limited = answer.where != Trim::Where::beside;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = pair.base.edges[e];
    const std::uint32_t other = face_across(edge, face);
    if (edge.convexity == Convexity::smooth && is_beyond(edge, face, foot)) return false;
    if (edge.convexity == Convexity::smooth) continue;
    const SurfaceAt there = pair.base.faces[other].surface->at(c.p);
    if (!edge.limits_face_at(face, c.p, there.distance)) continue;
    is_limited = true;
    if (edge.convexity == Convexity::concave) {
      // Far behind the face across: if the wall there is thin, the place is outside of the body, on its far side.
      if (there.distance < -pair.motion.margin) return false;
      continue;
    }
    if (owns_point(pair, c.p, c.at, there, face < other)) continue;
    const double kept = kept_share(pair, placed, face, other, there, c);
    if (!(kept > 0)) return finds_crossing(pair, c.sample, face, other) && cross_edge(pair, placed, face, other, c);
    c.weight *= kept;
  }
  return is_limited;
}

}  // namespace verisim::exact

#include "engine/exact/edge_crossing.hpp"

#include <cmath>
#include <optional>

#include "engine/exact/edge_ownership.hpp"

namespace verisim::exact {
namespace {

constexpr double kSameDistance =
    1e-12;  // m, no heuristic but rounding, of two faces: a tenth of what double precision says of a body of metres

/// The faces a and b of a convex edge of the base, their distances compared by one rule, whatever the place.
class ComparedFaces {
 public:
  ComparedFaces(const BodyPair& pair, const ExactEdge& edge, OwnershipRule rule)
      : pair_(pair), edge_(edge), a_(edge.faces[0]), b_(edge.faces[1]), rule_(rule) {}

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
  /// third face that shares a convex edge with one of them. @param c  its place p, of the mover's sample
  [[nodiscard]] bool are_outermost(const Candidate& c) const {
    return is_outermost(c, a_, b_) && is_outermost(c, b_, a_);
  }

 private:
  [[nodiscard]] const AnalyticSurface& surface(std::uint32_t face) const { return *pair_.base.faces[face].surface; }

  [[nodiscard]] bool is_outermost(const Candidate& c, std::uint32_t face, std::uint32_t other) const {
    const Vector3d& p = c.p;
    const SurfaceAt here = surface(face).at(p);
    const Trim::Answer answer = pair_.base.faces[face].trim->find(surface(face), p - here.distance * here.normal);
    for (const std::uint32_t e : answer.edges) {
      const ExactEdge& edge = pair_.base.edges[e];
      const std::uint32_t third = face_across(edge, face);
      if (edge.convexity != Convexity::convex || third == other) continue;
      const SurfaceAt there = surface(third).at(p);
      // Of what lies on the third face the rule that holds there: it may slide on.
      const bool lies = std::abs(there.distance) < pair_.motion.thresholds.coincident;
      const ComparedDistances compared =
          lies ? compared_distances(pair_, p, here, there) : compared_by(pair_, rule_, p, here, there);
      const bool leads = compared.other > compared.mine && edge.limits_face_at(face, p, there.distance);
      const bool is_inside = there.distance < -pair_.motion.overlap - pair_.motion.thresholds.touching;
      // Where the third face and the other one meet concavely, a place beyond that corner is to be outside of the
      // third; elsewhere the third is not to lead. The far side of a hole or key says nothing.
      if (leads == is_inside ? !leads : is_inside ? !is_beyond_corner(edge, face, p) : meet_concavely(edge, face))
        continue;
      if (is_hidden(pair_.base, face, answer.edges, e, p, there)) continue;
      // Nor does the third own what it cannot push: an edge that ends just inside of it, flush with it.
      const bool may_be_flush = there.distance <= 0 && here.distance > -kThinnest;
      if (!may_be_flush || pair_.normal_cone_weight(c.sample, there.normal) > 0) return false;
    }
    return answer.where != Trim::Where::outside;
  }

  /// True if the edge and another one of `face` end at a corner of it that is not convex. There the material is inside
  /// of either of the two faces across: a place leaves it through both, and none of the two owns it alone.
  [[nodiscard]] bool meet_concavely(const ExactEdge& another, std::uint32_t face) const {
    if (edge_.extent == ExactEdge::Extent::all || another.extent == ExactEdge::Extent::all) return false;
    const std::size_t side = another.faces[0] == face ? 0 : 1;
    for (std::size_t end = 0; end < 2; ++end)
      for (const Vector3d& corner : edge_.ends)
        if (!another.limits_beyond_end[side][end] &&
            (another.ends[end] - corner).norm() <= pair_.base.options.same_corner)
          return true;
    return false;
  }

  [[nodiscard]] bool is_beyond_corner(const ExactEdge& another, std::uint32_t face, const Vector3d& p) const {
    return meet_concavely(another, face) && !edge_.limits_face_at(face, p, 0);
  }

  const BodyPair& pair_;
  const ExactEdge& edge_;
  std::uint32_t a_, b_;
  OwnershipRule rule_;
};

/// True if a straight edge ends on the plane that it leaves faster: what lies there is held by what it lies on, and
/// does not stumble over the other face's side of the edge. @param a, b  of its place, from the two faces
bool lies_with_its_end(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, const ExactEdge& edge,
                       const SurfaceAt& a, const SurfaceAt& b) {
  const Vector3d tangent = placed.tangent(c.place);
  const double slope_a = a.normal.dot(tangent), slope_b = b.normal.dot(tangent);
  const bool leaves_a = std::abs(slope_a) > std::abs(slope_b);
  const double slope = leaves_a ? slope_a : slope_b;
  const SurfaceAt& at = leaves_a ? a : b;
  const std::uint32_t face = edge.faces[leaves_a ? 0 : 1];
  if (placed.is_arc() || pair.base.faces[face].surface->kind() != SurfaceKind::plane) return false;
  const Feature& feature = *placed.feature;
  const std::vector<double>& middle = pair.mover.sample_c;
  const double end =
      slope > 0 ? middle[feature.begin] - feature.half_width : middle[feature.end - 1] + feature.half_width;
  return std::abs(at.distance + (end - c.place.c) * slope) < pair.motion.thresholds.coincident;
}

/// How much farther from a plane one place of a curve may be than another [m].
double rise_along(const PlacedFeature& placed, const Vector3d& n) {
  const Feature& feature = *placed.feature;
  const double x = n.dot(placed.x), y = n.dot(placed.y);
  return placed.is_arc() ? 2 * std::sqrt(x * x + y * y)
                         : std::abs(x) * 2 * feature.half_width * (feature.end - feature.begin);
}

/// Which plane of an edge, 0 or 1, a curve lies along that crosses the edge: to what the step may close. Wherever it is
/// deepest, it is to be held where it leaves its plane's face as well, for a blow turns it over that place. -1: none.
int lies_along(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge) {
  std::array<double, 2> rise{kOutOfReach, kOutOfReach};
  for (const std::size_t side : {0, 1}) {
    const AnalyticSurface& surface = *pair.base.faces[edge.faces[side]].surface;
    if (surface.kind() == SurfaceKind::plane) rise[side] = rise_along(placed, surface.axis());
  }
  const std::size_t side = rise[0] < rise[1] ? 0 : 1;
  return rise[side] < pair.motion.margin ? static_cast<int>(side) : -1;
}

/// What part the first face has in the normal of a crossing, whose slopes along the curve are these: the blend is
/// perpendicular to the curve, or, if both are left the same way, the normal of the plane that the curve lies along.
std::optional<double> weight_of_first(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge,
                                      double slope_a, double slope_b) {
  if (slope_a * slope_b < 0) return slope_b / (slope_b - slope_a);
  const int along = lies_along(pair, placed, edge);
  if (along < 0) return std::nullopt;
  return along == 0 ? 1 : 0;
}

/// The crossing by one rule.
bool cross_edge_by(const ComparedFaces& faces, const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge,
                   const std::array<Place, 2>& near, Candidate& c) {
  double t_a = near[0].t;  // here b owns the place
  double t_b = near[1].t;  // here a should
  double d_a = faces.at(placed.point(near[0])).lead;
  double d_b = faces.at(placed.point(near[1])).lead;
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
  c.at = at.a.distance > at.b.distance ? at.a : at.b;
  // The blend of both normals that is perpendicular to the segment.
  const Vector3d tangent = placed.tangent(c.place);
  const double slope_a = at.a.normal.dot(tangent);
  const double slope_b = at.b.normal.dot(tangent);
  const std::optional<double> weight = weight_of_first(pair, placed, edge, slope_a, slope_b);
  if (!weight) return false;
  const double weight_a = *weight;
  if (lies_with_its_end(pair, placed, c, edge, at.a, at.b)) return false;
  const Vector3d mixed = weight_a * at.a.normal + (1 - weight_a) * at.b.normal;
  const double length = mixed.norm();
  if (length < pair.motion.thresholds.blade) return false;
  c.normal = mixed / length;
  c.gap = (weight_a * at.a.distance + (1 - weight_a) * at.b.distance) / length;
  c.edge_fraction = 4 * weight_a * (1 - weight_a);
  c.descent = slope_a * slope_b < 0 ? std::min(std::abs(slope_a), std::abs(slope_b)) : 0;
  // A place that is outside by position is no overlap, whatever the edge by motion says of it.
  const double farthest = std::max(at.a.distance, at.b.distance);
  if (c.gap * length < std::min(0.0, farthest) - pair.motion.thresholds.coincident) return false;
  if (!(c.gap > -pair.base.options.spacing)) return false;
  // Beside an end at a concave corner the edge goes on, as far as are_outermost() lets it: what slides along the corner
  // is a nanometre off either end, and the row is to be there before the step closes it.
  constexpr double kGoesOn = -1;
  return edge.limits_face_at(edge.faces[0], c.p, kGoesOn) && edge.limits_face_at(edge.faces[1], c.p, kGoesOn) &&
         faces.are_outermost(c);
}

}  // namespace

Place closest_place_to(const BodyPair& pair, const AnalyticSurface& surface, const PlacedFeature& placed,
                       std::uint32_t sample) {
  const double half = placed.feature->half_width;
  if (surface.kind() == SurfaceKind::plane && !placed.is_arc() && half != 0)
    return closest_place_to_plane(pair.mover.sample_c[sample], pair.mover.sample_s[sample], half,
                                  placed.x.dot(surface.axis()), kClosestPlaceGain);
  return closest_place(pair.seen_from(surface, placed, pair.motion.free_twist), pair.mover.sample_c[sample],
                       pair.mover.sample_s[sample], half);
}

std::array<Place, 2> closest_places_to(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge,
                                       std::uint32_t sample) {
  const auto near = [&](std::size_t side) {
    return closest_place_to(pair, *pair.base.faces[edge.faces[side]].surface, placed, sample);
  };
  std::array<Place, 2> places{near(0), near(1)};
  const int along = lies_along(pair, placed, edge);
  if (along < 0) return places;
  // On its plane any place is as near: it crosses on the way from that which is closest to the other face.
  const auto lies = static_cast<std::size_t>(along);
  const double half = placed.feature->half_width;
  places[lies] = place_at(placed.is_arc(), pair.mover.sample_c[sample], pair.mover.sample_s[sample],
                          places[1 - lies].t > 0 ? -half : half);
  return places;
}

bool may_cross_edge(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge) {
  constexpr double kRounding = 1e-9;  // m, of a gap: more than double precision says of bodies of kilometres
  const AnalyticSurface& a = *pair.base.faces[edge.faces[0]].surface;
  const AnalyticSurface& b = *pair.base.faces[edge.faces[1]].surface;
  if (placed.is_arc() || a.kind() != SurfaceKind::plane || b.kind() != SurfaceKind::plane) return true;
  const double slope_a = a.axis().dot(placed.x);
  const double slope_b = b.axis().dot(placed.x);
  const std::optional<double> weight = weight_of_first(pair, placed, edge, slope_a, slope_b);
  if (!weight) return false;
  const double weight_a = *weight;
  const double mixed =
      weight_a * (placed.origin - a.point()).dot(a.axis()) + (1 - weight_a) * (placed.origin - b.point()).dot(b.axis());
  const double length = (weight_a * a.axis() + (1 - weight_a) * b.axis()).norm();
  return mixed < (pair.motion.margin + kRounding) * length && mixed > -(pair.base.options.spacing + kRounding) * length;
}

bool lies_already(const BodyPair& pair, const ExactEdge& edge, const Candidate& c) {
  const std::array<SurfaceAt, 2> at{pair.base.faces[edge.faces[0]].surface->at(c.p),
                                    pair.base.faces[edge.faces[1]].surface->at(c.p)};
  const auto lies_beside = [&](std::size_t side) {
    const Vector3d foot = c.p - at[side].distance * at[side].normal;
    return lies_across(pair, edge.faces[side], foot, c, edge.faces[1 - side]);
  };
  return lies_beside(0) || lies_beside(1);
}

bool cross_edge(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge,
                const std::array<Place, 2>& near, Candidate& c) {
  if (placed.feature->half_width == 0) return false;
  const AnalyticSurface& a = *pair.base.faces[edge.faces[0]].surface;
  const AnalyticSurface& b = *pair.base.faces[edge.faces[1]].surface;
  const auto rule_at = [&](const Place& place) {
    const Vector3d p = placed.point(place);
    return ownership_rule(a.at(p).distance, b.at(p).distance, pair.motion.thresholds.coincident);
  };
  const OwnershipRule here = rule_at(near[0]);
  const OwnershipRule by_motion = here == OwnershipRule::by_position ? rule_at(near[1]) : here;
  const bool is_of_rim_and_line = placed.is_arc() == (edge.extent == ExactEdge::Extent::line);
  const auto crosses_by = [&](OwnershipRule rule, Candidate& crossed) {
    return cross_edge_by(ComparedFaces(pair, edge, rule), pair, placed, edge, near, crossed);
  };
  Candidate crossed = c, moved = c;
  if (!crosses_by(OwnershipRule::by_position, crossed)) {
    if (!crosses_by(by_motion, moved)) return false;
    crossed = moved;
  } else if (is_of_rim_and_line && crossed.at.distance > 0) {
    // Outside of both faces: a rim passes beside a straight edge if by no motion it meets it.
    if (!crosses_by(by_motion, moved) && !crosses_by(OwnershipRule::by_last_motion, moved)) return false;
  }
  c = crossed;
  return true;
}

}  // namespace verisim::exact

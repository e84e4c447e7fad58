#include "engine/exact/border.hpp"

namespace verisim::exact {
namespace {

constexpr double kSameDistance = 1e-12;  // m, of two faces: a tenth of what double precision says of a body of metres
/// Of two unit normals' mean, least length: faces that meet at less than 12 degrees are a blade, whose normal means
/// nothing.
constexpr double kBlade = 0.1;

/// On which side of a smooth edge a point lies: true if beyond it, seen from the face.
bool is_beyond(const ExactEdge& edge, std::uint32_t face, const Vector3d& p) {
  const ExactEdge::Mark* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const ExactEdge::Mark& mark : edge.marks) {
    const double distance = (mark.point - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = &mark;
  }
  return nearest != nullptr && nearest->out_of[edge.faces[0] == face ? 0 : 1].dot(p - nearest->point) > 0;
}

/// Does a point of a face's surface belong to the face?
bool is_on_face(const ExactBody& body, std::uint32_t face, const Vector3d& foot) {
  const Trim::Answer answer = body.faces[face].trim->find(*body.faces[face].surface, foot);
  if (answer.where != Trim::Where::border) return answer.where == Trim::Where::inside;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = body.edges[e];
    if (edge.fold == Fold::smooth) {
      if (is_beyond(edge, face, foot)) return false;
    } else {
      const double distance = body.faces[across(edge, face)].surface->at(foot).distance;
      if (!edge.speaks_for(face, foot, distance)) continue;
      if (edge.fold == Fold::convex ? distance > 0 : distance < 0) return false;
    }
  }
  return true;
}

Place slide_to(const Meeting& meeting, const PreciseSurface& surface, const PlacedFeature& placed,
               std::uint32_t sample) {
  return slide(meeting.seen_from(surface, placed, meeting.frame.twist), meeting.mover.sample_c[sample],
               meeting.mover.sample_s[sample], placed.feature->half_width);
}

/// Is the candidate's place, on the edge between two faces, within `face` and not beyond a third face next to it?
bool is_outermost(const Meeting& meeting, const Candidate& c, std::uint32_t face, std::uint32_t other) {
  const PreciseSurface& surface = *meeting.base.faces[face].surface;
  const Trim::Answer answer =
      meeting.base.faces[face].trim->find(surface, c.p - c.at.distance * surface.at(c.p).normal);
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = meeting.base.edges[e];
    const std::uint32_t third = across(edge, face);
    if (edge.fold != Fold::convex || third == other) continue;
    const double distance = meeting.base.faces[third].surface->at(c.p).distance;
    if (distance > c.at.distance && edge.speaks_for(face, c.p, distance)) return false;
  }
  return answer.where != Trim::Where::outside;
}

/// Looks for the place where the sample's segment crosses the edge between two faces: there both distances are equal,
/// and the contact's normal lies across both curves. Changes `c` to it and returns true if there is one.
bool cross_edge(const Meeting& meeting, const PlacedFeature& placed, std::uint32_t face, std::uint32_t other,
                Candidate& c) {
  const PreciseSurface& a = *meeting.base.faces[face].surface;
  const PreciseSurface& b = *meeting.base.faces[other].surface;
  if (placed.feature->half_width == 0) return false;
  const Place near_b = slide_to(meeting, b, placed, c.sample);
  const Vector3d p_b = placed.point(near_b);
  double t_a = c.place.t;  // here b decides
  double t_b = near_b.t;   // here a must
  double d_a = c.at.distance - b.at(c.p).distance;
  double d_b = a.at(p_b).distance - b.at(p_b).distance;
  if (!(d_a < 0 && d_b > 0)) return false;
  SurfaceAt other_at{};
  constexpr int kStepsMax = 30;
  for (int i = 0; i < kStepsMax; ++i) {  // false position, with the Illinois rule
    const double t = t_a + (t_b - t_a) * (d_a / (d_a - d_b));
    c.place = place_at(placed.is_arc(), meeting.mover.sample_c[c.sample], meeting.mover.sample_s[c.sample], t);
    c.p = placed.point(c.place);
    c.at = a.at(c.p);
    other_at = b.at(c.p);
    const double d = c.at.distance - other_at.distance;
    if (std::abs(d) < kSameDistance) break;
    if (d < 0) {
      t_a = t;
      d_a = d;
      d_b *= 0.5;
    } else {
      t_b = t;
      d_b = d;
      d_a *= 0.5;
    }
  }
  // The share of either normal that leaves no slope along the segment.
  const Vector3d tangent = placed.tangent(c.place);
  const double slope_a = c.at.normal.dot(tangent);
  const double slope_b = other_at.normal.dot(tangent);
  if (slope_a * slope_b >= 0) return false;
  const double share = slope_b / (slope_b - slope_a);  // of a
  const Vector3d mixed = share * c.at.normal + (1 - share) * other_at.normal;
  const double length = mixed.norm();
  if (length < kBlade) return false;
  c.normal = mixed / length;
  c.gap = c.at.distance / length;
  c.edge_share = 4 * share * (1 - share);
  return c.gap > -meeting.base.options.spacing && is_outermost(meeting, c, face, other) &&
         is_outermost(meeting, c, other, face);
}

}  // namespace

Rule rule_of(double a, double b, double flush) {
  if (a >= 0 && b >= 0) return Rule::as_free;
  return std::max(a, b) >= 0 && std::min(a, b) > -flush ? Rule::as_before : Rule::as_is;
}

std::uint32_t across(const ExactEdge& edge, std::uint32_t face) {
  return edge.faces[0] == face ? edge.faces[1] : edge.faces[0];
}

bool decides(const Meeting& meeting, const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other, bool first) {
  double a = mine.distance;
  double b = other.distance;
  const Rule rule = rule_of(a, b, meeting.frame.thresholds.flush);
  if (rule != Rule::as_is) {
    const Vector3d way = meeting.moved(p, rule == Rule::as_free ? meeting.frame.twist : meeting.frame.before);
    a += mine.normal.dot(way);
    b += other.normal.dot(way);
  }
  return a > b || (a == b && first);
}

bool admit(const Meeting& meeting, const PlacedFeature& placed, std::uint32_t face, Candidate& c) {
  const Feature& feature = *placed.feature;
  const Vector3d foot = c.p - c.at.distance * c.at.normal;
  if (feature.own_face != kNoFace) {
    const Vector3d touching =
        meeting.frame.R.transpose() * (c.p - feature.radius_at(c.place.c) * c.at.normal - meeting.frame.p);
    const double within = std::abs(meeting.mover.faces[feature.own_face].surface->at(touching).distance);
    const SearchThresholds& fade = meeting.frame.thresholds;
    c.weight = std::min(1.0, (fade.own_none - within) / (fade.own_none - fade.own_free));
    return c.weight > 0 && is_on_face(meeting.base, face, foot) &&
           is_on_face(meeting.mover, feature.own_face, touching);
  }
  const Trim::Answer answer = meeting.base.faces[face].trim->find(*meeting.base.faces[face].surface, foot);
  if (answer.where == Trim::Where::outside) return false;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = meeting.base.edges[e];
    const std::uint32_t other = across(edge, face);
    if (edge.fold == Fold::smooth && is_beyond(edge, face, foot)) return false;
    if (edge.fold == Fold::smooth) continue;
    const SurfaceAt there = meeting.base.faces[other].surface->at(c.p);
    if (!edge.speaks_for(face, c.p, there.distance)) continue;
    if (edge.fold == Fold::concave) {
      // Behind the face across: where the wall there is thin, a place outside of the body on its far side.
      if (there.distance < -meeting.frame.margin) return false;
      continue;
    }
    if (decides(meeting, c.p, c.at, there, face < other)) continue;
    return face < other && cross_edge(meeting, placed, face, other, c);
  }
  return true;
}

}  // namespace verisim::exact

#include "engine/exact/feature_maker.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

constexpr double kSegmentMax = pinned::kPi / 8;  // rad: the search's series for sine and cosine are made for half of it

/// A sample before it is stored.
struct Sample {
  double c = 0, s = 0;
  std::vector<Vector3d> wedge;
};

/// A curve as a feature has it, and how it is cut.
struct Cut {
  Feature::Kind kind;
  Vector3d origin, x, y;
  double from = 0, width = 0;  ///< of a segment, in t
  int segments = 0;            ///< 0: no length

  [[nodiscard]] Sample sample_at(double t) const {
    Sample sample;
    sample.c = kind == Feature::Kind::arc ? pinned::cos(t) : t;
    sample.s = kind == Feature::Kind::arc ? pinned::sin(t) : 0;
    return sample;
  }
  [[nodiscard]] Vector3d point_at(double t) const {
    const Sample at = sample_at(t);
    return origin + at.c * x + at.s * y;
  }
  [[nodiscard]] Vector3d tangent_at(const Sample& at) const {
    return (kind == Feature::Kind::arc ? Vector3d(at.c * y - at.s * x) : x).normalized();
  }
};

void cut_evenly(Cut& cut, double from, double to, double longest) {
  if (!(to > from) || !std::isfinite(to - from)) return;
  cut.segments = std::max(1, static_cast<int>(std::ceil((to - from) / longest - 1e-9)));
  cut.from = from;
  cut.width = (to - from) / cut.segments;
}

Cut cut_of(const Curve& curve, const std::array<double, 2>& t_range, double spacing) {
  Cut cut{Feature::Kind::line, Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  const auto arc = [&](const auto& c, double along_x, double along_y) {
    cut.kind = Feature::Kind::arc;
    cut.origin = c.center;
    cut.x = along_x * c.x_axis;
    cut.y = along_y * c.normal.cross(c.x_axis);
    const double wider = std::max(along_x, along_y);
    if (wider > 0) cut_evenly(cut, t_range[0], t_range[1], std::min(spacing / wider, kSegmentMax));
  };
  if (const auto* line = std::get_if<Line>(&curve)) {
    cut.origin = line->point;
    cut.x = line->direction;
    cut_evenly(cut, t_range[0], t_range[1], spacing);
  } else if (const auto* circle = std::get_if<Circle>(&curve)) {
    arc(*circle, circle->radius, circle->radius);
  } else if (const auto* ellipse = std::get_if<Ellipse>(&curve)) {
    arc(*ellipse, ellipse->major_radius, ellipse->minor_radius);
  }
  return cut;
}

Feature feature_of(const Cut& cut, const BodyOptions& options) {
  Feature f;
  f.kind = cut.kind;
  f.origin = cut.origin;
  f.x = cut.x;
  f.y = cut.y;
  f.half_width = 0.5 * cut.width;
  f.reach = f.half_width * std::max(cut.x.norm(), cut.y.norm());
  f.stiffness = 2 * f.reach * options.line_stiffness;
  const bool is_arc = cut.kind == Feature::Kind::arc;
  f.group = is_arc ? static_cast<std::uint32_t>(
                         std::clamp(static_cast<int>(options.group_angle / cut.width), 1, static_cast<int>(kGroupMax)))
                   : kGroupMax;
  return f;
}

/// Adds the feature and its samples.
void add(ExactBody& body, const Feature& feature, std::span<const Sample> samples) {
  const auto number = static_cast<std::uint32_t>(body.features.size());
  body.features.push_back(feature);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at = static_cast<std::uint32_t>(body.sample_c.size());
    if (i % kRun == 0) body.runs.push_back({number, at, at});
    ++body.runs.back().end;
    body.sample_c.push_back(samples[i].c);
    body.sample_s.push_back(samples[i].s);
    body.wedges.insert(body.wedges.end(), samples[i].wedge.begin(), samples[i].wedge.end());
    body.wedge_begin.push_back(static_cast<std::uint32_t>(body.wedges.size()));
  }
}

void add_point(ExactBody& body, const Vector3d& point, double radius, std::uint32_t own_face, const Sample& sample) {
  Feature f;
  f.origin = point;
  f.radius = radius;
  f.own_face = own_face;
  f.stiffness = body.options.line_stiffness * body.options.point_length;
  add(body, f, std::span(&sample, 1));
}

/// The balls that fill a cone touch it all around at right angles to its side: a ball whose middle is at t touches at
/// the height v with t = v + r(v) tan, and has the radius (r(0) + t tan) cos.
void add_cone_axis(ExactBody& body, const Cone& cone, const std::array<double, 2>& range, std::uint32_t number) {
  const double cosine = pinned::cos(cone.half_angle);
  const double tangent = pinned::tan(cone.half_angle);
  const auto middle = [&](double v) { return v + std::max(0.0, cone.radius + v * tangent) * tangent; };
  Cut cut{Feature::Kind::line, cone.point, cone.direction, Vector3d::Zero()};
  cut_evenly(cut, middle(range[0]), middle(range[1]), body.options.spacing / cosine);
  std::vector<Sample> samples;
  for (int i = 0; i < cut.segments; ++i) samples.push_back(cut.sample_at(cut.from + (i + 0.5) * cut.width));
  Feature f = feature_of(cut, body.options);
  f.radius = cone.radius * cosine;
  f.growth = pinned::sin(cone.half_angle);
  f.stiffness *= cosine;  // a segment's length along the cone's side
  f.own_face = number;
  f.against_round_only = true;
  if (!samples.empty()) add(body, f, samples);
}

void add_apex(ExactBody& body, const Cone& cone, double at) {
  Sample sample;
  const double out = pinned::sin(cone.half_angle);
  const double along = pinned::cos(cone.half_angle);
  const Vector3d y = cone.direction.cross(cone.x_axis);
  for (const Vector3d& across : {cone.x_axis, Vector3d(-cone.x_axis), y, Vector3d(-y)})
    sample.wedge.emplace_back(along * cone.direction + out * across);
  add_point(body, cone.point + at * cone.direction, 0, kNoFace, sample);
}

void add_cone(ExactBody& body, const Cone& cone, const std::array<double, 2>& range, std::uint32_t number) {
  constexpr double kNear = 1e-9;  // m: what rounding of the bounds may leave
  add_cone_axis(body, cone, range, number);
  const double to_apex = -cone.radius / pinned::tan(cone.half_angle);
  if (range[0] < to_apex + kNear) add_apex(body, cone, to_apex);
}

/// Moves a point onto both surfaces. Their normals are not parallel along an edge that has a fold; along a smooth one
/// the point goes as near as the two allow.
Vector3d put_onto(const PreciseSurface* first, const PreciseSurface* second, Vector3d p) {
  constexpr int kRounds = 30;  // each halves the error where the faces meet at 45 degrees or more
  for (int i = 0; i < kRounds; ++i) {
    for (const PreciseSurface* surface : {first, second}) {
      if (surface == nullptr) continue;
      const SurfaceAt at = surface->at(p);
      p -= at.distance * at.normal;
    }
  }
  return p;
}

}  // namespace

std::vector<Vector3d> points_along(const Edge& edge, double spacing, const PreciseSurface* first,
                                   const PreciseSurface* second) {
  std::vector<Vector3d> points;
  const Cut cut = cut_of(edge.curve, edge.t_range, spacing);
  for (int i = 0; cut.segments > 0 && i <= cut.segments; ++i) points.push_back(cut.point_at(cut.from + i * cut.width));
  if (std::holds_alternative<OtherCurve>(edge.curve)) {
    for (const Vector3d& p : edge.polyline) points.push_back(put_onto(first, second, p));
  }
  return points;
}

void add_edge_features(ExactBody& body, const Edge& edge, const ExactEdge& made, const std::vector<Vector3d>& points,
                       const std::array<double, 2>& side_sign) {
  if (made.fold == Fold::concave) return;
  const auto add_wedge = [&](Sample& sample, const Vector3d& p, const Vector3d& tangent) {
    for (std::size_t side = 0; side < 2; ++side) {
      const auto& surface = body.faces[made.faces[side]].surface;
      if (surface) sample.wedge.emplace_back(-side_sign[side] * tangent.cross(surface->at(p).normal).normalized());
    }
  };
  const Cut cut = cut_of(edge.curve, edge.t_range, body.options.spacing);
  std::vector<Sample> samples;
  for (int i = 0; i < cut.segments; ++i) {
    const double t = cut.from + (i + 0.5) * cut.width;
    samples.push_back(cut.sample_at(t));
    add_wedge(samples.back(), cut.point_at(t), cut.tangent_at(samples.back()));
  }
  if (!samples.empty()) add(body, feature_of(cut, body.options), samples);
  if (!std::holds_alternative<OtherCurve>(edge.curve)) return;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {  // a curve of another kind: its chords
    const Vector3d chord = points[i + 1] - points[i];
    Cut line{Feature::Kind::line, points[i], chord.normalized(), Vector3d::Zero()};
    cut_evenly(line, 0, chord.norm(), body.options.spacing);
    samples.clear();
    for (int j = 0; j < line.segments; ++j) {
      const double t = line.from + (j + 0.5) * line.width;
      samples.push_back(line.sample_at(t));
      add_wedge(samples.back(), line.point_at(t), line.x);
    }
    if (!samples.empty()) add(body, feature_of(line, body.options), samples);
  }
}

void add_face_features(ExactBody& body, const Face& face, std::uint32_t number) {
  const auto add_curve = [&](const Curve& curve, const std::array<double, 2>& range, double radius, bool round_only) {
    const Cut cut = cut_of(curve, range, body.options.spacing);
    std::vector<Sample> samples;
    for (int i = 0; i < cut.segments; ++i) samples.push_back(cut.sample_at(cut.from + (i + 0.5) * cut.width));
    Feature f = feature_of(cut, body.options);
    f.radius = radius;
    f.own_face = number;
    f.against_round_only = round_only;
    if (!samples.empty()) add(body, f, samples);
  };
  if (const auto* ball = std::get_if<Sphere>(&face.surface); ball != nullptr && !ball->hole) {
    add_point(body, ball->center, ball->radius, number, {});
  } else if (const auto* torus = std::get_if<Torus>(&face.surface); torus != nullptr && !torus->hole) {
    add_curve(Circle{torus->center, torus->direction, torus->x_axis, torus->major_radius}, face.u_range,
              torus->minor_radius, false);
  } else if (const auto* pin = std::get_if<Cylinder>(&face.surface); pin != nullptr && !pin->hole) {
    add_curve(Line{pin->point, pin->direction}, face.v_range, pin->radius, true);
  } else if (const auto* cone = std::get_if<Cone>(&face.surface); cone != nullptr && !cone->hole) {
    add_cone(body, *cone, face.v_range, number);
  }
}

namespace {

/// Is the corner in which two edges of a face end less than half a turn wide, seen from the face?
bool is_pointed(const EdgeEnd& a, std::size_t side_a, const EdgeEnd& b, std::size_t side_b) {
  constexpr double kPointed = 0.25;  // a curve's first chord leaves its tangent by up to pi / 16
  return b.into.dot(a.out_of[side_a]) < -kPointed && a.into.dot(b.out_of[side_b]) < -kPointed;
}

/// Convex edges between a face with a pointed corner and its neighbours: they go on to speak for that face.
void take_pointed_corners(ExactBody& body, std::span<const EdgeEnd* const> here) {
  for (const EdgeEnd* a : here) {
    ExactEdge& edge = body.edges[a->edge];
    for (const EdgeEnd* b : here) {
      if (a == b) continue;
      const ExactEdge& next = body.edges[b->edge];
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j)
          if (edge.faces[i] == next.faces[j] && is_pointed(*a, i, *b, j)) edge.speaks_beyond[i][a->which] = true;
    }
  }
}

}  // namespace

void take_corners(ExactBody& body, std::vector<EdgeEnd> ends) {
  constexpr double kSame = 1e-7;  // m: ends nearer than this are one corner
  std::stable_sort(ends.begin(), ends.end(),
                   [](const EdgeEnd& a, const EdgeEnd& b) { return a.point.x() < b.point.x(); });
  std::vector<bool> used(ends.size(), false);
  std::vector<const EdgeEnd*> here;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (used[i]) continue;
    here.clear();
    for (std::size_t j = i; j < ends.size() && ends[j].point.x() <= ends[i].point.x() + kSame; ++j) {
      if (used[j] || (ends[j].point - ends[i].point).norm() > kSame) continue;
      used[j] = true;
      here.push_back(&ends[j]);
    }
    const auto is_convex = [&](const EdgeEnd* end) { return body.edges[end->edge].fold == Fold::convex; };
    if (here.size() < 3) continue;
    take_pointed_corners(body, here);
    if (!std::all_of(here.begin(), here.end(), is_convex)) continue;
    Sample sample;
    for (const EdgeEnd* end : here) {
      for (auto& to_face : body.edges[end->edge].speaks_beyond) to_face[end->which] = true;
      sample.wedge.push_back(end->into);
    }
    add_point(body, ends[i].point, 0, kNoFace, sample);
  }
}

Bounds bounds_of(const ExactBody& body, const Run& run) {
  const Feature& f = body.features[run.feature];
  Bounds bounds;
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    const Vector3d margin = Vector3d::Constant(f.radius_at(body.sample_c[i]) + (1 + f.growth) * f.reach);
    const Vector3d p = f.origin + body.sample_c[i] * f.x + body.sample_s[i] * f.y;
    bounds.include(p - margin);
    bounds.include(p + margin);
  }
  return bounds;
}

}  // namespace verisim::exact

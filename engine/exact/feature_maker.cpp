#include "engine/exact/feature_maker.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

constexpr double kSegmentMax = pinned::kPi / 8;  // rad, no heuristic: place_at's series hold for half of it

/// A sample before it is stored.
struct Sample {
  double c = 0, s = 0;
  std::vector<Vector3d> tangent_cone;
};

/// A curve and its division into segments.
struct Segmentation {
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

void split_evenly(Segmentation& split, double from, double to, double longest) {
  if (!(to > from) || !std::isfinite(to - from)) return;
  // 1e-9: a length that is a whole number of segments stays one, whatever its rounding.
  split.segments = std::max(1, static_cast<int>(std::ceil((to - from) / longest - 1e-9)));
  split.from = from;
  split.width = (to - from) / split.segments;
}

Segmentation segmentation_of(const Curve& curve, const std::array<double, 2>& t_range, double spacing) {
  Segmentation split{Feature::Kind::line, Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  const auto arc = [&](const auto& c, double along_x, double along_y) {
    split.kind = Feature::Kind::arc;
    split.origin = c.center;
    split.x = along_x * c.x_axis;
    split.y = along_y * c.normal.cross(c.x_axis);
    const double wider = std::max(along_x, along_y);
    if (wider > 0) split_evenly(split, t_range[0], t_range[1], std::min(spacing / wider, kSegmentMax));
    VERISIM_ASSERT(split.width <= kSegmentMax * (1 + 1e-9));
  };
  std::visit(Overloaded{[&](const Line& c) {
                          split.origin = c.point;
                          split.x = c.direction;
                          split_evenly(split, t_range[0], t_range[1], spacing);
                        },
                        [&](const Circle& c) { arc(c, c.radius, c.radius); },
                        [&](const Ellipse& c) { arc(c, c.major_radius, c.minor_radius); }, [](const OtherCurve&) {}},
             curve);
  return split;
}

Feature feature_of(const Segmentation& split, const BodyOptions& options) {
  Feature f;
  f.kind = split.kind;
  f.origin = split.origin;
  f.x = split.x;
  f.y = split.y;
  f.half_width = 0.5 * split.width;
  f.half_length = f.half_width * std::max(split.x.norm(), split.y.norm());
  f.stiffness = 2 * f.half_length * options.line_stiffness;
  const bool is_arc = split.kind == Feature::Kind::arc;
  f.closed = is_arc && split.segments * split.width > pinned::kFullTurn * (1 - 1e-9);
  f.group = is_arc ? static_cast<std::uint32_t>(std::clamp(static_cast<int>(options.group_angle / split.width), 1,
                                                           static_cast<int>(kGroupMax)))
                   : kGroupMax;
  return f;
}

/// Adds the feature and its samples.
void add(ExactBody& body, const Feature& feature, std::span<const Sample> samples) {
  const auto number = static_cast<std::uint32_t>(body.features.size());
  Feature& added = body.features.emplace_back(feature);
  added.begin = static_cast<std::uint32_t>(body.sample_c.size());
  added.end = added.begin + static_cast<std::uint32_t>(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at = static_cast<std::uint32_t>(body.sample_c.size());
    if (i % kBlockSize == 0) body.blocks.push_back({number, at, at});
    ++body.blocks.back().end;
    body.sample_c.push_back(samples[i].c);
    body.sample_s.push_back(samples[i].s);
    body.cone_directions.insert(body.cone_directions.end(), samples[i].tangent_cone.begin(),
                                samples[i].tangent_cone.end());
    body.cone_begin.push_back(static_cast<std::uint32_t>(body.cone_directions.size()));
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

/// The axis of a cone with the balls that are inscribed in it. A ball touches the cone at right angles to its side:
/// with its centre at t it touches at the height v, where t = v + r(v) tan, and has the radius (r(0) + t tan) cos.
void add_cone_axis(ExactBody& body, const Cone& cone, const std::array<double, 2>& range, std::uint32_t number) {
  const double cosine = pinned::cos(cone.half_angle);
  const double tangent = pinned::tan(cone.half_angle);
  const auto middle = [&](double v) { return v + std::max(0.0, cone.radius + v * tangent) * tangent; };
  Segmentation split{Feature::Kind::line, cone.point, cone.direction, Vector3d::Zero()};
  split_evenly(split, middle(range[0]), middle(range[1]), body.options.spacing / cosine);
  std::vector<Sample> samples;
  for (int i = 0; i < split.segments; ++i) samples.push_back(split.sample_at(split.from + (i + 0.5) * split.width));
  Feature f = feature_of(split, body.options);
  f.radius = cone.radius * cosine;
  f.radius_slope = pinned::sin(cone.half_angle);
  f.stiffness *= cosine;  // of the segment's length along the cone's side
  f.own_face = number;
  f.is_axis = true;
  if (!samples.empty()) add(body, f, samples);
}

void add_apex(ExactBody& body, const Cone& cone, double at) {
  Sample sample;
  const double out = pinned::sin(cone.half_angle);
  const double along = pinned::cos(cone.half_angle);
  const Vector3d y = cone.direction.cross(cone.x_axis);
  for (const Vector3d& across : {cone.x_axis, Vector3d(-cone.x_axis), y, Vector3d(-y)})
    sample.tangent_cone.emplace_back(along * cone.direction + out * across);
  add_point(body, cone.point + at * cone.direction, 0, kNoFace, sample);
}

void add_cone(ExactBody& body, const Cone& cone, const std::array<double, 2>& range, std::uint32_t number) {
  constexpr double kNear = 1e-9;  // m: rounding of the bounds
  add_cone_axis(body, cone, range, number);
  const double to_apex = -cone.radius / pinned::tan(cone.half_angle);
  if (range[0] < to_apex + kNear) add_apex(body, cone, to_apex);
}

/// Projects a point onto both surfaces in turn. Their normals are not parallel along a sharp edge, so this converges to
/// their intersection; along a smooth edge the point ends near both.
Vector3d projected(const AnalyticSurface* first, const AnalyticSurface* second, Vector3d p) {
  constexpr int kRounds = 30;  // each halves the error where the faces meet at 45 degrees or more
  for (int i = 0; i < kRounds; ++i) {
    for (const AnalyticSurface* surface : {first, second}) {
      if (surface == nullptr) continue;
      const SurfaceAt at = surface->at(p);
      p -= at.distance * at.normal;
    }
  }
  return p;
}

}  // namespace

std::vector<Vector3d> points_along(const Edge& edge, double spacing, const AnalyticSurface* first,
                                   const AnalyticSurface* second) {
  std::vector<Vector3d> points;
  const Segmentation split = segmentation_of(edge.curve, edge.t_range, spacing);
  for (int i = 0; split.segments > 0 && i <= split.segments; ++i)
    points.push_back(split.point_at(split.from + i * split.width));
  if (std::holds_alternative<OtherCurve>(edge.curve)) {
    for (const Vector3d& p : edge.polyline) points.push_back(projected(first, second, p));
    if (points.size() == 2) points.insert(points.begin() + 1, projected(first, second, 0.5 * (points[0] + points[1])));
  } else if (points.size() == 2) {
    points.insert(points.begin() + 1, split.point_at(split.from + 0.5 * split.width));
  }
  return points;
}

void add_edge_features(ExactBody& body, const Edge& edge, const ExactEdge& made, const std::vector<Vector3d>& points,
                       const std::array<double, 2>& side_sign) {
  if (made.convexity == Convexity::concave) return;
  const auto add_tangent_cone = [&](Sample& sample, const Vector3d& p, const Vector3d& tangent) {
    for (std::size_t side = 0; side < 2; ++side) {
      const auto& surface = body.faces[made.faces[side]].surface;
      if (surface)
        sample.tangent_cone.emplace_back(-side_sign[side] * tangent.cross(surface->at(p).normal).normalized());
    }
  };
  const Segmentation split = segmentation_of(edge.curve, edge.t_range, body.options.spacing);
  std::vector<Sample> samples;
  for (int i = 0; i < split.segments; ++i) {
    const double t = split.from + (i + 0.5) * split.width;
    samples.push_back(split.sample_at(t));
    add_tangent_cone(samples.back(), split.point_at(t), split.tangent_at(samples.back()));
  }
  if (!samples.empty()) add(body, feature_of(split, body.options), samples);
  if (!std::holds_alternative<OtherCurve>(edge.curve)) return;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {  // freeform: the chords of its polyline
    const Vector3d chord = points[i + 1] - points[i];
    Segmentation line{Feature::Kind::line, points[i], chord.normalized(), Vector3d::Zero()};
    split_evenly(line, 0, chord.norm(), body.options.spacing);
    samples.clear();
    for (int j = 0; j < line.segments; ++j) {
      const double t = line.from + (j + 0.5) * line.width;
      samples.push_back(line.sample_at(t));
      add_tangent_cone(samples.back(), line.point_at(t), line.x);
    }
    if (!samples.empty()) add(body, feature_of(line, body.options), samples);
  }
}

void add_face_features(ExactBody& body, const Face& face, std::uint32_t number) {
  const auto add_curve = [&](const Curve& curve, const std::array<double, 2>& range, double radius, bool is_axis) {
    const Segmentation split = segmentation_of(curve, range, body.options.spacing);
    std::vector<Sample> samples;
    for (int i = 0; i < split.segments; ++i) samples.push_back(split.sample_at(split.from + (i + 0.5) * split.width));
    Feature f = feature_of(split, body.options);
    f.radius = radius;
    f.own_face = number;
    f.is_axis = is_axis;
    if (!samples.empty()) add(body, f, samples);
  };
  std::visit(
      Overloaded{
          [](const Plane&) {},
          [&](const Cylinder& s) {
            if (!s.hole) add_curve(Line{s.point, s.direction}, face.v_range, s.radius, true);
          },
          [&](const Cone& s) {
            if (!s.hole) add_cone(body, s, face.v_range, number);
          },
          [&](const Sphere& s) {
            if (!s.hole) add_point(body, s.center, s.radius, number, {});
          },
          [&](const Torus& s) {
            if (s.hole) return;
            add_curve(Circle{s.center, s.direction, s.x_axis, s.major_radius}, face.u_range, s.minor_radius, false);
          },
          [](const OtherSurface&) {}},
      face.surface);
}

namespace {

/// True if the corner of a face in which two of its edges end is convex: its angle within the face is below 180
/// degrees.
/// @param least  BodyOptions::convex_corner
bool is_convex_corner(const EdgeEnd& a, std::size_t side_a, const EdgeEnd& b, std::size_t side_b, double least) {
  return b.into.dot(a.outward[side_a]) < -least && a.into.dot(b.outward[side_b]) < -least;
}

/// Edges of a face that end in a convex corner of it limit that face beyond the corner too.
void limit_beyond_convex_corners(ExactBody& body, std::span<const EdgeEnd* const> here) {
  for (const EdgeEnd* a : here) {
    ExactEdge& edge = body.edges[a->edge];
    for (const EdgeEnd* b : here) {
      if (a == b) continue;
      const ExactEdge& next = body.edges[b->edge];
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j)
          if (edge.faces[i] == next.faces[j] && is_convex_corner(*a, i, *b, j, body.options.convex_corner))
            edge.limits_beyond_end[i][a->which] = true;
    }
  }
}

/// Two convex edges of a face that meet at less than 90 degrees on the side where the face is not.
void tell_sharp_corners(ExactBody& body, std::span<const EdgeEnd* const> here) {
  for (const EdgeEnd* a : here) {
    ExactEdge& edge = body.edges[a->edge];
    for (const EdgeEnd* b : here) {
      const ExactEdge& next = body.edges[b->edge];
      if (a == b || edge.convexity != Convexity::convex || next.convexity != Convexity::convex) continue;
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) {
          if (edge.faces[i] != next.faces[j] || !(a->into.dot(b->into) > 0)) continue;
          if (!(a->into.dot(b->outward[j]) > 0 && b->into.dot(a->outward[i]) > 0)) continue;
          edge.sharp_corner[i][a->which] = b->outward[j];
          edge.has_sharp_corner[i] = true;
        }
    }
  }
}

}  // namespace

void add_corners(ExactBody& body, std::vector<EdgeEnd> ends) {
  const double same = body.options.same_corner;
  std::stable_sort(ends.begin(), ends.end(),
                   [](const EdgeEnd& a, const EdgeEnd& b) { return a.point.x() < b.point.x(); });
  for (const EdgeEnd& end : ends) body.edges[end.edge].ends[end.which] = end.point;
  std::vector<bool> used(ends.size(), false);
  std::vector<const EdgeEnd*> here;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (used[i]) continue;
    here.clear();
    for (std::size_t j = i; j < ends.size() && ends[j].point.x() <= ends[i].point.x() + same; ++j) {
      if (used[j] || (ends[j].point - ends[i].point).norm() > same) continue;
      used[j] = true;
      here.push_back(&ends[j]);
    }
    const auto is_convex = [&](const EdgeEnd* end) { return body.edges[end->edge].convexity == Convexity::convex; };
    if (here.size() < 3) continue;
    limit_beyond_convex_corners(body, here);
    tell_sharp_corners(body, here);
    if (!std::all_of(here.begin(), here.end(), is_convex)) continue;
    Sample sample;
    for (const EdgeEnd* end : here) {
      for (auto& to_face : body.edges[end->edge].limits_beyond_end) to_face[end->which] = true;
      sample.tangent_cone.push_back(end->into);
    }
    add_point(body, ends[i].point, 0, kNoFace, sample);
  }
}

Bounds bounds_of(const ExactBody& body, const SampleBlock& block) {
  const Feature& f = body.features[block.feature];
  Bounds bounds;
  for (std::uint32_t i = block.begin; i < block.end; ++i) {
    const Vector3d margin = Vector3d::Constant(f.radius_at(body.sample_c[i]) + (1 + f.radius_slope) * f.half_length);
    const Vector3d p = f.origin + body.sample_c[i] * f.x + body.sample_s[i] * f.y;
    bounds.include(p - margin);
    bounds.include(p + margin);
  }
  return bounds;
}

}  // namespace verisim::exact

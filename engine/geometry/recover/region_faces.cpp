#include "engine/geometry/recover/region_faces.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

namespace {

using pinned::kFullTurn;
using Range = std::array<double, 2>;

/// The vertices of a region, each once.
std::vector<Vector3d> points_of(const CanonicalMesh& mesh, const Region& region) {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t t : region.triangles) {
    vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Vector3d> points;
  for (const std::uint32_t v : vertices) points.push_back(mesh.vertices[v]);
  return points;
}

template <typename Measure>
Range range_of(const std::vector<Vector3d>& points, Measure measure) {
  Range range = {measure(points[0]), measure(points[0])};
  for (const Vector3d& p : points) {
    range[0] = std::min(range[0], measure(p));
    range[1] = std::max(range[1], measure(p));
  }
  return range;
}

/// The union of angular spans as one range: the complement of the widest gap, or a full turn if there is no gap.
Range covered_range(std::vector<Range> spans) {
  if (spans.empty()) return {0, kFullTurn};
  std::ranges::sort(spans);
  double reached = spans.front()[1], widest = 0, begin = spans.front()[0], end = reached;
  for (const Range& span : spans) {
    if (span[0] - reached > widest) {
      widest = span[0] - reached;
      begin = span[0] - kFullTurn;
      end = reached;
    }
    reached = std::max(reached, span[1]);
  }
  const double last_gap = spans.front()[0] + kFullTurn - reached;
  if (last_gap > widest) return {spans.front()[0], reached};
  return widest > 0 ? Range{begin, end} : Range{spans.front()[0], spans.front()[0] + kFullTurn};
}

/// The range of angles that the triangles cover [rad].
/// @param angle_at  (p, angle&): sets the angle of a vertex; false where it has none (on the axis)
template <typename AngleAt>
Range angle_range(const CanonicalMesh& mesh, const Region& region, AngleAt angle_at) {
  std::vector<Range> spans;
  for (const std::uint32_t t : region.triangles) {
    Range span = {0, 0};
    bool first = true;
    double from = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      double angle = 0;
      if (!angle_at(mesh.corner(t, i), angle)) continue;
      if (first) {
        span = {angle, angle};
        from = angle;
        first = false;
        continue;
      }
      while (angle - from > pinned::kPi) angle -= kFullTurn;
      while (angle - from < -pinned::kPi) angle += kFullTurn;
      span = {std::min(span[0], angle), std::max(span[1], angle)};
    }
    if (!first) spans.push_back(span);
  }
  // A span that crosses the cut at +-pi is listed on both sides of it.
  const std::size_t count = spans.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (spans[i][0] < -pinned::kPi) spans.push_back({spans[i][0] + kFullTurn, spans[i][1] + kFullTurn});
    if (spans[i][1] > pinned::kPi) spans.push_back({spans[i][0] - kFullTurn, spans[i][1] - kFullTurn});
  }
  return covered_range(std::move(spans));
}

bool is_full_turn(const Range& turn) {
  return turn[1] - turn[0] > kFullTurn - 1e-9;
}

/// True if the ray from `origin` along `direction` hits a triangle of the region.
bool ray_hits(const CanonicalMesh& mesh, const Region& region, const Vector3d& origin, const Vector3d& direction) {
  return std::ranges::any_of(region.triangles, [&](std::uint32_t t) {
    const Vector3d a = mesh.corner(t, 0) - origin, b = mesh.corner(t, 1) - origin, c = mesh.corner(t, 2) - origin;
    const double u = direction.dot(a.cross(b)), v = direction.dot(b.cross(c)), w = direction.dot(c.cross(a));
    const bool one_side = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    return one_side && direction.dot(a + b + c) > 0;
  });
}

/// Sets u_range from the triangles. The x axis is turned to where the range begins, unless it is a full turn.
template <typename Round>
void set_u_range(Face& face, Round& round, const Vector3d& point, const CanonicalMesh& mesh, const Region& region) {
  const Vector3d x = round.x_axis, y = round.direction.cross(x);
  const double axis_tolerance = 1e-9 * mesh.size;
  const Range turn = angle_range(mesh, region, [&](const Vector3d& p, double& angle) {
    const Profile f = profile_of(p, point, round.direction);
    angle = pinned::atan2(f.outward.dot(y), f.outward.dot(x));
    return f.rho > axis_tolerance;
  });
  face.u_range = {0, kFullTurn};
  if (is_full_turn(turn)) return;
  round.x_axis = pinned::cos(turn[0]) * x + pinned::sin(turn[0]) * y;
  face.u_range = {0, turn[1] - turn[0]};
}

class ParameterRanges {
 public:
  ParameterRanges(Face& face, const CanonicalMesh& mesh, const Region& region)
      : face_(face), mesh_(mesh), region_(region), points_(points_of(mesh, region)) {}

  void operator()(Plane& s) const {
    const Vector3d y = s.normal.cross(s.x_axis);
    face_.u_range = range_of(points_, [&](const Vector3d& p) { return (p - s.point).dot(s.x_axis); });
    face_.v_range = range_of(points_, [&](const Vector3d& p) { return (p - s.point).dot(y); });
  }
  void operator()(Cylinder& s) const {
    set_u_range(face_, s, s.point, mesh_, region_);
    face_.v_range = heights(s.point, s.direction);
  }
  void operator()(Cone& s) const {
    set_u_range(face_, s, s.point, mesh_, region_);
    face_.v_range = heights(s.point, s.direction);
  }
  void operator()(Sphere& s) const {
    set_u_range(face_, s, s.center, mesh_, region_);
    face_.v_range = range_of(points_, [&](const Vector3d& p) {
      const Profile f = profile_of(p, s.center, s.direction);
      return Meridian{.kind = Kind::sphere, .radius = s.radius}.parameter(f.rho, f.height);
    });
    if (ray_hits(mesh_, region_, s.center, s.direction)) face_.v_range[1] = 0.25 * kFullTurn;
    if (ray_hits(mesh_, region_, s.center, -s.direction)) face_.v_range[0] = -0.25 * kFullTurn;
  }
  void operator()(Torus& s) const {
    set_u_range(face_, s, s.center, mesh_, region_);
    const bool beyond = is_past_axis(s);
    if (beyond) s.x_axis = -s.x_axis;
    const Meridian tube = tube_of(s, beyond);
    const Range turn = angle_range(mesh_, region_, [&](const Vector3d& p, double& angle) {
      const Profile f = profile_of(p, s.center, s.direction);
      angle = tube.parameter(f.rho, f.height);
      return true;
    });
    face_.v_range = is_full_turn(turn) ? Range{0, kFullTurn} : turn;
  }
  void operator()(OtherSurface& /*s*/) const {}

 private:
  [[nodiscard]] Range heights(const Vector3d& point, const Vector3d& axis) const {
    return range_of(points_, [&](const Vector3d& p) { return (p - point).dot(axis); });
  }

  [[nodiscard]] static Meridian tube_of(const Torus& s, bool beyond_axis) {
    return {.kind = Kind::torus, .radius = s.minor_radius, .ring = beyond_axis ? -s.major_radius : s.major_radius};
  }

  /// True if the points belong to the part of the tube that has passed the axis: the tube is wider than its ring.
  [[nodiscard]] bool is_past_axis(const Torus& s) const {
    double here = 0, beyond = 0;
    for (const Vector3d& p : points_) {
      const Profile f = profile_of(p, s.center, s.direction);
      here += std::abs(tube_of(s, false).distance(f.rho, f.height));
      beyond += std::abs(tube_of(s, true).distance(f.rho, f.height));
    }
    return beyond < here;
  }

  Face& face_;
  const CanonicalMesh& mesh_;
  const Region& region_;
  std::vector<Vector3d> points_;
};

}  // namespace

Face face_of(const CanonicalMesh& mesh, const Region& region) {
  Face face;
  face.surface = region.surface;
  for (const std::uint32_t t : region.triangles) face.area += mesh.areas[t];
  const ParameterRanges bounds(face, mesh, region);
  std::visit(bounds, face.surface);
  return face;
}

}  // namespace verisim::recover

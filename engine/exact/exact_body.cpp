#include "engine/exact/exact_body.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/exact/feature_maker.hpp"

namespace verisim::exact {
namespace {

/// The triangles of one part, by face.
class FaceTriangles {
 public:
  FaceTriangles(const TriangleMesh& mesh, std::size_t faces) : first_(faces + 1, 0) {
    for (const std::uint32_t f : mesh.face_of_triangle)
      if (f < faces) ++first_[f + 1];
    for (std::size_t f = 0; f < faces; ++f) first_[f + 1] += first_[f];
    triangles_.resize(first_[faces]);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < mesh.face_of_triangle.size(); ++t) {
      const std::uint32_t f = mesh.face_of_triangle[t];
      if (f < faces) triangles_[next[f]++] = t;
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t face) const {
    return std::span(triangles_).subspan(first_[face], first_[face + 1] - first_[face]);
  }

 private:
  std::vector<std::uint32_t> triangles_, first_;
};

/// Squared distance of a point to a segment.
double squared_distance(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d ab = b - a;
  const double length = ab.squaredNorm();
  const double s = length > 0 ? std::clamp(ab.dot(p - a) / length, 0.0, 1.0) : 0;
  return (a + s * ab - p).squaredNorm();
}

/// True if a face lies in the direction `across` from a point p of its border, false if opposite to it. Decided by the
/// third corners of the triangles whose sides are nearest to p: one triangle, or at a corner all that meet there.
bool lies_towards(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const Vector3d& p,
                  const Vector3d& across) {
  constexpr double kSame = 1e-16;  // m^2: corners are rounded to 1.5e-11 m
  double nearest = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const std::uint32_t t : triangles) {
    const auto& v = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const double distance = squared_distance(mesh.vertices[v[i]], mesh.vertices[v[(i + 1) % 3]], p);
      if (distance > nearest + kSame) continue;
      if (distance < nearest - kSame) most = 0;
      nearest = std::min(nearest, distance);
      const double towards = across.dot(mesh.vertices[v[(i + 2) % 3]] - p);
      if (std::abs(towards) > std::abs(most)) most = towards;
    }
  }
  return most > 0;
}

void set_extent(ExactEdge& made, const Edge& edge) {
  const double width = 0.5 * (edge.t_range[1] - edge.t_range[0]);
  const double center = 0.5 * (edge.t_range[0] + edge.t_range[1]);
  std::visit(Overloaded{[&](const Line& c) {
                          made.extent = ExactEdge::Extent::line;
                          made.center = c.point + center * c.direction;
                          made.direction = c.direction;
                          made.half = width;
                        },
                        [&](const Circle& c) {
                          if (!(width < 0.999 * pinned::kPi)) return;  // a full circle, whatever its rounding
                          made.extent = ExactEdge::Extent::arc;
                          made.center = c.center;
                          const Vector3d y = c.normal.cross(c.x_axis);
                          made.direction = pinned::cos(center) * c.x_axis + pinned::sin(center) * y;
                          made.perpendicular = pinned::cos(center) * y - pinned::sin(center) * c.x_axis;
                          made.half = pinned::cos(width);
                        },
                        [](const Ellipse&) {}, [](const OtherCurve&) {}},
             edge.curve);
}

/// Adds one part to a body, entity by entity.
class PartImporter {
 public:
  PartImporter(ExactBody& body, const Part& part)
      : body_(body),
        part_(part),
        triangles_(part.mesh, part.faces.size()),
        face_base_(static_cast<std::uint32_t>(body.faces.size())),
        points_(part.edges.size()),
        borders_(part.faces.size()) {
    for (std::size_t f = 0; f < part.faces.size(); ++f) add_surface(f);
    for (std::size_t e = 0; e < part.edges.size(); ++e) add_edge(e);
    for (std::size_t f = 0; f < part.faces.size(); ++f) add_trim(f);
    add_corners(body, ends_);
  }

 private:
  /// Adds how far a curve or round face may bulge out of the box of its points.
  void add_sagitta(Bounds& bounds) const {
    const Vector3d more = Vector3d::Constant(body_.options.sagitta * bounds.size().maxCoeff());
    bounds.min -= more;
    bounds.max += more;
  }

  void add_surface(std::size_t f) {
    ExactFace& face = body_.faces.emplace_back();
    for (const std::uint32_t t : triangles_.of(f))
      for (const std::uint32_t v : part_.mesh.triangles[t]) face.bounds.include(part_.mesh.vertices[v]);
    if (triangles_.of(f).empty()) return;
    face.surface = AnalyticSurface::from(part_.faces[f]);
    if (face.surface && face.surface->kind() != SurfaceKind::plane) add_sagitta(face.bounds);
  }

  [[nodiscard]] const AnalyticSurface* surface_of(std::uint32_t face) const {
    const auto& surface = body_.faces[face].surface;
    return surface ? &*surface : nullptr;
  }

  void add_edge(std::size_t e) {
    const Edge& edge = part_.edges[e];
    if (edge.faces.size() != 2 || edge.faces[0] == edge.faces[1]) return;  // a seam inside one surface
    ExactEdge made;
    made.beyond_end = body_.options.beyond_end;
    made.same_corner = body_.options.same_corner;
    made.faces = {face_base_ + edge.faces[0], face_base_ + edge.faces[1]};
    const AnalyticSurface* surface[2] = {surface_of(made.faces[0]), surface_of(made.faces[1])};
    points_[e] = points_along(edge, body_.options.spacing, surface[0], surface[1]);
    if (points_[e].size() < 2) return;
    const auto tangent = [&](std::size_t i) {
      const std::size_t last = points_[e].size() - 1;
      return Vector3d((points_[e][std::min(i + 1, last)] - points_[e][i == 0 ? 0 : i - 1]).normalized());
    };
    const std::size_t middle = points_[e].size() / 2;
    std::array<double, 2> sign{1, 1};  // makes tangent x normal point out of the face, all along the edge
    const auto outward = [&](std::size_t i, std::size_t side) {
      const Vector3d normal = surface[side]->at(points_[e][i]).normal;
      return Vector3d(sign[side] * tangent(i).cross(normal).normalized());
    };
    for (std::size_t side = 0; side < 2; ++side) {
      if (surface[side] == nullptr) continue;
      const std::span<const std::uint32_t> triangles = triangles_.of(edge.faces[side]);
      if (lies_towards(part_.mesh, triangles, points_[e][middle], outward(middle, side))) sign[side] = -1;
    }
    set_extent(made, edge);
    for (const Vector3d& p : points_[e]) made.bounds.include(p);
    if (made.extent != ExactEdge::Extent::line) add_sagitta(made.bounds);
    if (surface[0] != nullptr && surface[1] != nullptr) {
      const double turn = outward(middle, 0).dot(surface[1]->at(points_[e][middle]).normal);
      if (turn > body_.options.smooth) made.convexity = Convexity::convex;
      if (turn < -body_.options.smooth) made.convexity = Convexity::concave;
    }
    for (std::size_t i = 0; made.convexity == Convexity::smooth && i < points_[e].size(); ++i) {
      ExactEdge::Mark& mark = made.marks.emplace_back();
      mark.point = points_[e][i];
      for (std::size_t side = 0; side < 2; ++side)
        mark.outward[side] = surface[side] == nullptr ? Vector3d(Vector3d::Zero()) : outward(i, side);
    }
    const auto number = static_cast<std::uint32_t>(body_.edges.size());
    for (const std::uint32_t f : edge.faces) borders_[f].push_back({number, points_[e]});
    if (surface[0] != nullptr || surface[1] != nullptr) add_edge_features(body_, edge, made, points_[e], sign);
    const std::vector<Vector3d>& p = points_[e];
    const auto outward_of_both = [&](std::size_t i) {
      std::array<Vector3d, 2> out = {Vector3d::Zero(), Vector3d::Zero()};
      for (std::size_t side = 0; side < 2; ++side)
        if (surface[side] != nullptr) out[side] = outward(i, side);
      return out;
    };
    ends_.push_back({p.front(), tangent(0), number, 0, outward_of_both(0)});
    ends_.push_back({p.back(), -tangent(p.size() - 1), number, 1, outward_of_both(p.size() - 1)});
    body_.edges.push_back(std::move(made));
  }

  void add_trim(std::size_t f) {
    const auto number = face_base_ + static_cast<std::uint32_t>(f);
    ExactFace& face = body_.faces[number];
    if (!face.surface) return;
    const Trim::Cells cells{body_.options.spacing, body_.options.cells_max, body_.options.near_pole};
    face.trim.emplace(*face.surface, part_.mesh, triangles_.of(f), borders_[f], cells);
    ++body_.precise_face_count;
    add_face_features(body_, part_.faces[f], number);
  }

  ExactBody& body_;
  const Part& part_;
  FaceTriangles triangles_;
  std::uint32_t face_base_;
  std::vector<std::vector<Vector3d>> points_;  ///< along each edge
  std::vector<std::vector<Trim::Border>> borders_;
  std::vector<EdgeEnd> ends_;
};

}  // namespace

bool ExactEdge::limits_face_at(std::uint32_t face, const Vector3d& p, double distance) const {
  if (extent == Extent::all) return true;
  const std::size_t side = faces[0] == face ? 0 : 1;
  const double more = distance < 0 ? beyond_end : same_corner;
  if (has_sharp_corner[side])
    for (std::size_t end = 0; end < 2; ++end)
      if (sharp_corner[side][end].dot(p - ends[end]) < -more) return false;
  const Vector3d d = p - center;
  const double a = direction.dot(d);
  const double b = perpendicular.dot(d);
  const bool is_line = extent == Extent::line;
  const double beyond = is_line ? std::abs(a) - half : half * std::sqrt(a * a + b * b) - a;
  const std::size_t end = (is_line ? a : b) > 0 ? 1 : 0;
  return beyond <= more || limits_beyond_end[side][end];
}

ExactBody::ExactBody(std::span<const Part> parts, const BodyOptions& wanted) : options(wanted) {
  VERISIM_ASSERT(is_positive(options.spacing));
  VERISIM_ASSERT(is_positive(options.line_stiffness));
  VERISIM_ASSERT(is_not_negative(options.point_length));
  VERISIM_ASSERT(is_not_negative(options.smooth));
  VERISIM_ASSERT(is_not_negative(options.group_angle));
  VERISIM_ASSERT(options.cells_max > 0);
  VERISIM_ASSERT(is_not_negative(options.sagitta));
  VERISIM_ASSERT(is_not_negative(options.beyond_end));
  VERISIM_ASSERT(is_not_negative(options.same_corner));
  for (const Part& part : parts) {
    VERISIM_ASSERT(is_whole(part.mesh));
    for (const Edge& edge : part.edges) {
      for (const std::uint32_t face : edge.faces) VERISIM_ASSERT(face < part.faces.size());
    }
  }
  for (const Part& part : parts) PartImporter(*this, part);
  std::vector<Bounds> boxes;
  for (const ExactFace& face : faces) boxes.push_back(face.surface ? face.bounds : Bounds());
  face_tree = BoxTree(boxes);
  boxes.clear();
  for (const ExactEdge& edge : edges) boxes.push_back(edge.convexity == Convexity::convex ? edge.bounds : Bounds());
  edge_tree = BoxTree(boxes);
  boxes.clear();
  for (const SampleBlock& block : blocks) boxes.push_back(bounds_of(*this, block));
  block_tree = BoxTree(boxes);
}

}  // namespace verisim::exact

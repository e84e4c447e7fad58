#include "engine/voxel/prepared_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/overloaded.hpp"

namespace verisim {

namespace {

constexpr double kMostDeflection = 7;  // voxel: less than the grid's border; triangles this far off tell the face alone
constexpr double kMostGap = 1e-2;      // voxel, between the ends of two bounds that should meet
constexpr double kRounding = 0x1p-36;  // m, of coordinates from the CAD kernel (loader.hpp)
constexpr double kSafety = 1.25;       // deflection is measured at a few points of each triangle
constexpr std::size_t kMostSamples = 16;

/// The triangles of each face.
class TrianglesOfFaces {
 public:
  explicit TrianglesOfFaces(const Part& part) : begin_(part.faces.size() + 1, 0) {
    const std::vector<std::uint32_t>& face_of = part.mesh.face_of_triangle;
    for (const std::uint32_t face : face_of) {
      if (face != kNoFace) ++begin_[face + std::size_t{1}];
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    triangle_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t t = 0; t < face_of.size(); ++t) {
      if (face_of[t] != kNoFace) triangle_[next[face_of[t]]++] = t;
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t face) const {
    return {triangle_.data() + begin_[face], begin_[face + 1] - begin_[face]};
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> triangle_;
};

double triangle_deflection(const GridSurface& surface, const std::array<Vector3d, 3>& corners) {
  const auto& [a, b, c] = corners;
  double farthest = 0;
  for (const Vector3d& p : {a, b, c, Vector3d(0.5 * (a + b)), Vector3d(0.5 * (b + c)), Vector3d(0.5 * (c + a)),
                            Vector3d((a + b + c) / 3)}) {
    farthest = std::max(farthest, std::abs(surface.value(surface.to_local(p))));
  }
  return farthest;
}

/// The largest distance of an edge's polyline from its curve [m]: chord^2 / 8 times the largest curvature.
double edge_deflection(const Edge& edge) {
  const double curvature =
      std::visit(Overloaded{[](const Line&) { return 0.0; }, [](const Circle& c) { return 1 / c.radius; },
                            [](const Ellipse& c) { return c.major_radius / (c.minor_radius * c.minor_radius); },
                            [](const OtherCurve&) { return 0.0; }},
                 edge.curve);
  double farthest = 0;
  if (!std::isfinite(curvature)) return farthest;
  for (std::size_t i = 1; i < edge.polyline.size(); ++i) {
    const double chord = (edge.polyline[i] - edge.polyline[i - 1]).norm();
    farthest = std::max(farthest, std::min(chord * chord * curvature / 8, 0.5 * chord));
  }
  return farthest;
}

bool is_seam(const Edge& edge) {
  return edge.faces.size() < 2;
}

/// Points of a face that are within its precise bounds although they come from its triangles, which cut across curved
/// bounds: well inside a large triangle, or halfway along the shortest sides that two triangles share.
class Samples {
 public:
  Samples(const GridMesh& mesh, std::span<const std::uint32_t> triangles, const GridSurface& surface)
      : mesh_(mesh), triangles_(triangles), surface_(surface) {}

  [[nodiscard]] std::vector<Vector3d> find(double deflection) const {
    std::vector<Vector3d> samples = inside_triangles(4 * deflection);
    if (samples.empty()) samples = on_shared_sides();
    for (Vector3d& p : samples) p = surface_.to_local(surface_.foot(p));
    return samples;
  }

 private:
  /// Points at uneven weights of the corners, so that no symmetry of the part puts bounds on the same meridian.
  [[nodiscard]] std::vector<Vector3d> inside_triangles(double smallest_inradius) const {
    std::vector<std::pair<double, std::uint32_t>> by_size;
    for (const std::uint32_t t : triangles_) {
      const auto [a, b, c] = mesh_.corners(t);
      const double sides = (b - a).norm() + (c - b).norm() + (a - c).norm();
      const double inradius = (b - a).cross(c - a).norm() / sides;
      if (inradius > smallest_inradius) by_size.emplace_back(-inradius, t);
    }
    const std::size_t count = std::min(by_size.size(), kMostSamples);
    std::partial_sort(by_size.begin(), by_size.begin() + static_cast<long>(count), by_size.end());
    std::vector<Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [a, b, c] = mesh_.corners(by_size[i].second);
      points.emplace_back(0.3743 * a + 0.3319 * b + 0.2938 * c);
    }
    return points;
  }

  [[nodiscard]] std::vector<Vector3d> on_shared_sides() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> met;
    for (const std::uint32_t t : triangles_) {
      const auto& corner = (*mesh_.triangles)[t];
      for (std::size_t i = 0; i < 3; ++i) ++met[std::minmax(corner[i], corner[(i + 1) % 3])];
    }
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> by_length;
    for (const auto& [side, triangles] : met) {
      if (triangles != 2) continue;
      by_length.emplace_back((mesh_.vertices[side.first] - mesh_.vertices[side.second]).norm(), side.first,
                             side.second);
    }
    const std::size_t count = std::min(by_length.size(), kMostSamples);
    std::partial_sort(by_length.begin(), by_length.begin() + static_cast<long>(count), by_length.end());
    std::vector<Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [length, a, b] = by_length[i];
      points.emplace_back(0.5137 * mesh_.vertices[a] + 0.4863 * mesh_.vertices[b]);
    }
    return points;
  }

  const GridMesh& mesh_;
  std::span<const std::uint32_t> triangles_;
  const GridSurface& surface_;
};

/// How far the ends of bounds are from where another bound ends [voxel].
double largest_gap(const std::vector<GridCurve>& bounds) {
  double largest = 0;
  const auto nearest_end = [&](const Vector3d& end, std::size_t own, bool own_is_first) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      if (i != own || !own_is_first) nearest = std::min(nearest, (bounds[i].first() - end).norm());
      if (i != own || own_is_first) nearest = std::min(nearest, (bounds[i].last() - end).norm());
    }
    return nearest;
  };
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    if (bounds[i].is_closed()) continue;
    largest = std::max({largest, nearest_end(bounds[i].first(), i, true), nearest_end(bounds[i].last(), i, false)});
  }
  return largest;
}

class Preparation {
 public:
  Preparation(const Part& part, const GridMesh& mesh, const Voxmap& map)
      : part_(part), mesh_(mesh), map_(map), scale_(1 / map.voxel_size), triangles_(part) {}

  [[nodiscard]] PreparedFace prepare(std::size_t index) const {
    const Face& face = part_.faces[index];
    PreparedFace result;
    const std::optional<GridSurface> surface = GridSurface::from(face, map_.origin, scale_);
    if (!surface) return by_triangles(std::move(result), false);
    result.surface = std::make_unique<GridSurface>(*surface);
    const double deflection = deflection_of(index, *result.surface);
    result.deflection = kSafety * deflection + kCandidateMargin;
    if (!(result.deflection < kMostDeflection)) return by_triangles(std::move(result), true);

    std::vector<GridCurve> bounds;
    for (const std::uint32_t e : face.edges) {
      const Edge& edge = part_.edges[e];
      const Vector3d origin = map_.origin + map_.voxel_size * result.surface->origin();
      if (!is_seam(edge)) bounds.emplace_back(edge, result.surface->axes(), origin, scale_);
    }
    const double gap = largest_gap(bounds);
    if (gap > kMostGap) return by_triangles(std::move(result), true);
    const double epsilon = std::max({1e-8, 8 * kRounding * scale_, 2 * gap});
    const std::vector<Vector3d> within = Samples(mesh_, triangles_.of(index), *result.surface).find(deflection);
    result.trim = std::make_unique<FaceTrim>(*result.surface, std::move(bounds), within, epsilon);
    if (result.trim->is_loose()) return by_triangles(std::move(result), true);
    // From a triangle that touches the grown voxel to the surface beside it, and to a bound beyond that.
    result.nearness = std::sqrt(3.0) * (0.5 + result.deflection) + 2 * result.deflection;
    return result;
  }

 private:
  static PreparedFace by_triangles(PreparedFace face, bool is_loose) {
    face.trim = nullptr;
    face.deflection = kCandidateMargin;
    face.is_loose = is_loose;
    return face;
  }

  [[nodiscard]] double deflection_of(std::size_t index, const GridSurface& surface) const {
    double farthest = 0;
    for (const std::uint32_t t : triangles_.of(index)) {
      farthest = std::max(farthest, triangle_deflection(surface, mesh_.corners(t)));
    }
    for (const std::uint32_t e : part_.faces[index].edges) {
      farthest = std::max(farthest, scale_ * edge_deflection(part_.edges[e]));
    }
    return farthest;
  }

  const Part& part_;
  const GridMesh& mesh_;
  const Voxmap& map_;
  double scale_;
  TrianglesOfFaces triangles_;
};

}  // namespace

std::vector<PreparedFace> prepare_faces(const Part& part, const GridMesh& mesh, const Voxmap& map) {
  const Preparation preparation(part, mesh, map);
  std::vector<PreparedFace> faces;
  faces.reserve(part.faces.size());
  for (std::size_t i = 0; i < part.faces.size(); ++i) faces.push_back(preparation.prepare(i));
  return faces;
}

}  // namespace verisim

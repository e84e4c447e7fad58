// Works on the triangles as they are instead of on CGAL's halfedge meshes, which can
// hold no non-manifold edge; the predicates are exact, so the answer does not depend on the machine.
#include "engine/geometry/self_intersection.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/mesh_edges.hpp"

namespace verisim {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;
using Triangle = std::array<std::uint32_t, 3>;

class Crossings {
 public:
  explicit Crossings(const TriangleMesh& mesh) : mesh_(mesh), shallow_(bounds_of(mesh).size().norm() / 2000) {}

  /// True if triangles s and t meet elsewhere than at common corners and edges, and one reaches through the other's
  /// plane by more than the accuracy of tessellations.
  [[nodiscard]] bool cross(const Triangle& s, const Triangle& t) const {
    if (reach(s, t) <= std::min(shallow_, 0.05 * std::max(longest_side(s), longest_side(t)))) return false;
    // Common corners first, in the same order in both: then the cases differ by their number only.
    Triangle a = s;
    Triangle b = t;
    unsigned shared = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const auto match = std::find(b.begin() + shared, b.end(), a[i]);
      if (match == b.end()) continue;
      std::swap(a[i], a[shared]);
      std::iter_swap(match, b.begin() + shared);
      ++shared;
    }
    if (shared >= 2) return false;  // on a common edge they cross only if they lie in one plane
    if (shared == 1) {
      return CGAL::do_intersect(triangle(a), Kernel::Segment_3(point(b[1]), point(b[2]))) ||
             CGAL::do_intersect(triangle(b), Kernel::Segment_3(point(a[1]), point(a[2])));
    }
    return CGAL::do_intersect(triangle(a), triangle(b));
  }

 private:
  /// How far one triangle reaches through the other's plane. Zero if both lie in one plane.
  [[nodiscard]] double reach(const Triangle& s, const Triangle& t) const {
    return std::max(reach_through(s, t), reach_through(t, s));
  }
  [[nodiscard]] double reach_through(const Triangle& plane, const Triangle& t) const {
    const auto& v = mesh_.vertices;
    const Vector3d normal = (v[plane[1]] - v[plane[0]]).cross(v[plane[2]] - v[plane[0]]).normalized();
    double above = 0;
    double below = 0;
    for (const std::uint32_t corner : t) {
      const double height = normal.dot(v[corner] - v[plane[0]]);
      above = std::max(above, height);
      below = std::max(below, -height);
    }
    return std::min(above, below);
  }
  [[nodiscard]] double longest_side(const Triangle& t) const {
    const auto& v = mesh_.vertices;
    return std::max({(v[t[0]] - v[t[1]]).norm(), (v[t[1]] - v[t[2]]).norm(), (v[t[2]] - v[t[0]]).norm()});
  }
  [[nodiscard]] Kernel::Point_3 point(std::uint32_t i) const {
    const Vector3d& p = mesh_.vertices[i];
    return {p.x(), p.y(), p.z()};
  }
  [[nodiscard]] Kernel::Triangle_3 triangle(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }

  const TriangleMesh& mesh_;
  double shallow_;  // m, the accuracy of a CAD part's default tessellation
};

std::vector<Box> boxes_of(const TriangleMesh& mesh) {
  std::vector<Box> boxes;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_degenerate(mesh, mesh.triangles[t])) continue;
    Bounds bounds;
    for (const std::uint32_t corner : mesh.triangles[t]) bounds.include(mesh.vertices[corner]);
    boxes.emplace_back(
        CGAL::Bbox_3(bounds.min.x(), bounds.min.y(), bounds.min.z(), bounds.max.x(), bounds.max.y(), bounds.max.z()),
        t);
  }
  return boxes;
}

}  // namespace

SelfIntersections find_self_intersections(const TriangleMesh& mesh) {
  VERISIM_ASSERT(is_whole(mesh));
  for (const Vector3d& v : mesh.vertices) VERISIM_ASSERT(is_finite(v));
  const Crossings crossings(mesh);
  SelfIntersections found;
  std::pair<std::uint32_t, std::uint32_t> first = {kNoFace, kNoFace};
  std::vector<Box> boxes = boxes_of(mesh);
  // The sweep visits pairs in an order of its own: the count and the smallest pair do not depend on it.
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    const auto [s, t] = std::minmax({a.info(), b.info()});  // by value: info() returns one
    if (!crossings.cross(mesh.triangles[s], mesh.triangles[t])) return;
    ++found.pairs;
    first = std::min(first, {s, t});
  });
  if (found.pairs > 0) {
    Bounds bounds;
    for (const std::uint32_t corner : mesh.triangles[first.first]) bounds.include(mesh.vertices[corner]);
    found.where = bounds.center();
  }
  return found;
}

}  // namespace verisim

#include "engine/geometry/mesh_joints.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// The ends of open sides, sorted along the direction in which they spread most (equal places: by number).
class Ends {
 public:
  Ends(const TriangleMesh& mesh, const std::vector<Side>& open) : mesh_(mesh) {
    Bounds bounds;
    for (const Side& side : open) {
      for (const std::uint32_t end : {side.low, side.high}) {
        VERISIM_ASSERT(end < mesh.vertices.size());
        VERISIM_ASSERT(is_finite(mesh.vertices[end]));
        bounds.include(mesh.vertices[end]);
        sorted_.push_back(end);
      }
    }
    bounds.size().maxCoeff(&axis_);
    const auto key = [&](std::uint32_t end) { return std::pair(place(end), end); };
    std::sort(sorted_.begin(), sorted_.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    sorted_.erase(std::unique(sorted_.begin(), sorted_.end()), sorted_.end());
  }

  [[nodiscard]] const std::vector<std::uint32_t>& sorted() const { return sorted_; }
  [[nodiscard]] double place(std::uint32_t end) const { return mesh_.vertices[end][axis_]; }

  /// Calls visit(end) for those between the places `from` and `to`, both included.
  template <typename Visit>
  void for_each_between(double from, double to, Visit&& visit) const {
    auto end = std::lower_bound(sorted_.begin(), sorted_.end(), from,
                                [&](std::uint32_t candidate, double limit) { return place(candidate) < limit; });
    for (; end != sorted_.end() && place(*end) <= to; ++end) visit(*end);
  }

 private:
  const TriangleMesh& mesh_;
  Eigen::Index axis_ = 0;
  std::vector<std::uint32_t> sorted_;
};

/// Position of p along the line from a to b [m]; below zero if p is beside that line or not strictly between the two.
double place_on_side(const Vector3d& a, const Vector3d& b, const Vector3d& p, double tolerance) {
  const double length = (b - a).norm();
  if (length <= 2 * tolerance) return -1;
  const Vector3d direction = (b - a) / length;
  const double along = direction.dot(p - a);
  const bool between = along > tolerance && along < length - tolerance;
  return between && (p - a - along * direction).norm() <= tolerance ? along : -1;
}

/// One triangle, rotated so that its open side comes first, and the ends that lie on that side in order from a to b.
struct Cut {
  std::uint32_t a = 0, b = 0, apex = 0;
  std::vector<std::uint32_t> corners;
};

Cut cut_of(const TriangleMesh& mesh, const Side& side, const Ends& ends, double tolerance) {
  const auto [from, to] = side.forward ? std::pair(side.low, side.high) : std::pair(side.high, side.low);
  Cut cut = {from, to, 0, {}};
  for (const std::uint32_t corner : mesh.triangles[side.triangle]) {
    if (corner != from && corner != to) cut.apex = corner;
  }
  const auto [first, last] = std::minmax({ends.place(from), ends.place(to)});
  std::vector<std::pair<double, std::uint32_t>> found;
  ends.for_each_between(first - tolerance, last + tolerance, [&](std::uint32_t end) {
    if (end == cut.apex) return;
    const double along = place_on_side(mesh.vertices[cut.a], mesh.vertices[cut.b], mesh.vertices[end], tolerance);
    if (along > 0) found.emplace_back(along, end);
  });
  std::sort(found.begin(), found.end());
  for (const auto& [along, end] : found) cut.corners.push_back(end);
  return cut;
}

}  // namespace

std::vector<Side> open_sides(const TriangleMesh& mesh) {
  std::vector<Side> open;
  for_each_edge(sorted_sides(mesh), [&](std::span<const Side> edge) {
    if (edge.size() == 1) open.push_back(edge.front());
  });
  return open;
}

std::size_t join_near_corners(TriangleMesh& mesh, const std::vector<Side>& open, double tolerance) {
  VERISIM_ASSERT(is_not_negative(tolerance));
  const Ends ends(mesh, open);
  std::vector<std::uint32_t> becomes(mesh.vertices.size());
  std::iota(becomes.begin(), becomes.end(), 0U);
  std::vector<bool> settled(mesh.vertices.size());
  std::size_t given_up = 0;
  for (const std::uint32_t keeper : ends.sorted()) {
    if (settled[keeper]) continue;
    settled[keeper] = true;
    ends.for_each_between(ends.place(keeper), ends.place(keeper) + tolerance, [&](std::uint32_t end) {
      if (settled[end]) return;
      if ((mesh.vertices[end] - mesh.vertices[keeper]).norm() > tolerance) return;
      settled[end] = true;
      becomes[end] = keeper;
      ++given_up;
    });
  }
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = becomes[corner];
  }
  return given_up;
}

std::size_t cut_at_joints(TriangleMesh& mesh, const std::vector<Side>& open, double tolerance) {
  VERISIM_ASSERT(is_not_negative(tolerance));
  for (const Side& side : open) VERISIM_ASSERT(side.triangle < mesh.triangles.size());
  const Ends ends(mesh, open);
  std::vector<Cut> cuts(mesh.triangles.size());
  std::size_t count = 0;
  for (const Side& side : open) {
    if (!cuts[side.triangle].corners.empty()) continue;
    cuts[side.triangle] = cut_of(mesh, side, ends, tolerance);
    if (!cuts[side.triangle].corners.empty()) ++count;
  }
  if (count == 0) return 0;

  TriangleMesh pieces;
  const auto keep = [&](const std::array<std::uint32_t, 3>& triangle, std::size_t of) {
    pieces.triangles.push_back(triangle);
    if (!mesh.face_of_triangle.empty()) pieces.face_of_triangle.push_back(mesh.face_of_triangle[of]);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Cut& cut = cuts[t];
    if (cut.corners.empty()) {
      keep(mesh.triangles[t], t);
      continue;
    }
    const auto& v = mesh.vertices;
    if (place_on_side(v[cut.a], v[cut.b], v[cut.apex], tolerance) > 0) continue;
    std::uint32_t previous = cut.a;
    for (const std::uint32_t corner : cut.corners) {
      keep({previous, corner, cut.apex}, t);
      previous = corner;
    }
    keep({previous, cut.b, cut.apex}, t);
  }
  mesh.triangles = std::move(pieces.triangles);
  mesh.face_of_triangle = std::move(pieces.face_of_triangle);
  return count;
}

}  // namespace verisim

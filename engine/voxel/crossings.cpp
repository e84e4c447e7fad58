#include "engine/voxel/crossings.hpp"

#include <algorithm>
#include <optional>

#include "engine/base/error.hpp"

namespace verisim {

namespace {

struct Crossing {
  int sign;  ///< change of the winding number
  double x;  ///< where, within the triangle's chord on the line
};

/// The crossing of a triangle by the line along x at (y, z). Each edge is half-open in y and interpolated from its
/// lower end, so two triangles decide alike about their common edge, and exactly one of them has the crossing. On a
/// closed surface the sum is right even if the line passes through an edge, a corner or a triangle seen edge-on.
std::optional<Crossing> cross(const std::array<Vector3d, 3>& corners, double y, double z) {
  int above = 0;  // edges that pass above z: toward +y count up, toward -y down
  std::array<Vector3d, 2> chord;
  std::size_t hits = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % 3];
    if ((a.y() <= y) == (b.y() <= y)) continue;
    const bool upward = a.y() < b.y();
    const Vector3d& low = upward ? a : b;
    const Vector3d& high = upward ? b : a;
    const double s = (y - low.y()) / (high.y() - low.y());
    const Vector3d p = low + s * (high - low);
    if (p.z() > z) above += upward ? 1 : -1;
    chord[hits++] = p;
  }
  if (above == 0) return std::nullopt;
  const auto& [p, q] = chord;
  const double s = std::clamp((z - p.z()) / (q.z() - p.z()), 0.0, 1.0);
  return Crossing{above, p.x() + s * (q.x() - p.x())};
}

}  // namespace

int winding_change(const GridMesh& mesh, const BrickLists& lists, const Eigen::Vector3i& bricks,
                   const Eigen::Vector3i& from, int to_x) {
  VERISIM_ASSERT((from.array() >= 0).all());
  VERISIM_ASSERT((from.array() < kBrickSide * bricks.array()).all());
  VERISIM_ASSERT(from.x() <= to_x);
  VERISIM_ASSERT(to_x < kBrickSide * bricks.x());
  const double y = from.y() + 0.5, z = from.z() + 0.5;
  int change = 0;
  for (int bx = from.x() / kBrickSide; bx <= to_x / kBrickSide; ++bx) {
    // A triangle is listed in every brick it touches; its crossing belongs to one.
    const double begin = std::max(from.x() + 0.5, static_cast<double>(kBrickSide * bx));
    const double end = std::min(to_x + 0.5, static_cast<double>(kBrickSide * (bx + 1)));
    for (const std::uint32_t t : lists.of(brick_index(bx, from.y() / kBrickSide, from.z() / kBrickSide, bricks))) {
      const std::optional<Crossing> crossing = cross(mesh.corners(t), y, z);
      if (crossing && crossing->x >= begin && crossing->x < end) change += crossing->sign;
    }
  }
  return change;
}

}  // namespace verisim

#include "engine/geometry/recover/piece.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/flat_regions.hpp"

namespace verisim::recover {

namespace {

constexpr double kQuarterOfATube = -0.2;  // cosine: a fan at most spans a fillet
constexpr double kNoise = 4;              // tolerances: nearer to an axis no direction, lower than that no area

}  // namespace

/// The corners in the surface's own coordinates.
struct Piece::Corners {
  std::array<Vector3d, 3> gradient, outward;
  std::array<Eigen::Vector2d, 3> tube;  ///< unit, in the half plane of the corner: from the tube's middle
  std::array<double, 3> rho, height;

  Corners(const CanonicalMesh& mesh, std::uint32_t t, const SurfaceValue& s, double tolerance) {
    std::array<bool, 3> on_axis{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& p = mesh.corner(t, i);
      const Profile f = profile_of(p, s.point, s.axis);
      gradient[i] = s.gradient(p);
      outward[i] = f.outward;
      rho[i] = f.rho;
      height[i] = f.height;
      tube[i] = Eigen::Vector2d(f.rho - s.a, f.height).normalized();
      on_axis[i] = f.rho <= kNoise * tolerance;
    }
    for (std::size_t i = 0; i < 3; ++i) {  // an apex is in every direction: in that of the others
      if (!on_axis[i]) continue;
      const Vector3d sum = outward[(i + 1) % 3] + outward[(i + 2) % 3];
      if (sum.norm() > 0) outward[i] = sum.normalized();
      gradient[i] = (gradient[(i + 1) % 3] + gradient[(i + 2) % 3]).normalized();
    }
  }
};

bool Piece::is_on(std::uint32_t t) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_rim = limits_.is_rim != nullptr && (*limits_.is_rim)[mesh_.triangles[t][i]];
    const double within = (is_rim ? limits_.thresholds.rim : 1) * limits_.tolerance;
    if (std::abs(surface_.distance(mesh_.corner(t, i))) > within) return false;
  }
  return true;
}

/// Area of the triangle in the surface's coordinates; negative if it is turned over.
Piece::Cover Piece::cover_of(const Corners& c) const {
  const double rho = (c.rho[0] + c.rho[1] + c.rho[2]) / 3;
  std::array<Eigen::Vector2d, 2> sides;
  for (std::size_t i = 0; i < 2; ++i) {
    double along = c.height[i + 1] - c.height[0];
    if (surface_.kind == Kind::cone) along *= std::sqrt(1 + surface_.b * surface_.b);
    if (surface_.kind == Kind::torus) {
      const Eigen::Vector2d &from = c.tube[0], &to = c.tube[i + 1];
      along = surface_.b * pinned::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    }
    sides[i] = {rho * surface_.axis.dot(c.outward[0].cross(c.outward[i + 1])), along};
  }
  const double area = 0.5 * (sides[0].x() * sides[1].y() - sides[0].y() * sides[1].x());
  const double length = std::max({sides[0].norm(), sides[1].norm(), (sides[1] - sides[0]).norm()});
  return {limits_.inside_out ? -area : area, length};
}

bool Piece::is_regular(std::uint32_t t) const {
  if (!is_on(t)) return false;
  const Corners c(mesh_, t, surface_, limits_.tolerance);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if (c.gradient[i].dot(c.gradient[k]) < limits_.cos_step) return false;
    if (surface_.kind != Kind::sphere && surface_.kind != Kind::plane &&
        c.outward[i].dot(c.outward[k]) < limits_.cos_step)
      return false;
    if (surface_.kind == Kind::torus && c.tube[i].dot(c.tube[k]) < limits_.cos_step) return false;
  }
  if (mesh_.heights[t] <= kSliver * limits_.tolerance) return true;
  const double along = (c.gradient[0] + c.gradient[1] + c.gradient[2]).normalized().dot(mesh_.normals[t]);
  if ((limits_.inside_out ? -along : along) <= limits_.thresholds.nearly_tangent) return false;
  return surface_.kind == Kind::sphere || cover_of(c).area > limits_.thresholds.covers * mesh_.areas[t];
}

bool Piece::is_possible(std::uint32_t t) const {
  if (!is_on(t)) return false;
  const Corners c(mesh_, t, surface_, limits_.tolerance);
  const bool is_sphere = surface_.kind == Kind::sphere;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if ((is_sphere ? c.gradient : c.outward)[i].dot((is_sphere ? c.gradient : c.outward)[k]) < limits_.cos_step)
      return false;
    if (surface_.kind == Kind::torus && c.tube[i].dot(c.tube[k]) < kQuarterOfATube) return false;
  }
  if (mesh_.heights[t] <= kSliver * limits_.tolerance) return true;
  if (is_sphere) {
    const double along = (c.gradient[0] + c.gradient[1] + c.gradient[2]).normalized().dot(mesh_.normals[t]);
    return (limits_.inside_out ? -along : along) > limits_.thresholds.covers;
  }
  const Cover cover = cover_of(c);
  return cover.area > kNoise * limits_.tolerance * cover.length;
}

}  // namespace verisim::recover

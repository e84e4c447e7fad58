#include "engine/geometry/recover/inlier_test.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::recover {

/// The corners in the surface's own parameters.
struct InlierTest::Corners {
  std::array<Vector3d, 3> gradient, outward;
  std::array<Eigen::Vector2d, 3> tube;  ///< unit, in the corner's meridian half plane: from the tube's centre
  std::array<double, 3> rho, height;

  /// @param noise  m: nearer to the axis, a direction from it means nothing
  Corners(const CanonicalMesh& mesh, std::uint32_t t, const SurfaceValue& s, double noise) {
    std::array<bool, 3> on_axis{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& p = mesh.corner(t, i);
      const Profile f = profile_of(p, s.point, s.axis);
      gradient[i] = s.gradient(p);
      outward[i] = f.outward;
      rho[i] = f.rho;
      height[i] = f.height;
      tube[i] = Eigen::Vector2d(f.rho - s.a, f.height).normalized();
      on_axis[i] = f.rho <= noise;
    }
    for (std::size_t i = 0; i < 3; ++i) {  // on the axis every direction is outward: take that of the others
      if (!on_axis[i]) continue;
      const Vector3d sum = outward[(i + 1) % 3] + outward[(i + 2) % 3];
      if (sum.norm() > 0) outward[i] = sum.normalized();
      gradient[i] = (gradient[(i + 1) % 3] + gradient[(i + 2) % 3]).normalized();
    }
  }
};

bool InlierTest::is_on_surface(std::uint32_t t) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const bool on_sharp_edge = limits_.on_sharp_edge != nullptr && (*limits_.on_sharp_edge)[mesh_.triangles[t][i]];
    const double within = (on_sharp_edge ? limits_.thresholds.sharp_edge_slack : 1) * limits_.tolerance;
    if (std::abs(surface_.distance(mesh_.corner(t, i))) > within) return false;
  }
  return true;
}

InlierTest::ParameterImage InlierTest::parameter_image(const Corners& c) const {
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
  return {limits_.is_hole ? -area : area, length};
}

bool InlierTest::is_inlier(std::uint32_t t) const {
  if (!is_on_surface(t)) return false;
  const Corners c(mesh_, t, surface_, limits_.thresholds.noise * limits_.tolerance);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if (c.gradient[i].dot(c.gradient[k]) < limits_.cos_step) return false;
    if (surface_.kind != Kind::sphere && surface_.kind != Kind::plane &&
        c.outward[i].dot(c.outward[k]) < limits_.cos_step)
      return false;
    if (surface_.kind == Kind::torus && c.tube[i].dot(c.tube[k]) < limits_.cos_step) return false;
  }
  if (mesh_.heights[t] <= limits_.thresholds.sliver * limits_.tolerance) return true;
  const double along = (c.gradient[0] + c.gradient[1] + c.gradient[2]).normalized().dot(mesh_.normals[t]);
  if ((limits_.is_hole ? -along : along) <= limits_.thresholds.nearly_tangent) return false;
  return surface_.kind == Kind::sphere ||
         parameter_image(c).area > limits_.thresholds.parameter_area_min * mesh_.areas[t];
}

bool InlierTest::is_loose_inlier(std::uint32_t t) const {
  if (!is_on_surface(t)) return false;
  const Corners c(mesh_, t, surface_, limits_.thresholds.noise * limits_.tolerance);
  const bool is_sphere = surface_.kind == Kind::sphere;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if ((is_sphere ? c.gradient : c.outward)[i].dot((is_sphere ? c.gradient : c.outward)[k]) < limits_.cos_step)
      return false;
    if (surface_.kind == Kind::torus && c.tube[i].dot(c.tube[k]) < limits_.thresholds.fillet_span) return false;
  }
  if (mesh_.heights[t] <= limits_.thresholds.sliver * limits_.tolerance) return true;
  if (is_sphere) {
    const double along = (c.gradient[0] + c.gradient[1] + c.gradient[2]).normalized().dot(mesh_.normals[t]);
    return (limits_.is_hole ? -along : along) > limits_.thresholds.parameter_area_min;
  }
  const ParameterImage image = parameter_image(c);
  return image.area > limits_.thresholds.noise * limits_.tolerance * image.length;
}

}  // namespace verisim::recover

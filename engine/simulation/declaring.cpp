#include "engine/simulation/declaring.hpp"

#include <cmath>
#include <numbers>

#include "engine/base/error.hpp"
#include "engine/geometry/analytic_surface.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {
namespace {

/// From a point to an unbounded surface or curve, m; 0 where it is not known.
struct DistanceFrom {
  Vector3d p;

  double operator()(const Face& face) const {
    const auto surface = AnalyticSurface::from(face.surface);
    return surface ? std::abs(surface->at(p).distance) : 0;
  }
  double operator()(const Edge& edge) const { return std::visit(*this, edge.curve); }
  double operator()(const Line& line) const {
    const Vector3d arm = p - line.point;
    return (arm - arm.dot(line.direction) * line.direction).norm();
  }
  double operator()(const Circle& circle) const {
    const Vector3d arm = p - circle.center;
    const double height = arm.dot(circle.normal);
    const double beside = (arm - height * circle.normal).norm() - circle.radius;
    return std::sqrt(height * height + beside * beside);
  }
  double operator()(const Ellipse&) const { return 0; }
  double operator()(const OtherCurve&) const { return 0; }
};

struct NameOf {
  const char* operator()(const Face& face) const { return kSurfaceNames[face.surface.index()]; }
  const char* operator()(const Edge& edge) const { return kCurveNames[edge.curve.index()]; }
};

/// A fitted shape is off by a voxel or two; what is further away was meant for another place, or in another unit.
void check_near(const std::string& body, const Vector3d& center, double voxel_size,
                std::span<const DeclaredFeatures::Entity> set) {
  const double most = 2 * std::numbers::sqrt3 * voxel_size;
  for (const DeclaredFeatures::Entity& entity : set) {
    const double distance = std::visit(DistanceFrom{center}, entity);
    if (distance > most)
      fail(ErrorKind::input,
           "'{}': the {} declared for the voxel at ({:g}, {:g}, {:g}) is {:.4g} mm away from it, {:.3g} mm at most are "
           "taken; declare it where it passes",
           body, std::visit(NameOf{}, entity), center.x(), center.y(), center.z(), 1e3 * distance, 1e3 * most);
  }
}

}  // namespace

Declaring::Declaring(const BodyDescription& body) {
  VoxelizeOptions options;
  options.voxel_size = body.voxel_size;
  voxels_ = voxelize(body.name, merged(body.parts).mesh, options);
}

Vector3d Declaring::center(std::uint32_t voxel) const {
  VERISIM_ASSERT(voxel < surface_voxels());
  const Pointshell& shell = voxels_.shell;
  // The shell has it in single precision; the grid has it to the last bit.
  const Vector3d near = shell.reference + Vector3d(shell.x[voxel], shell.y[voxel], shell.z[voxel]);
  return voxels_.voxmap.center_of(voxels_.voxmap.cell_of(near));
}

std::size_t Declaring::memory_bytes() const {
  return voxels_.voxmap.memory_bytes() + voxels_.shell.memory_bytes();
}

FeatureSetId Declaring::give(BodyDescription& body, const Vector3d& p,
                             std::span<const DeclaredFeatures::Entity> set) const {
  VERISIM_ASSERT(body.voxel_size == voxels_.voxmap.voxel_size);
  const std::int64_t voxel = voxels_.voxmap.surface_number(voxels_.voxmap.cell_of(p));
  if (voxel < 0)
    fail(ErrorKind::input, "({:g}, {:g}, {:g}) is in no surface voxel of '{}'; give the centre of one", p.x(), p.y(),
         p.z(), body.name);
  if (!body.declared) body.declared = std::make_shared<DeclaredFeatures>();
  const FeatureSetId id = body.declared->add(body.name, set);
  check_near(body.name, center(static_cast<std::uint32_t>(voxel)), voxels_.voxmap.voxel_size, set);
  body.declared->assign(voxels_, static_cast<std::uint32_t>(voxel), id);
  return id;
}

}  // namespace verisim

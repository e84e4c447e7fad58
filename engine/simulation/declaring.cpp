#include "engine/simulation/declaring.hpp"

#include "engine/base/error.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {

Declaring::Declaring(const BodyDescription& body) {
  VoxelizeOptions options;
  options.voxel_size = body.voxel_size;
  voxels_ = voxelize(body.name, merged(body.parts).mesh, options);
}

Vector3d Declaring::center(std::uint32_t voxel) const {
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
  const std::int64_t voxel = voxels_.voxmap.surface_number(voxels_.voxmap.cell_of(p));
  if (voxel < 0)
    fail(ErrorKind::input, "({:g}, {:g}, {:g}) is in no surface voxel of '{}'; give the centre of one", p.x(), p.y(),
         p.z(), body.name);
  if (!body.declared) body.declared = std::make_shared<DeclaredFeatures>();
  const FeatureSetId id = body.declared->add(body.name, set);
  body.declared->assign(voxels_, static_cast<std::uint32_t>(voxel), id);
  return id;
}

}  // namespace verisim

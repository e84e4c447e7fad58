#include "engine/stability/parts.hpp"

#include "engine/geometry/mesh.hpp"

namespace verisim::stability {

Part box_part(const std::string& name, const Vector3d& size) {
  Part part;
  part.name = name;
  part.watertight = true;
  TriangleMesh& mesh = part.mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) != 0 ? size.x() / 2 : -size.x() / 2, (i & 2) != 0 ? size.y() / 2 : -size.y() / 2,
                               (i & 4) != 0 ? size.z() / 2 : -size.z() / 2);
  using Quad = std::array<std::uint32_t, 4>;
  for (const auto& [a, b, c, d] :
       {Quad{0, 2, 3, 1}, Quad{4, 5, 7, 6}, Quad{0, 1, 5, 4}, Quad{2, 6, 7, 3}, Quad{0, 4, 6, 2}, Quad{1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  part.mass = mass_properties_of(mesh);
  part.area = area_of(mesh);
  return part;
}

BodyDescription box_body(const std::string& name, const Vector3d& size, double mass, double voxel_size) {
  BodyDescription body;
  body.name = name;
  body.parts.push_back(box_part(name, size));
  body.density = mass / size.prod();
  body.voxel_size = voxel_size;
  return body;
}

}  // namespace verisim::stability

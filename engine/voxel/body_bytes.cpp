#include "engine/voxel/body_bytes.hpp"

#include "engine/base/archive.hpp"

namespace verisim {
// Found by archive.hpp, by the types' namespace.

void fields(auto& archive, Plane& s) {
  archive(s.point, s.normal, s.x_axis);
}
void fields(auto& archive, Cylinder& s) {
  archive(s.point, s.direction, s.x_axis, s.radius, s.hole);
}
void fields(auto& archive, Cone& s) {
  archive(s.point, s.direction, s.x_axis, s.radius, s.half_angle, s.hole);
}
void fields(auto& archive, Sphere& s) {
  archive(s.center, s.direction, s.x_axis, s.radius, s.hole);
}
void fields(auto& archive, Torus& s) {
  archive(s.center, s.direction, s.x_axis, s.major_radius, s.minor_radius, s.hole);
}
void fields(auto& archive, Line& c) {
  archive(c.point, c.direction);
}
void fields(auto& archive, Circle& c) {
  archive(c.center, c.normal, c.x_axis, c.radius);
}
void fields(auto& archive, Ellipse& c) {
  archive(c.center, c.normal, c.x_axis, c.major_radius, c.minor_radius);
}
void fields(auto& /*archive*/, OtherSurface& /*nothing*/) {}
void fields(auto& /*archive*/, OtherCurve& /*nothing*/) {}

void fields(auto& archive, Face& f) {
  archive(f.surface, f.u_range, f.v_range, f.area, f.edges);
}
void fields(auto& archive, Edge& e) {
  archive(e.curve, e.t_range, e.length, e.polyline, e.faces);
}
void fields(auto& archive, Pointshell::Cluster& c) {
  archive(c.begin, c.end, c.center, c.radius);
}
void fields(auto& archive, VoxelBody& body) {
  auto& [origin, voxel_size, bricks, brick_block, brick_clearance, layers, mask, first_surface, count] = body.voxmap;
  archive(origin, voxel_size, bricks, brick_block, brick_clearance, layers, mask, first_surface, count);
  auto& [x, y, z, nx, ny, nz, voxel, features, clusters, reference] = body.shell;
  archive(x, y, z, nx, ny, nz, voxel, features, clusters, reference);
  auto& [faces, edges, sets] = body.features;
  archive(faces, edges, sets, body.slot_sets);
}

std::string to_bytes(const VoxelBody& body) {
  ArchiveWriter writer;
  writer(body);
  return std::move(writer.bytes);
}

VoxelBody voxel_body_from(std::string_view bytes) {
  ArchiveReader reader(bytes);
  VoxelBody body;
  reader(body);
  if (!reader.is_at_end()) fail(ErrorKind::input, "the voxels of a body go on behind their end");
  return body;
}

}  // namespace verisim

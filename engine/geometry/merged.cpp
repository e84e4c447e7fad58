#include "engine/geometry/merged.hpp"

#include "engine/base/error.hpp"

namespace verisim {
namespace {

void append_mesh(const Part& part, std::uint32_t first_face, TriangleMesh& all) {
  const auto first_vertex = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
  for (std::size_t i = 0; i < part.mesh.triangles.size(); ++i) {
    const auto& t = part.mesh.triangles[i];
    all.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});
    const std::uint32_t face = part.mesh.face_of_triangle.empty() ? kNoFace : part.mesh.face_of_triangle[i];
    all.face_of_triangle.push_back(face == kNoFace ? kNoFace : face + first_face);
  }
}

void append_entities(const Part& part, Part& all) {
  const auto first_face = static_cast<std::uint32_t>(all.faces.size());
  const auto first_edge = static_cast<std::uint32_t>(all.edges.size());
  for (Face face : part.faces) {
    for (std::uint32_t& edge : face.edges) edge += first_edge;
    all.faces.push_back(std::move(face));
  }
  for (Edge edge : part.edges) {
    for (std::uint32_t& face : edge.faces) face += first_face;
    all.edges.push_back(std::move(edge));
  }
}

MassProperties combined(const std::vector<Part>& parts) {
  MassProperties total;
  for (const Part& part : parts) {
    total.volume += part.mass.volume;
    total.centroid += part.mass.volume * part.mass.centroid;
  }
  total.centroid /= total.volume;
  for (const Part& part : parts) {
    const Vector3d arm = part.mass.centroid - total.centroid;
    total.inertia +=
        part.mass.inertia + part.mass.volume * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
  }
  return total;
}

}  // namespace

Part merged(const std::vector<Part>& parts) {
  VERISIM_ASSERT(!parts.empty());
  for (const Part& part : parts)
    VERISIM_ASSERT(part.mesh.face_of_triangle.empty() ||
                   part.mesh.face_of_triangle.size() == part.mesh.triangles.size());
  Part all;
  all.name = parts.front().name;
  all.color = parts.front().color;
  all.watertight = all.exact = true;
  for (const Part& part : parts) {
    append_mesh(part, static_cast<std::uint32_t>(all.faces.size()), all.mesh);
    append_entities(part, all);
    all.area += part.area;
    all.watertight = all.watertight && part.watertight;
    all.exact = all.exact && part.exact;
  }
  if (all.faces.empty()) all.mesh.face_of_triangle.clear();
  all.mass = combined(parts);
  return all;
}

}  // namespace verisim

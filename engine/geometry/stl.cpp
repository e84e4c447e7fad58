#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/geometry/write_file.hpp"

namespace verisim {
namespace {

void put(std::string& out, float value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put(std::string& out, const Vector3d& v) {
  for (const double c : {v.x(), v.y(), v.z()}) put(out, static_cast<float>(c));
}

}  // namespace

void write_file(const std::string& path, const std::string& content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) {
    fail(ErrorKind::io, "{}: cannot be written ({}); check the folder and the space left", path,
         std::generic_category().message(errno));
  }
}

void write_stl(const std::string& path, const TriangleMesh& mesh, double units_per_metre) {
  VERISIM_ASSERT(is_whole(mesh));
  VERISIM_ASSERT(is_positive(units_per_metre));
  std::string out = "binary STL written by verisim";  // a head that began with "solid" would be taken for ASCII
  out.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  out.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector3d a = units_per_metre * mesh.vertices[i];
    const Vector3d b = units_per_metre * mesh.vertices[j];
    const Vector3d c = units_per_metre * mesh.vertices[k];
    const Vector3d normal = (b - a).cross(c - a);
    put(out, normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d::Zero());
    for (const Vector3d& corner : {a, b, c}) put(out, corner);
    out.append(2, '\0');
  }
  write_file(path, out);
}

}  // namespace verisim

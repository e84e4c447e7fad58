// How much of drawn parts is found again in their bare triangles: every face of the STEP file against what recovery
// made of the triangles that stand for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <cstring>
#include <vector>

#include "engine/geometry/recover.hpp"
#include "tests/geometry/models.hpp"
#include "tests/geometry/parametrization.hpp"

namespace verisim {
namespace {

/// A part's triangles in millimetres and single precision, as a binary STL file has them; the drawn face of each.
struct Bare {
  Part part;
  std::vector<std::uint32_t> drawn_face_of;
};

Bare bare(const Part& drawn) {
  Bare result;
  result.part.name = drawn.name;
  result.part.mesh = drawn.mesh;
  for (Vector3d& p : result.part.mesh.vertices) p = 0.001 * (1000 * p).cast<float>().cast<double>();
  std::vector<std::string> notes;
  repair(result.part.mesh, notes);
  std::swap(result.drawn_face_of, result.part.mesh.face_of_triangle);
  return result;
}

bool near(double found, double drawn) {
  return std::abs(found - drawn) <= 0.001 * drawn;
}

/// The same kind with the same sizes to 0.1 %, the material on the same side. Where it lies is left to the vertices,
/// which are on both.
bool is_again(const Surface& found, const Surface& drawn) {
  if (found.index() != drawn.index()) return false;
  if (const auto* d = std::get_if<Plane>(&drawn)) return std::get<Plane>(found).normal.dot(d->normal) > 1 - 1e-6;
  if (const auto* d = std::get_if<Cylinder>(&drawn)) {
    const auto& f = std::get<Cylinder>(found);
    return near(f.radius, d->radius) && f.hole == d->hole;
  }
  if (const auto* d = std::get_if<Cone>(&drawn)) {
    const auto& f = std::get<Cone>(found);
    return near(f.half_angle, d->half_angle) && f.hole == d->hole;
  }
  if (const auto* d = std::get_if<Sphere>(&drawn)) {
    const auto& f = std::get<Sphere>(found);
    return near(f.radius, d->radius) && f.hole == d->hole;
  }
  if (const auto* d = std::get_if<Torus>(&drawn)) {
    const auto& f = std::get<Torus>(found);
    return near(f.major_radius, d->major_radius) && near(f.minor_radius, d->minor_radius) && f.hole == d->hole;
  }
  return true;
}

struct Share {
  int faces_drawn = 0, faces_again = 0, faces_found = 0, torn = 0, triangles = 0;
  double area_drawn = 0, area_again = 0;
  double seconds = 0;
  std::map<std::string, int> missing;
};

std::string told(const Surface& s) {
  if (const auto* d = std::get_if<Cylinder>(&s)) return fmt::format("cylinder {}", d->radius);
  if (const auto* d = std::get_if<Cone>(&s)) return fmt::format("cone {}", d->half_angle);
  if (const auto* d = std::get_if<Sphere>(&s)) return fmt::format("sphere {}", d->radius);
  if (const auto* d = std::get_if<Torus>(&s)) return fmt::format("torus {} {}", d->major_radius, d->minor_radius);
  return kSurfaceNames[s.index()];
}

void tell(const Part& part, const Part& drawn, const std::vector<std::uint32_t>& of, std::uint32_t face) {
  const Face& f = drawn.faces[face];
  fmt::print("  {} {} u {} {} v {} {} area {}:", drawn.name, told(f.surface), f.u_range[0], f.u_range[1], f.v_range[0], f.v_range[1], f.area);
  std::map<std::string, int> count;
  std::map<std::uint32_t, int> n;
  for (std::size_t t = 0; t < of.size(); ++t) if (of[t] == face) ++n[part.mesh.face_of_triangle[t]];
  for (auto [i, k] : n) ++count[kSurfaceNames[part.faces[i].surface.index()]];
  for (auto& [i, k] : count) fmt::print(" {} {}", k, i);
  int left = 6;
  for (auto [i, k] : n) if (left-- > 0) fmt::print("; {}: {} triangles", told(part.faces[i].surface), k);
  std::vector<double> off;
  for (std::size_t t = 0; t < of.size(); ++t) if (of[t] == face) for (auto v : part.mesh.triangles[t]) { auto q = testing::project(f.surface, part.mesh.vertices[v]); if (q) off.push_back(std::abs(q->distance)); }
  std::ranges::sort(off);
  if (!off.empty()) fmt::print("\n     off {} {} {} {}", off[off.size() / 2], off[off.size() * 9 / 10], off[off.size() * 99 / 100], off.back());
  fmt::print("\n");
}

void add(Share& share, const Part& drawn) {
  auto [part, drawn_face_of] = bare(drawn);
  const std::clock_t begin = std::clock();
  recover_brep(part);
  share.seconds += double(std::clock() - begin) / CLOCKS_PER_SEC;
  share.triangles += static_cast<int>(part.mesh.triangles.size());
  std::vector<double> area(drawn.faces.size()), again(drawn.faces.size());
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = part.mesh.triangles[t];
    const std::vector<Vector3d>& p = part.mesh.vertices;
    const double size = 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    const std::uint32_t number = drawn_face_of[t];
    area[number] += size;
    if (is_again(part.faces.at(part.mesh.face_of_triangle[t]).surface, drawn.faces[number].surface))
      again[number] += size;
  }
  for (std::size_t f = 0; f < area.size(); ++f) {
    ++share.faces_drawn;
    share.area_drawn += area[f];
    share.area_again += again[f];
    if (again[f] >= 0.95 * area[f])
      ++share.faces_again;
    else if (std::getenv("V"))
      tell(part, drawn, drawn_face_of, static_cast<std::uint32_t>(f));
    if (again[f] < 0.95 * area[f])
      ++share.missing[kSurfaceNames[drawn.faces[f].surface.index()]];
  }
  share.faces_found += static_cast<int>(part.faces.size());
}

TEST(Recover, X) {
  for (const auto& [defl, ang] : {std::pair{0.0001, 0.2}, std::pair{0.0, 0.1}, std::pair{0.0, 0.4}}) {
    double total = 0;
    fmt::print("--- {} {}\n", defl, ang);
  for (const char* name :
       {"freecad_cc0/axis.stp", "freecad_cc0/bearing_20x37x9.stp", "freecad_cc0/crank_arm.stp", "freecad_cc0/crank_base.stp",
        "freecad_cc0/crank_disk.stp", "freecad_cc0/engine_bushing.stp", "freecad_cc0/engine_conrod.stp",
        "freecad_cc0/engine_conrod_cap.stp", "freecad_cc0/engine_cylinder.stp", "freecad_cc0/engine_piston.stp",
        "occt/mal_ecrou.stp", "occt/mal_tige.stp", "occt/mal_vis.stp", "occt/Axis_of_bearing.stp", "occt/screw.step"}) {
    if (std::getenv("ONLY") && !std::strstr(name, std::getenv("ONLY"))) continue;
    Share share;
    for (const Part& drawn : testing::load(testing::model_path(name), {.deflection = defl, .angular_deflection = ang})) {
      const int before = share.faces_again;
      add(share, drawn);
      if (share.faces_again - before < int(drawn.faces.size()) && std::getenv("V")) {
        auto [part, of] = bare(drawn);
        write_stl(std::string("/tmp/rec_") + std::filesystem::path(name).stem().string() + std::to_string(ang) + drawn.name + ".stl", part.mesh, 1000);
      }
    }
    std::string missing;
    for (const auto& [kind, count] : share.missing) missing += fmt::format(" {} {}", count, kind);
    fmt::print("{:36} {:6} triangles {:3} of {:3} faces, {:7.3f} % of area, found {:3}, {:7.3f} s; missing:{}\n", name,
               share.triangles, share.faces_again, share.faces_drawn, 100 * share.area_again / share.area_drawn,
               share.faces_found, share.seconds, missing);
    total += share.seconds;
  }
    fmt::print("total {}\n", total);
  }
}

}  // namespace
}  // namespace verisim

#include "engine/geometry/loader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/geometry/cad_client.hpp"
#include "engine/geometry/model_format.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/write_file.hpp"

namespace verisim {
namespace {

enum class Family { step, brep, mesh };

Family family_of(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == "step" || extension == "stp") return Family::step;
  if (extension == "brep" || extension == "brp") return Family::brep;
  for (const char* mesh : {"stl", "obj", "ply", "glb", "gltf"}) {
    if (extension == mesh) return Family::mesh;
  }
  fail(ErrorKind::input,
       "{}: models ending in '.{}' cannot be read; give .step, .stp, .brep, .stl, .obj, .ply, .glb or .gltf", path,
       extension);
}

const char* operation_of(Family family) {
  switch (family) {
    case Family::step:
      return "step";
    case Family::brep:
      return "brep";
    case Family::mesh:
      return "mesh";
  }
  return "";
}

void check_options(const std::string& path, const LoadOptions& options) {
  const auto check_not_negative = [&](const char* name, double value) {
    if (std::isfinite(value) && value >= 0) return;
    fail(ErrorKind::input, "{}: {} is {} but must be a finite number above 0; leave it out for the default", path, name,
         value);
  };
  check_not_negative("scale", options.scale);
  check_not_negative("deflection", options.deflection);
  check_not_negative("angular_deflection", options.angular_deflection);
  if (options.angular_deflection == 0) {
    fail(ErrorKind::input, "{}: angular_deflection is 0 rad but must be above it; leave it out for the default", path);
  }
}

/// Checks a CAD file's begin and end before the kernel reads it: the kernel would take minutes over a wrong file, or
/// load half of a truncated one.
void check_cad_content(const std::string& path, const std::string& content, Family family) {
  if (family == Family::brep) {
    if (content.find("CASCADE Topology V") != std::string::npos) return;
    fail(ErrorKind::input, "{}: this is no BREP file (its head 'CASCADE Topology' is missing); write it again", path);
  }
  const std::size_t head = content.find("ISO-10303-21;");
  if (head == std::string::npos) {
    fail(ErrorKind::input, "{}: this is no STEP file (its head 'ISO-10303-21;' is missing); export it again", path);
  }
  if (content.find("END-ISO-10303-21;", head) == std::string::npos) {
    fail(ErrorKind::input, "{}: the file is truncated ('END-ISO-10303-21;' is missing); copy or export it again", path);
  }
}

std::string place_text(const Vector3d& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x(), p.y(), p.z());
}

/// One sentence on what keeps a mesh from bounding a solid: what, where, what to do.
void note_faults(const MeshReport& report, std::vector<std::string>& notes) {
  const std::string near = " near " + place_text(report.where);
  if (report.open_edges > 0) {
    notes.push_back(fmt::format("the surface is open along {} edge{}{}; close it in the program that made it",
                                report.open_edges, report.open_edges == 1 ? "" : "s", near));
  }
  if (report.nonmanifold_edges > 0) {
    notes.push_back(fmt::format("{} edge{} have more than two triangles{}; remove inner walls and doubled faces",
                                report.nonmanifold_edges, report.nonmanifold_edges == 1 ? "" : "s", near));
  }
  if (report.misoriented_edges > 0) {
    notes.push_back(
        fmt::format("{} edge(s) have triangles on both sides that cannot be oriented alike; the surface has only one "
                    "side, model it again",
                    report.misoriented_edges));
  }
  if (report.self_intersections > 0) {
    notes.push_back(fmt::format("{} pair(s) of triangles cross each other{}; unite the crossing pieces",
                                report.self_intersections, near));
  }
}

std::vector<NamedArray> common_request(const char* operation, const std::string& path, const LoadOptions& options) {
  return {text_table("operation", operation), text_table("path", path),
          number_table("scale", options.scale == 0 ? 1 : options.scale), number_table("deflection", options.deflection),
          number_table("angular_deflection", options.angular_deflection)};
}

/// The parts of the CAD program's answer, their tessellation examined.
std::vector<Part> parts_from(const Message& answer) {
  std::vector<Part> parts;
  for (const Group& group : answer) {
    Part part = from_tables(group.name, group.tables);
    const MeshReport report = repair(part.mesh, part.notes);
    note_faults(report, part.notes);
    part.watertight = report.watertight() && !part.mesh.triangles.empty();
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Repairs the mesh, sets the part's mass properties and notes the remaining defects.
Part finished_mesh(Part part, const std::string& path) {
  repair(part.mesh, part.notes);
  if (part.mesh.triangles.empty()) {
    fail(ErrorKind::input, "{}: all triangles of '{}' have zero area; check its scale and export it again", path,
         part.name);
  }
  const MeshReport report = examine(part.mesh, /*thorough=*/true);
  note_faults(report, part.notes);
  part.watertight = report.watertight() && report.self_intersections == 0;
  part.mass = mass_properties_of(part.mesh);
  part.area = area_of(part.mesh);
  return part;
}

Part merged(std::vector<Part> objects, const std::string& name) {
  Part all = std::move(objects.front());
  all.name = name;
  for (auto object = objects.begin() + 1; object != objects.end(); ++object) {
    const auto first = static_cast<std::uint32_t>(all.mesh.vertices.size());
    all.mesh.vertices.insert(all.mesh.vertices.end(), object->mesh.vertices.begin(), object->mesh.vertices.end());
    for (const auto& [i, j, k] : object->mesh.triangles)
      all.mesh.triangles.push_back({first + i, first + j, first + k});
  }
  return all;
}

bool is_closed_by_itself(const Part& object) {
  TriangleMesh mesh = object.mesh;
  std::vector<std::string> ignored;
  return repair(mesh, ignored).watertight() && !mesh.triangles.empty();
}

/// Named objects are parts of their own if each of them bounds a solid. Many programs name the pieces of one surface
/// instead (its materials, its smoothing groups): together they are one part.
std::vector<Part> finished_meshes(const Message& answer, const std::string& path) {
  std::vector<Part> objects;
  for (const Group& group : answer) objects.push_back(from_tables(group.name, group.tables));
  const std::string stem = std::filesystem::path(path).stem().string();
  const bool apart = objects.size() > 1 && std::all_of(objects.begin(), objects.end(), [](const Part& object) {
                       return !object.name.empty() && is_closed_by_itself(object);
                     });
  std::vector<Part> parts;
  if (!apart) {
    parts.push_back(finished_mesh(merged(std::move(objects), stem), path));
    return parts;
  }
  for (Part& object : objects) parts.push_back(finished_mesh(std::move(object), path));
  return parts;
}

/// No machine's part is larger or smaller, and inertias (m^5) stay numbers that a double holds well.
void check_size(const Part& part, const std::string& path) {
  constexpr double kLongest = 1e9;    // m
  constexpr double kShortest = 1e-9;  // m
  if (part.mesh.triangles.empty()) return;
  const Bounds bounds = bounds_of(part.mesh);
  const double farthest = bounds.min.cwiseAbs().cwiseMax(bounds.max.cwiseAbs()).maxCoeff();
  const double longest = bounds.size().maxCoeff();
  if (!(farthest <= kLongest) || !(longest >= kShortest))
    fail(ErrorKind::input,
         "{}: part '{}' measures {:.4g} m and reaches to {:.4g} m from its origin; parts of {} to {} m "
         "are read: check its scale",
         path, part.name, longest, farthest, kShortest, kLongest);
  if (!std::isfinite(part.mass.volume) || !std::isfinite(part.area) || !part.mass.centroid.allFinite() ||
      !part.mass.inertia.allFinite())
    fail(ErrorKind::input, "{}: part '{}' has no finite volume; export it again", path, part.name);
}

/// "Bolt", "Bolt#2", "Bolt#3": the first keeps its name.
void make_names_unique(std::vector<Part>& parts, const std::string& nameless) {
  for (Part& part : parts) part.name = shown(part.name, kLongestName);  // other people's files may hold anything
  std::set<std::string> taken;
  for (const Part& part : parts) taken.insert(part.name);
  std::set<std::string> used;
  for (Part& part : parts) {
    if (part.name.empty()) part.name = nameless;
    const std::string base = part.name;
    for (std::size_t n = 2; used.contains(part.name); ++n) {
      part.name = fmt::format("{}#{}", base, n);
      if (taken.contains(part.name)) part.name = base;  // a part of the file already has that name
    }
    used.insert(part.name);
  }
}

}  // namespace

std::vector<Part> load_model(const std::string& path, const std::string& content, const LoadOptions& options) {
  const Family family = family_of(path);
  check_options(path, options);
  if (content.empty()) fail(ErrorKind::input, "{}: the file is empty; copy or export it again", path);
  if (family != Family::mesh) check_cad_content(path, content, family);
  std::vector<NamedArray> request = common_request(operation_of(family), path, options);
  request.push_back(text_table("content", content));
  const Message answer = ask_cad({{"request", std::move(request)}}, path);
  std::vector<Part> parts = family == Family::mesh ? finished_meshes(answer, path) : parts_from(answer);
  make_names_unique(parts, std::filesystem::path(path).stem().string());
  for (const Part& part : parts) check_size(part, path);
  for (Part& part : parts) {
    if (options.recover && !part.has_brep()) recover_brep(part);
  }
  return parts;
}

Part load_solid(const Solid& solid, const LoadOptions& options, CadSession* session) {
  check(solid);
  check_options("solid", options);
  std::vector<NamedArray> request = common_request("build", "solid", options);
  for (NamedArray& table : tables_of(solid)) request.push_back(std::move(table));
  const Message message = {{"request", std::move(request)}};
  const std::optional<Message> answer = session != nullptr ? session->ask(message) : std::nullopt;
  std::vector<Part> parts = parts_from(answer ? *answer : ask_cad(message, "solid"));
  VERISIM_ASSERT(parts.size() == 1);
  return std::move(parts.front());
}

void write_step(const std::string& path, const std::vector<std::pair<std::string, Solid>>& solids) {
  Message request = {{"request", {text_table("operation", "write_step")}}};
  for (const auto& [name, solid] : solids) {
    check(solid);
    request.push_back({name, tables_of(solid)});
  }
  const Message answer = ask_cad(request, path);
  VERISIM_ASSERT(answer.size() == 1);
  write_file(path, text_of(answer.front(), "content"));
}

}  // namespace verisim

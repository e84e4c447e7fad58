#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/inspect_scenario.hpp"
#include "engine/cli/options.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/simulation/inputs.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim::cli {
namespace {

struct InspectOptions {
  std::string model;
  std::optional<double> voxel;
  double scale = 0;
  double density = 1000;
  double deflection = 0;
  std::vector<std::string> sets, binds;  ///< of a scenario
  bool json = false;
};

/// The result of voxelizing a part, or the reason why that fails.
struct VoxelStatistics {
  std::uint32_t surface_voxels = 0;
  std::size_t memory_bytes = 0;
  std::size_t feature_sets = 0;
  std::vector<std::string> notes;
};

VoxelStatistics voxel_statistics(const Part& part, double voxel_size) {
  VoxelStatistics v;
  if (!part.watertight) {
    v.notes.emplace_back("not voxelized: not watertight");
    return v;
  }
  VoxelizeOptions options;
  options.voxel_size = voxel_size;
  VoxelBody body = voxelize(part.name, part.mesh, options);
  v.surface_voxels = body.voxmap.surface_count;
  if (part.has_brep()) {
    const AssociationReport report = associate(part.name, part, {}, body);
    v.feature_sets = body.features.sets.size() - 1;
    v.memory_bytes = body.features.sets.memory_bytes() + body.slot_sets.capacity() * sizeof(FeatureSetId);
    if (report.stand_ins > 0)
      v.notes.push_back(
          fmt::format("{} of its surface voxels are touched by its triangles only, not by the faces; a "
                      "smaller deflection makes them fewer",
                      report.stand_ins));
    if (report.loose_faces > 0)
      v.notes.push_back(fmt::format(
          "{} of its faces have bounds that do not close; voxels know them by their triangles", report.loose_faces));
  }
  v.memory_bytes += body.voxmap.memory_bytes() + body.shell.memory_bytes();
  return v;
}

template <typename Kinds>
Json counts(const Kinds& names, const std::vector<std::size_t>& indices) {
  Json j;
  for (const char* name : names) j[name] = 0;
  for (const std::size_t i : indices) j[names[i]] = j[names[i]].template get<int>() + 1;
  return j;
}

Json json_of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json json_of(const Part& part, double density) {
  const Bounds bounds = bounds_of(part.mesh);
  std::vector<std::size_t> faces;
  std::vector<std::size_t> edges;
  for (const Face& face : part.faces) faces.push_back(face.surface.index());
  for (const Edge& edge : part.edges) edges.push_back(edge.curve.index());
  Json j;
  j["name"] = part.name;
  j["color"] = part.color;
  j["volume_m3"] = part.mass.volume;
  j["area_m2"] = part.area;
  j["mass_kg"] = density * part.mass.volume;
  j["center_of_mass_m"] = json_of(part.mass.centroid);
  j["bounds_m"] = {json_of(bounds.min), json_of(bounds.max)};
  j["watertight"] = part.watertight;
  j["faces"] = counts(kSurfaceNames, faces);
  j["edges"] = counts(kCurveNames, edges);
  j["cylinders"] = Json::array();
  for (const Face& face : part.faces)
    if (const auto* c = std::get_if<Cylinder>(&face.surface))
      j["cylinders"].push_back({{"axis_point", json_of(c->point)},
                                {"axis_direction", json_of(c->direction)},
                                {"radius_m", c->radius},
                                {"hole", c->hole}});
  j["triangles"] = part.mesh.triangles.size();
  j["notes"] = part.notes;
  return j;
}

Json json_of(const Mate& mate) {
  return {{"part_a", mate.part_a},
          {"part_b", mate.part_b},
          {"radius_hole_m", mate.radius_hole},
          {"radius_pin_m", mate.radius_pin},
          {"clearance_m", mate.clearance()}};
}

std::string listed(const Json& counted) {
  std::string text;
  for (const auto& [name, count] : counted.items())
    if (count.get<int>() > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count.get<int>(), name);
  return text.empty() ? "none known" : text;
}

void print_inspection(const Json& report) {
  for (const auto& p : report["parts"]) {
    const auto row = [](const char* name, const std::string& value) {
      std::printf("  %-16s%s\n", name, value.c_str());
    };
    std::printf("%s\n", p["name"].get<std::string>().c_str());
    const auto mm = [&](int i) {
      return (p["bounds_m"][1][static_cast<std::size_t>(i)].get<double>() -
              p["bounds_m"][0][static_cast<std::size_t>(i)].get<double>()) *
             1e3;
    };
    row("size", fmt::format("{:.4g} x {:.4g} x {:.4g} mm", mm(0), mm(1), mm(2)));
    row("volume", fmt::format("{:.6g} cm^3", p["volume_m3"].get<double>() * 1e6));
    row("area", fmt::format("{:.6g} cm^2", p["area_m2"].get<double>() * 1e4));
    row("mass", fmt::format("{:.4g} kg", p["mass_kg"].get<double>()));
    row("watertight", p["watertight"].get<bool>() ? "yes" : "NO");
    row("faces", listed(p["faces"]));
    row("edges", listed(p["edges"]));
    row("triangles", fmt::format("{}", p["triangles"].get<std::size_t>()));
    if (p.contains("surface_voxels"))
      row("voxels", fmt::format("{} on the surface, {} sets of faces and edges, {:.2f} MB",
                                p["surface_voxels"].get<std::size_t>(), p["feature_sets"].get<std::size_t>(),
                                p["memory_bytes"].get<double>() / 1e6));
    for (const auto& note : p["notes"]) row("note", note.get<std::string>());
  }
  if (report["mates"].empty()) return;
  std::printf("\nPairs of cylinders that could mate\n  %-24s%-24s%12s%12s%14s\n", "hole in", "pin of", "hole mm",
              "pin mm", "clearance mm");
  for (const auto& m : report["mates"])
    std::printf("  %-24s%-24s%12.4f%12.4f%14.4f\n", m["part_a"].get<std::string>().c_str(),
                m["part_b"].get<std::string>().c_str(), m["radius_hole_m"].get<double>() * 1e3,
                m["radius_pin_m"].get<double>() * 1e3, m["clearance_m"].get<double>() * 1e3);
}

void inspect_model(const InspectOptions& o) {
  if (!std::isfinite(o.density) || o.density <= 0)
    fail(ErrorKind::usage, "--density must be finite and above 0 kg/m^3");
  Inputs inputs = Inputs::live(".", {o.model});
  LoadOptions load;
  load.scale = o.scale;
  load.deflection = o.deflection;
  load.recover = true;
  const std::vector<Part>& parts = inputs.model(o.model, load);
  Json report;
  report["model"] = o.model;
  report["parts"] = Json::array();
  for (const Part& part : parts) {
    Json j = json_of(part, o.density);
    for (const std::string& warning : warnings_about(part)) {
      std::fprintf(stderr, "warning: %s: '%s': %s\n", o.model.c_str(), part.name.c_str(), shown(warning).c_str());
      j["notes"].push_back(warning);
    }
    if (o.voxel) {
      const VoxelStatistics v = voxel_statistics(part, *o.voxel);
      j["surface_voxels"] = v.surface_voxels;
      j["feature_sets"] = v.feature_sets;
      j["memory_bytes"] = v.memory_bytes;
      for (const std::string& note : v.notes) j["notes"].push_back(note);
    }
    report["parts"].push_back(std::move(j));
  }
  report["mates"] = Json::array();
  for (const Mate& mate : mating_candidates(parts)) report["mates"].push_back(json_of(mate));
  if (o.json)
    std::printf("%s\n", json_text(report).c_str());
  else
    print_inspection(report);
}

}  // namespace

void add_inspect(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "inspect", "Parts, entities, mating features, voxels of a model; of a scenario what it will need, and why");
  auto o = std::make_shared<InspectOptions>();
  command->add_option("MODEL | SCENARIO.lua", o->model, "STEP, BREP, STL, OBJ, PLY or glTF file, or a scenario")
      ->required();
  command->add_option("--voxel", o->voxel, "Voxel size [m]: adds surface voxels, sets of faces and edges, memory");
  command->add_option("--scale", o->scale, "Metres per unit of a mesh file (0.001: it is in millimetres)");
  command->add_option("--density", o->density, "kg/m^3 for the mass (default 1000)");
  command->add_option("--deflection", o->deflection, "Chord error of the tessellation [m]");
  command->add_option("--set", o->sets, "KEY=VALUE: scenario parameter, as of 'verisim run'")->take_all();
  command->add_option("--bind", o->binds, "NAME=SOURCE: drive the device NAME, as of 'verisim run'")->take_all();
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->footer(
      "Example: verisim inspect scenarios/models/bearing.step --voxel 0.0005\n"
      "         verisim inspect scenarios/peg_in_hole.lua --set clearance=2mm");
  command->callback([=, &exit_code] {
    const std::string suffix = std::filesystem::path(o->model).extension().string();
    const bool is_scenario = suffix == ".lua" || suffix == ".LUA";
    for (const char* option : {"--voxel", "--scale", "--density", "--deflection"})
      if (is_scenario && command->count(option) > 0)
        fail(ErrorKind::usage, "{}: a scenario says it itself; give {} with a model", option, option);
    for (const char* option : {"--set", "--bind"})
      if (!is_scenario && command->count(option) > 0)
        fail(ErrorKind::usage, "{}: a model has no parameters; give {} with a scenario", option, option);
    if (is_scenario) {
      ScenarioOptions options;
      options.path = o->model;
      options.sets = split_pairs("--set", o->sets);
      options.binds = split_pairs("--bind", o->binds);
      inspect_scenario(options, o->json);
    } else {
      inspect_model(*o);
    }
    exit_code = 0;
  });
}

}  // namespace verisim::cli

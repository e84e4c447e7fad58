#include "engine/cli/inspect_scenario.hpp"

#include <cstdio>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text_table.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/session.hpp"
#include "engine/simulation/plan.hpp"

namespace verisim::cli {
namespace {

const char* word_of(BodyPlan::Prepared prepared) {
  switch (prepared) {
    case BodyPlan::Prepared::start:
      return "at the start";
    case BodyPlan::Prepared::near:
      return "when near";
    case BodyPlan::Prepared::never:
      return "never";
  }
  return "";
}

/// What is made of it beside its triangles.
std::string made_of(const BodyPlan& body) {
  if (body.prepared == BodyPlan::Prepared::never) return "nothing";
  return std::string("voxels") + (body.entities ? ", faces of voxels" : "") + (body.exact ? ", exact surfaces" : "");
}

Json json_of(const BodyPlan& body) {
  return {{"name", body.name},
          {"moves", body.can_move},
          {"mass_kg", body.mass},
          {"method", body.method},
          {"triangles", body.triangles},
          {"faces", body.faces},
          {"voxel_size_m", body.voxel_size},
          {"prepared", word_of(body.prepared)},
          {"why", body.why},
          {"entities", body.entities},
          {"exact", body.exact},
          {"memory_bytes", body.voxel_bytes}};
}

Json report_of(const ScenarioOptions& options, const Scenario& scenario, const Scene& scene, const ScenePlan& plan) {
  Json report;
  report["scenario"] = std::filesystem::path(options.path).filename().string();
  report["parameters"] = parse_json(scenario.parameters_json());
  report["method"] = plan.method;
  report["integrator"] = plan.integrator == Integrator::implicit ? "implicit" : "semi-implicit";
  report["timestep_s"] = scene.parameters.timestep;
  double memory = 0;
  report["bodies"] = Json::array();
  for (const BodyPlan& body : plan.bodies) {
    report["bodies"].push_back(json_of(body));
    memory += body.voxel_bytes;
  }
  report["memory_bytes"] = memory;
  report["pairs"] = Json::array();
  for (const auto& [i, j] : plan.pairs) report["pairs"].push_back({plan.bodies[i].name, plan.bodies[j].name});
  report["devices"] = Json::array();
  for (const auto& device : scene.devices)
    report["devices"].push_back(
        {{"name", device->name()}, {"chain", device->described()}, {"driven", device->driven()}});
  report["companions"] = Json::array();
  for (const auto& companion : scene.companions) report["companions"].push_back(companion->name());
  report["notices"] = scenario.notices();
  return report;
}

void print_report(const ScenePlan& plan, const Json& report) {
  std::printf("%s: bodies %zu, pairs that can meet %zu, method %s, %s steps of %g s\n",
              report["scenario"].get<std::string>().c_str(), plan.bodies.size(), plan.pairs.size(),
              std::string(plan.method).c_str(), report["integrator"].get<std::string>().c_str(),
              report["timestep_s"].get<double>());
  TextTable table({"body", "moves", "triangles", "MB", "prepared", "of it", "why"}, "<<>><<<");
  for (const BodyPlan& body : plan.bodies)
    table.add({body.name, body.can_move ? "yes" : "no", fmt::format("{}", body.triangles),
               fmt::format("{:.2f}", body.voxel_bytes / 1e6), word_of(body.prepared), made_of(body), body.why});
  std::fputs(table.text().c_str(), stdout);
  const auto row = [&](const std::string& line) { std::printf("  %s\n", line.c_str()); };
  for (const auto& device : report["devices"])
    row("device " + device["chain"].get<std::string>() + (device["driven"].get<bool>() ? "" : ": driven by nothing"));
  for (const auto& name : report["companions"]) row("beside the loop: " + name.get<std::string>());
  for (const auto& notice : report["notices"]) row("note: " + notice.get<std::string>());
}

}  // namespace

void inspect_scenario(const ScenarioOptions& options, bool json) {
  Inputs inputs =
      Inputs::live(std::filesystem::path(options.path).parent_path().string(), named_paths(options), prepared_parts());
  Scenario scenario(options, inputs);
  const Scene scene = scenario.take_scene();
  const ScenePlan plan = plan_of(scene);
  const Json report = report_of(options, scenario, scene, plan);
  if (json)
    std::printf("%s\n", json_text(report).c_str());
  else
    print_report(plan, report);
}

}  // namespace verisim::cli

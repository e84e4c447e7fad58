// defineSimulationParameters and addObject: what makes a scene.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/contract.hpp"
#include "engine/base/hash.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

constexpr double kUsualVoxelSize = 0.003;  // m, SPARTA's published scripts

template <typename Value>
using Named = std::pair<const char*, Value>;

/// The value that goes by `name`; any other name is an error that lists them.
template <typename Values>
auto named(lua_State* L, const char* what, const std::string& name, const Values& values) {
  std::vector<std::string> names;
  for (const auto& [known, value] : values) {
    if (name == known) return value;
    names.emplace_back(known);
  }
  raise(L, "{} is '{}'{}", what, name, suggestion(name, names));
}

std::vector<Named<Hybrid>> hybrids() {
  std::vector<Named<Hybrid>> named;
  for (const Hybrid method : hybrid::all()) named.emplace_back(method->name().data(), method);
  return named;
}
constexpr Named<Integrator> kIntegrators[] = {{"semi-implicit", Integrator::semi_implicit},
                                              {"implicit", Integrator::implicit}};
constexpr Named<ContactMethod> kContactMethods[] = {{"voxmap", ContactMethod::voxmap}, {"fcl", ContactMethod::fcl}};
constexpr Named<AlignmentMeasure> kAlignments[] = {
    {"by-type", AlignmentMeasure::by_type}, {"faas", AlignmentMeasure::faas}, {"pavlik", AlignmentMeasure::pavlik}};
constexpr Named<Reduction> kReductions[] = {{"common-freedom", Reduction::common_freedom},
                                            {"exactly-one", Reduction::exactly_one}};

/// Returns whether the field is there.
template <typename Values, typename Value>
bool read_named(lua_State* L, Fields& fields, const char* field, const Values& values, Value& value) {
  const auto name = fields.text(field);
  if (name) value = named(L, field, *name, values);
  return name.has_value();
}

// Words of SPARTA that have no effect here, reported once.
void accept_without_effect(lua_State* L, Fields& fields, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (fields.accepted(name))
      ScriptState::of(L).notice(fmt::format("{}: {} is accepted and changes nothing", where(L), name));
}

// precision = "auto": a setting of the dials that keeps the bounds. What the script has read of params{} by now is of
// other values, so it is run again from its beginning, with what was chosen (Scenario::Scenario).
void read_precision(lua_State* L, Fields& fields) {
  ScriptState& state = ScriptState::of(L);
  PrecisionRequest request;
  request.table = fields.text("precisionTable").value_or(request.table);
  request.budget = fields.text("budget");
  request.error = fields.text("error");
  request.by = fields.text("errorBy");
  const auto outside = fields.text("precisionOutside");
  if (outside) {
    if (*outside != "careful" && *outside != "refuse")
      raise(L, "precisionOutside is '{}' but must be \"refuse\" or \"careful\"", shown(*outside, 40));
    request.careful = *outside == "careful";
  }
  bool is_auto = false;
  if (fields.push("precision")) {
    is_auto = lua_type(L, -1) == LUA_TSTRING && text_at(L, -1, "precision") == "auto";
    lua_pop(L, 1);
    if (!is_auto) accept_without_effect(L, fields, {"precision"});
  }
  if (!is_auto && (request.budget || request.error || request.by || outside))
    raise(L, "budget, error, errorBy and precisionOutside are of precision = \"auto\"; say that too");
  if (!is_auto || state.options.ignores_precision) return;
  request.scenario = state.name();
  request.scenario_sha256 = sha256(state.inputs.read(state.name()));
  request.parameters_json = state.parameters_json;
  request.sets = state.options.sets;
  request.duration_of_script = state.scene.parameters.duration;
  request.duration = state.options.duration ? state.options.duration : request.duration_of_script;
  if (!state.inputs.exists(request.table))
    raise(L,
          "precision is 'auto' and there is no {}; make it: verisim tradeoff {} --vary KEY=V1,V2 --repeat 19 -o {}, "
          "its own folder",
          request.table, request.scenario, "FOLDER");
  try {
    state.precision = choose_precision(request, state.read_file(L, request.table));
  } catch (const Error& error) {
    raise(L, "{}", error.what());
  }
  raise(L, "precision: the script is run again with what was chosen");
}

int define_simulation_parameters(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  if (state.simulation != nullptr)
    raise(L, "defineSimulationParameters: the simulation runs already; call it while the scene is built");
  SimulationParameters& p = state.scene.parameters;
  Fields fields(L, 1, "defineSimulationParameters");
  p.timestep = fields.positive("timestep").value_or(p.timestep);
  p.gravity = fields.vector("gravity").value_or(p.gravity);
  if (const auto seed = fields.number("seed")) {
    if (*seed < 0 || *seed > 0x1p53 || *seed != std::floor(*seed))
      raise(L, "seed is {:g} but must be a whole number from 0 to 2^53", *seed);
    state.asked_seed = seed;
    if (!state.options.seed) p.seed = static_cast<std::uint64_t>(*seed);
  }
  if (const auto duration = fields.positive("duration")) state.asked_duration = p.duration = duration;
  p.frame_rate = fields.positive("frameRate").value_or(p.frame_rate);
  if (read_named(L, fields, "integrator", kIntegrators, p.integrator)) p.integrator_by_default = false;
  if (read_named(L, fields, "hybrid", hybrids(), p.hybrid)) p.hybrid_by_default = false;
  read_named(L, fields, "contact", kContactMethods, p.contact);
  read_named(L, fields, "alignment", kAlignments, p.alignment);
  read_named(L, fields, "reduction", kReductions, p.reduction);
  p.max_stiffness = fields.positive("maxStiffness").value_or(p.max_stiffness);
  p.max_angular_stiffness = fields.positive("maxAngularStiffness").value_or(p.max_angular_stiffness);
  p.max_coupling_force = fields.positive("maxCouplingForce").value_or(p.max_coupling_force);
  p.max_coupling_torque = fields.positive("maxCouplingTorque").value_or(p.max_coupling_torque);
  p.all_bodies_are_dynamic = fields.boolean("allBodiesAreDynamic").value_or(p.all_bodies_are_dynamic);
  p.contact_stiffness = fields.positive("contactStiffness").value_or(p.contact_stiffness);
  if (const auto ratio = fields.number("contactDampingRatio")) {
    if (*ratio < 0) raise(L, "contactDampingRatio is {:g} but must not be negative", *ratio);
    p.contact_damping_ratio = *ratio;
  }
  p.exact_stiffness = fields.positive("exactStiffness").value_or(p.exact_stiffness);
  if (const auto restitution = fields.number("restitution")) {
    if (!is_fraction(*restitution)) raise(L, "restitution is {:g} but must be from 0 to 1", *restitution);
    p.restitution = *restitution;
  }
  if (const auto friction = fields.number("exactFriction")) {
    if (!is_fraction(*friction)) raise(L, "exactFriction is {:g} but must be from 0 to 1", *friction);
    p.exact_friction = *friction;
  }
  p.restitution_speed = fields.positive("restitutionSpeed").value_or(p.restitution_speed);
  p.passive_contacts = fields.boolean("passiveContacts").value_or(p.passive_contacts);
  state.scene.grasp_distance = fields.positive("graspDistance").value_or(state.scene.grasp_distance);
  accept_without_effect(L, fields, {"limitCouplerDampingForce", "parts"});
  read_precision(L, fields);
  fields.finish(false);
  return 0;
}

bool name_taken(const Scene& scene, const std::string& name) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const BodyDescription& b) { return b.name == name; });
}

std::string free_name(const Scene& scene, const std::string& stem) {
  std::string name = stem;
  // Numbers start at the number of bodies, so that each of many bodies of one stem needs one look-up.
  for (std::size_t i = scene.bodies.size() + 1; name_taken(scene, name); ++i) name = fmt::format("{}{}", stem, i);
  return name;
}

double extent_of(const BodyDescription& body) {
  Bounds bounds;
  for (const Part& part : body.parts) {
    const Bounds of_part = bounds_of(part.mesh);
    bounds.include(of_part.min);
    bounds.include(of_part.max);
  }
  return bounds.size().maxCoeff();
}

void read_geometry(lua_State* L, Fields& fields, BodyDescription& body, std::string& stem) {
  ScriptState& state = ScriptState::of(L);
  std::vector<std::shared_ptr<Node>> nodes;
  for (int i = 1; i <= fields.children(); ++i) {
    fields.push_child(i);
    nodes.push_back(get<std::shared_ptr<Node>>(L, lua_gettop(L), fmt::format("addObject: child {}", i)));
    lua_pop(L, 1);
  }
  PlacedParts placed_parts = resolve(nodes, state.inputs);
  // Charged as work, because parts lie outside Lua's memory: a loop must not fill the machine with bodies.
  std::size_t triangles = 0;
  for (const Part& part : placed_parts.parts) triangles += part.mesh.triangles.size();
  Sandbox::charge(L, 20'000 + triangles + 10 * state.scene.bodies.size());
  body.parts = std::move(placed_parts.parts);
  body.X_WB = body.X_WB * placed_parts.pose;
  stem = placed_parts.stem;
  for (const Part& part : body.parts) {
    for (const std::string& note : part.notes) state.notice(fmt::format("{}: {}: {}", where(L), part.name, note));
  }
}

void read_hybrid(lua_State* L, Fields& fields, BodyDescription& body) {
  if (!fields.push("hybrid")) return;
  if (lua_type(L, -1) == LUA_TBOOLEAN)
    body.hybrid = lua_toboolean(L, -1) != 0 ? hybrid::restore : hybrid::off;
  else
    body.hybrid = named(L, "addObject: hybrid", text_at(L, -1, "addObject: hybrid"), hybrids());
  lua_pop(L, 1);
}

int add_object(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  if (state.simulation != nullptr)
    raise(L, "addObject: the simulation runs already; add objects while the scene is built");
  Fields fields(L, 1, "addObject");
  BodyDescription body;
  auto name = fields.name();
  if (name && name_taken(state.scene, *name))
    raise(L, "addObject: there is a body '{}' already; give each its own name", *name);
  body.X_WB.position = fields.vector("position").value_or(Vector3d::Zero());
  body.X_WB.rotation = fields.rotation("orientation").value_or(Quaterniond::Identity());
  body.density = fields.positive("density").value_or(body.density);
  const double voxel_size = fields.number("voxelsize", kUsualVoxelSize);
  body.point_spacing = fields.positive("pointspacing").value_or(0);
  body.use_brep = fields.boolean("brep").value_or(true);
  body.fixed = fields.boolean("fixed").value_or(false);
  body.selectable = fields.boolean("selectable").value_or(!body.fixed);
  read_hybrid(L, fields, body);
  body.twist.linear = fields.vector("velocity").value_or(Vector3d::Zero());
  body.twist.angular = fields.vector("angularVelocity").value_or(Vector3d::Zero());
  fields.finish(true);

  std::string stem;
  read_geometry(L, fields, body, stem);
  body.name = name ? *name : free_name(state.scene, recordable(L, "addObject: name", stem.empty() ? "body" : stem));
  if (!(voxel_size > 0))
    raise(L, "voxelsize is {:g} m but must be above 0; '{}' measures {:g} m, mm({:g}) is usual", voxel_size, body.name,
          extent_of(body), kUsualVoxelSize * 1000);
  body.voxel_size = voxel_size;

  double volume = 0;
  for (const Part& part : body.parts) volume += part.mass.volume;
  state.masses.push_back(volume * body.density);
  state.scene.bodies.push_back(std::move(body));
  push(L, BodyHandle{state.scene.bodies.size() - 1});
  return 1;
}

}  // namespace

void add_scene_words(lua_State* L) {
  set_global<define_simulation_parameters, Charge::call>(L, "defineSimulationParameters");
  set_global<add_object, Charge::call>(L, "addObject");
}

}  // namespace verisim::script

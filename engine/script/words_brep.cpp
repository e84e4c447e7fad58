// Faces and edges that a script declares by hand: the shapes (Plane(), Cylinder() …), FeatureSet and BoundaryFeature,
// and the methods of a body that go through its surface voxels and give them sets.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

/// A shape whose fields a script sets. kKinds lists the fields of each kind.
struct DeclaredShape {
  std::size_t kind;
  Vector3d place = Vector3d::Zero(), direction = Vector3d::UnitZ();
  std::array<double, 2> sizes = {0, 0};
};

struct DeclaredSet {
  std::vector<DeclaredFeatures::Entity> entities;
};

template <>
inline constexpr const char* kTypeName<DeclaredShape> = "shape";
template <>
inline constexpr const char* kTypeName<DeclaredSet> = "FeatureSet";

namespace {

using Entity = DeclaredFeatures::Entity;

constexpr std::size_t kSetEntitiesMax = 64;

// --- shapes ---------------------------------------------------------------------------------------------------------

Face face_on(Surface surface) {
  Face face;
  face.surface = std::move(surface);
  return face;
}

/// A line is assumed to be long and a circle to be closed, because their ends are not declared.
Edge edge_on(Curve curve, std::array<double, 2> t_range) {
  Edge edge;
  edge.curve = std::move(curve);
  edge.t_range = t_range;
  return edge;
}
constexpr double kLineHalf = 0.5;  // m

Entity plane(const DeclaredShape& s, const Vector3d& n) {
  return face_on(Plane{s.place, n, n.unitOrthogonal()});
}
// Whether a curved face is a hole is found from its voxels.
Entity cylinder(const DeclaredShape& s, const Vector3d& n) {
  return face_on(Cylinder{s.place, n, n.unitOrthogonal(), s.sizes[0], false});
}
Entity cone(const DeclaredShape& s, const Vector3d& n) {
  return face_on(Cone{s.place, n, n.unitOrthogonal(), s.sizes[0], s.sizes[1], false});
}
Entity sphere(const DeclaredShape& s, const Vector3d& n) {
  return face_on(Sphere{s.place, n, n.unitOrthogonal(), s.sizes[0], false});
}
Entity torus(const DeclaredShape& s, const Vector3d& n) {
  return face_on(Torus{s.place, n, n.unitOrthogonal(), s.sizes[0], s.sizes[1], false});
}
Entity line(const DeclaredShape& s, const Vector3d& n) {
  return edge_on(Line{s.place, n}, {-kLineHalf, kLineHalf});
}
Entity circle(const DeclaredShape& s, const Vector3d& n) {
  return edge_on(Circle{s.place, n, n.unitOrthogonal(), s.sizes[0]}, {0, 2 * pinned::kPi});
}

/// The names of a shape's fields; null: it has no such field.
struct Kind {
  const char* name;
  const char* place;
  const char* direction;
  std::array<const char*, 2> sizes;
  Entity (*entity)(const DeclaredShape&, const Vector3d& direction);
};
constexpr Kind kKinds[] = {
    {"Plane", "point", "normal", {nullptr, nullptr}, plane},
    {"Cylinder", "center", "normal", {"radius", nullptr}, cylinder},
    {"Cone", "center", "normal", {"radius", "halfAngle"}, cone},
    {"Sphere", "center", nullptr, {"radius", nullptr}, sphere},
    {"Torus", "center", "normal", {"majorRadius", "minorRadius"}, torus},
    {"Line", "point", "direction", {nullptr, nullptr}, line},
    {"Circle", "center", "normal", {"radius", nullptr}, circle},
};

bool is_field(const char* field, const std::string& name) {
  return field != nullptr && name == field;
}

[[noreturn]] void raise_unknown(lua_State* L, const Kind& kind, const std::string& name) {
  std::vector<std::string> known = {kind.place};
  for (const char* field : {kind.direction, kind.sizes[0], kind.sizes[1]}) {
    if (field != nullptr) known.emplace_back(field);
  }
  raise(L, "a {} has no '{}'{}", kind.name, name, suggestion(name, known));
}

// Sphere{…} is VR JuggLua's word for a ball that is drawn.
int make_shape(lua_State* L) {
  const auto kind = static_cast<std::size_t>(lua_tointeger(L, lua_upvalueindex(1)));
  if (lua_isnoneornil(L, 1)) {
    push(L, DeclaredShape{.kind = kind});
    return 1;
  }
  const std::string name = kKinds[kind].name;
  if (name != "Sphere" || lua_type(L, 1) != LUA_TTABLE)
    raise(L, "{} is called with {}; call it with nothing and set its fields then", name, described(L, 1));
  Sandbox::charge(L, kEventWork);
  ScriptState::of(L).notice(fmt::format("{}: Sphere{{…}} only draws and is ignored", where(L)));
  lua_getfield(L, LUA_REGISTRYINDEX, "verisim.drawing");
  return 1;
}

int shape_member(lua_State* L) {
  const auto& shape = get<DeclaredShape>(L, 1, "what a shape's field is asked of");
  const Kind& kind = kKinds[shape.kind];
  const std::string name = text_at(L, 2, "a shape's field");
  if (is_field(kind.place, name))
    push(L, Vector3d(shape.place));
  else if (is_field(kind.direction, name))
    push(L, Vector3d(shape.direction));
  else if (is_field(kind.sizes[0], name))
    lua_pushnumber(L, shape.sizes[0]);
  else if (is_field(kind.sizes[1], name))
    lua_pushnumber(L, shape.sizes[1]);
  else
    raise_unknown(L, kind, name);
  return 1;
}

int set_shape_member(lua_State* L) {
  auto& shape = get<DeclaredShape>(L, 1, "what a shape's field is set of");
  const Kind& kind = kKinds[shape.kind];
  const std::string name = text_at(L, 2, "a shape's field");
  const std::string what = fmt::format("{}: {}", kind.name, name);
  if (is_field(kind.place, name))
    shape.place = vector_at(L, 3, what);
  else if (is_field(kind.direction, name))
    shape.direction = vector_at(L, 3, what);
  else if (is_field(kind.sizes[0], name))
    shape.sizes[0] = number_at(L, 3, what);
  else if (is_field(kind.sizes[1], name))
    shape.sizes[1] = number_at(L, 3, what);
  else
    raise_unknown(L, kind, name);
  return 0;
}

Entity entity_of_shape(lua_State* L, const DeclaredShape& shape) {
  const Kind& kind = kKinds[shape.kind];
  const double length = shape.direction.norm();
  if (!(length > 0)) raise(L, "a {}'s {} is {{0, 0, 0}} but must have a direction", kind.name, kind.direction);
  return kind.entity(shape, shape.direction / length);
}

// --- sets -----------------------------------------------------------------------------------------------------------

int feature_set(lua_State* L) {
  push(L, DeclaredSet{});
  return 1;
}

// Copies a shape: fields that are set later do not change the set.
int boundary_feature(lua_State* L) {
  push(L, DeclaredShape(get<DeclaredShape>(L, 1, "BoundaryFeature: its argument")));
  return 1;
}

int insert(lua_State* L) {
  auto& set = get<DeclaredSet>(L, 1, "what :insert adds to");
  const auto& shape = get<DeclaredShape>(L, 2, "insert: the feature");
  if (set.entities.size() == kSetEntitiesMax)
    raise(L, "insert: a FeatureSet has room for {} features; one voxel holds few", kSetEntitiesMax);
  Sandbox::charge(L, kEventWork);
  Sandbox::of(L).keep(sizeof(set.entities.front()));
  set.entities.push_back(entity_of_shape(L, shape));
  return 0;
}

int push_size(lua_State* L, std::size_t size) {
  lua_newtable(L);
  lua_pushnumber(L, static_cast<double>(size));
  lua_setfield(L, -2, "size");
  return 1;
}

int set_member(lua_State* L) {
  const auto& set = get<DeclaredSet>(L, 1, "what a FeatureSet's word is called on");
  const std::string name = text_at(L, 2, "a FeatureSet's member");
  if (name == "size")
    lua_pushnumber(L, static_cast<double>(set.entities.size()));
  else if (name == "insert")
    lua_pushvalue(L, lua_upvalueindex(1));
  else
    raise(L, "a FeatureSet has no '{}'{}", name, suggestion(name, {"insert", "size"}));
  return 1;
}

// --- a body's voxels ------------------------------------------------------------------------------------------------

std::size_t body_at(lua_State* L) {
  return get<BodyHandle>(L, 1, "what a body's word is called on").index;
}

/// The body as voxels, made at the first request.
const Declaring& voxels_of(lua_State* L, std::size_t body, const char* word) {
  ScriptState& state = ScriptState::of(L);
  if (state.simulation != nullptr)
    raise(L, "{}: the simulation runs already; declare features while the scene is built", word);
  const auto known = state.declaring.find(body);
  if (known != state.declaring.end()) return known->second;
  Declaring voxels(state.described_body(body));
  // Charged as work, because voxels lie outside Lua's memory: a loop must not fill the machine with them.
  Sandbox::charge(L, voxels.memory_bytes() / 4);
  return state.declaring.emplace(body, std::move(voxels)).first->second;
}

// body:foreachSurfaceVoxel(f): f(x, y, z) for the centre of each, body coordinates; results of f are ignored.
int foreach_surface_voxel(lua_State* L) {
  const Declaring& voxels = voxels_of(L, body_at(L), "foreachSurfaceVoxel");
  if (lua_type(L, 2) != LUA_TFUNCTION)
    raise(L, "foreachSurfaceVoxel is called with {}; call it with a function of x, y, z", described(L, 2));
  for (std::uint32_t i = 0; i < voxels.surface_voxels(); ++i) {
    lua_pushvalue(L, 2);
    for (const double coordinate : voxels.center(i)) lua_pushnumber(L, coordinate);
    lua_call(L, 3, 0);
  }
  return 0;
}

// body:addFeatureSet(set, x, y, z) or body:addFeatureSet(set, vector) -> the number of the set
int add_feature_set(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::size_t body = body_at(L);
  const Declaring& voxels = voxels_of(L, body, "addFeatureSet");
  const auto& set = get<DeclaredSet>(L, 2, "addFeatureSet: the set");
  Vector3d p;
  if (lua_gettop(L) >= 5)
    p = {number_at(L, 3, "addFeatureSet: x"), number_at(L, 4, "addFeatureSet: y"), number_at(L, 5, "addFeatureSet: z")};
  else
    p = vector_at(L, 3, "addFeatureSet: the place");
  BodyDescription& description = state.described_body(body);
  Sandbox::charge(L, 20);
  lua_pushnumber(L, voxels.give(description, p, set.entities));
  return 1;
}

// body:getFeatureSet(id) -> { size = number of features }; the set that was added first is number 1.
int get_feature_set(lua_State* L) {
  const BodyDescription& description = ScriptState::of(L).described_body(body_at(L));
  const double id = number_at(L, 2, "getFeatureSet: the number");
  const std::size_t count = description.declared ? description.declared->size() : 0;
  if (id != std::floor(id) || id < 0 || id > static_cast<double>(count))
    raise(L, "getFeatureSet: '{}' has no set {:g}; {} were added", description.name, id, count);
  return push_size(L, id == 0 ? 0 : description.declared->entities_in(static_cast<FeatureSetId>(id)));
}

}  // namespace

void add_declaring_methods(lua_State* L) {
  set_function<foreach_surface_voxel, Charge::call>(L, "foreachSurfaceVoxel");
  set_function<add_feature_set, Charge::call>(L, "addFeatureSet");
  set_function<get_feature_set, Charge::call>(L, "getFeatureSet");
}

void add_brep_words(lua_State* L) {
  push_metatable<DeclaredShape>(L);
  set_function<shape_member, Charge::call>(L, "__index");
  set_function<set_shape_member, Charge::call>(L, "__newindex");
  lua_pop(L, 1);
  push_metatable<DeclaredSet>(L);
  push_function<insert, Charge::call>(L);
  push_function<set_member, Charge::call>(L, 1);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  for (std::size_t i = 0; i < std::size(kKinds); ++i) {
    lua_pushinteger(L, static_cast<lua_Integer>(i));
    push_function<make_shape, Charge::call>(L, 1);
    lua_setglobal(L, kKinds[i].name);
  }
  set_global<feature_set, Charge::call>(L, "FeatureSet");
  set_global<boundary_feature, Charge::call>(L, "BoundaryFeature");
}

}  // namespace verisim::script

// The geometry words: Model, modelParts, Transform, Group, MatrixTransform, Solid.*.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

using NodePointer = std::shared_ptr<Node>;

constexpr std::array<const char*, 8> kReadable = {"step", "stp", "brep", "stl", "obj", "ply", "gltf", "glb"};

std::string lower_extension(const std::string& file) {
  const std::size_t dot = file.find_last_of('.');
  std::string extension = dot == std::string::npos ? std::string{} : file.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
  return extension;
}

bool readable(const std::string& file) {
  const std::string extension = lower_extension(file);
  return std::find(kReadable.begin(), kReadable.end(), extension) != kReadable.end();
}

/// The name under which Inputs finds a model: as it stands or below a folder of the search path. A format that cannot
/// be read is replaced by a sibling of the same stem in one that can, with a notice.
std::string find_model(lua_State* L, const std::string& given) {
  ScriptState& state = ScriptState::of(L);
  std::string name = given;
  std::replace(name.begin(), name.end(), '\\', '/');
  std::vector<std::string> places = {name};
  for (const std::string& folder : state.search_path) places.push_back(fmt::format("{}/{}", folder, name));
  for (const std::string& place : places) {
    if (readable(place)) {
      if (state.has_file(L, place)) return place;
      continue;
    }
    const std::size_t dot = lower_extension(place).empty() ? place.size() : place.find_last_of('.');
    for (const char* extension : kReadable) {
      std::string sibling = fmt::format("{}.{}", place.substr(0, dot), extension);
      if (!state.has_file(L, sibling)) continue;
      state.notice(
          fmt::format("{}: {} is in a format that cannot be read; {} is read in its place", where(L), given, sibling));
      return sibling;
    }
  }
  if (!readable(name))
    raise(L, "{}: models of this format cannot be read, and there is no file of that name in one that can ({})", given,
          fmt::join(kReadable, ", "));
  return name;  // Inputs says what is wrong with it
}

NodePointer model_node(lua_State* L) {
  Sandbox::of(L).keep(2 * kNodeBytes);
  auto node = std::make_shared<Node>();
  node->kind = Node::Kind::model;
  std::string file;
  if (lua_type(L, 1) == LUA_TTABLE) {
    Fields fields(L, 1, "Model");
    fields.push_child(1);
    file = text_at(L, -1, "Model: the file");
    lua_pop(L, 1);
    node->file_scale = fields.positive("scale").value_or(1);
    node->recover = fields.boolean("brep").value_or(false);
    if (const auto part = fields.positive("part")) {
      if (*part != std::floor(*part))
        raise(L, "Model: part is {:g} but must be a whole number, 1 for the first", *part);
      node->part = static_cast<int>(*part);
    }
    fields.finish(true);
  } else {
    file = text_at(L, 1, "Model: the file");
    if (!lua_isnoneornil(L, 2)) {
      Fields fields(L, 2, "Model");
      node->file_scale = fields.positive("scale").value_or(1);
      node->recover = fields.boolean("brep").value_or(false);
      node->part = static_cast<int>(fields.positive("part").value_or(0));
      fields.finish(false);
    }
  }
  node->file = find_model(L, file);
  return node;
}

int model(lua_State* L) {
  push(L, model_node(L));
  return 1;
}

// { min, max }, each also under its name.
void push_bounds(lua_State* L, const Bounds& bounds) {
  lua_newtable(L);
  push(L, Vector3d(bounds.min));
  lua_pushvalue(L, -1);
  lua_setfield(L, -3, "min");
  lua_rawseti(L, -2, 1);
  push(L, Vector3d(bounds.max));
  lua_pushvalue(L, -1);
  lua_setfield(L, -3, "max");
  lua_rawseti(L, -2, 2);
}

// modelParts(file[, {scale=, brep=}]) -> { { name=, index=, volume=, center=, bounds={min, max}, brep= }, … }
int model_parts(lua_State* L) {
  const std::string file = find_model(L, text_at(L, 1, "modelParts: the file"));
  double scale = 1;
  bool recover = false;
  if (!lua_isnoneornil(L, 2)) {
    Fields fields(L, 2, "modelParts");
    scale = fields.positive("scale").value_or(1);
    recover = fields.boolean("brep").value_or(false);
    fields.finish(false);
  }
  const std::vector<Part>& parts = load_file(ScriptState::of(L).inputs, file, scale, recover);
  lua_createtable(L, static_cast<int>(parts.size()), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    lua_newtable(L);
    push_text(L, parts[i].name);
    lua_setfield(L, -2, "name");
    lua_pushnumber(L, static_cast<double>(i + 1));
    lua_setfield(L, -2, "index");
    lua_pushnumber(L, parts[i].mass.volume);
    lua_setfield(L, -2, "volume");
    push(L, Vector3d(parts[i].mass.centroid));
    lua_setfield(L, -2, "center");
    push_bounds(L, bounds_of(parts[i].mesh));
    lua_setfield(L, -2, "bounds");
    lua_pushboolean(L, parts[i].has_brep() ? 1 : 0);
    lua_setfield(L, -2, "brep");
    lua_rawseti(L, -2, static_cast<int>(i + 1));
  }
  return 1;
}

void add_children(lua_State* L, Fields& fields, Node& group, const std::string& word) {
  Sandbox::charge(L, kEventWork + 20 * static_cast<std::uint64_t>(fields.children()));
  Sandbox::of(L).keep(kNodeBytes + 32 * static_cast<std::size_t>(fields.children()));
  for (int i = 1; i <= fields.children(); ++i) {
    fields.push_child(i);
    // A child that only draws (a light, a text) has no part in a body.
    if (get_if<Drawing>(L, lua_gettop(L)) == nullptr)
      group.children.push_back(get<NodePointer>(L, lua_gettop(L), fmt::format("{}: child {}", word, i)));
    lua_pop(L, 1);
  }
}

int transform(lua_State* L) {
  Fields fields(L, 1, "Transform");
  auto node = std::make_shared<Node>();
  node->scale = fields.positive("scale").value_or(1);
  node->pose.position = fields.vector("position").value_or(Vector3d::Zero());
  node->pose.rotation = fields.rotation("orientation").value_or(Quaterniond::Identity());
  add_children(L, fields, *node, "Transform");
  fields.finish(true);
  push(L, node);
  return 1;
}

int group(lua_State* L) {
  Fields fields(L, 1, "Group");
  auto node = std::make_shared<Node>();
  add_children(L, fields, *node, "Group");
  fields.finish(true);
  push(L, node);
  return 1;
}

// A matrix that stretches or shears would turn cylinders into something else; only one scale for all axes is taken.
void set_similarity(lua_State* L, const Matrix& matrix, Node& node) {
  const Matrix3d linear = matrix.topLeftCorner<3, 3>().transpose();  // rows act on row vectors
  const double scale = linear.col(0).norm();
  const Matrix3d R = linear / scale;
  constexpr double kTolerance = 1e-6;  // single-precision matrices of modelling programs
  if (!(scale > 0) || !((R * R.transpose() - Matrix3d::Identity()).norm() < kTolerance) || !(R.determinant() > 0))
    raise(L,
          "MatrixTransform: the matrix stretches, shears or mirrors; only a rotation, one scale and a translation are "
          "taken");
  node.scale = std::abs(scale - 1) < 1e-12 ? 1 : scale;
  node.pose = {matrix.row(3).head<3>().transpose(), Quaterniond(R).normalized()};
}

int matrix_transform(lua_State* L) {
  Fields fields(L, 1, "MatrixTransform");
  auto node = std::make_shared<Node>();
  if (fields.push("matrix")) {
    set_similarity(L, get<Matrix>(L, lua_gettop(L), "MatrixTransform: matrix"), *node);
    lua_pop(L, 1);
  }
  add_children(L, fields, *node, "MatrixTransform");
  fields.finish(true);
  push(L, node);
  return 1;
}

// --- solids ---------------------------------------------------------------------------------------------------------

int push_solid(lua_State* L, Solid solid, int pieces = 1) {
  if (pieces > kSolidPiecesMax)
    raise(L, "the solid is made of more than {} pieces; make it from fewer", kSolidPiecesMax);
  Sandbox::charge(L, 100 + 10 * static_cast<std::uint64_t>(pieces));
  Sandbox::of(L).keep(2 * kNodeBytes);
  check(solid);
  auto node = std::make_shared<Node>();
  node->kind = Node::Kind::solid;
  node->solid = std::make_shared<const Solid>(std::move(solid));
  node->pieces = pieces;
  push(L, node);
  return 1;
}

int box(lua_State* L) {
  if (lua_type(L, 1) != LUA_TTABLE)
    raise(L, "Solid.box is called with {}; call it with its three lengths: Solid.box{{0.2, 0.2, 0.1}}",
          described(L, 1));
  const Vector3d size = vector_at(L, 1, "Solid.box: the size");
  return push_solid(
      L, {.kind = Solid::Kind::box, .sizes = {size.x(), size.y(), size.z()}, .children = {}, .placement = {}});
}

template <typename... Names>
int round_solid(lua_State* L, Solid::Kind kind, const char* word, Names... names) {
  Fields fields(L, 1, word);
  Solid solid{.kind = kind, .sizes = {}, .children = {}, .placement = {}};
  for (const char* name : {names...}) {
    const auto size = fields.number(name);
    if (!size) raise(L, "{} needs {}: {}{{ {} = … }} in metres", word, name, word, name);
    solid.sizes.push_back(*size);
  }
  fields.finish(false);
  return push_solid(L, std::move(solid));
}

int cylinder(lua_State* L) {
  return round_solid(L, Solid::Kind::cylinder, "Solid.cylinder", "radius", "height");
}
int cone(lua_State* L) {
  return round_solid(L, Solid::Kind::cone, "Solid.cone", "radius1", "radius2", "height");
}
int sphere(lua_State* L) {
  return round_solid(L, Solid::Kind::sphere, "Solid.sphere", "radius");
}
int tube(lua_State* L) {
  return round_solid(L, Solid::Kind::tube, "Solid.tube", "outer", "inner", "height");
}
int torus(lua_State* L) {
  return round_solid(L, Solid::Kind::torus, "Solid.torus", "ringRadius", "radius");
}

NodePointer solid_at(lua_State* L, int index, const char* what) {
  NodePointer node = get<NodePointer>(L, index, what);
  if (node->kind != Node::Kind::solid) raise(L, "{} must be a Solid; models of files cannot be cut or joined", what);
  return node;
}

int combine(lua_State* L, Solid::Kind kind, const char* what) {
  const NodePointer a = solid_at(L, 1, what);
  const NodePointer b = solid_at(L, 2, what);
  return push_solid(L, {.kind = kind, .sizes = {}, .children = {a->solid, b->solid}, .placement = {}},
                    a->pieces + b->pieces + 1);
}
int subtract(lua_State* L) {
  return combine(L, Solid::Kind::difference, "each side of '-'");
}
int add(lua_State* L) {
  return combine(L, Solid::Kind::sum, "each side of '+'");
}
int intersect(lua_State* L) {
  return combine(L, Solid::Kind::intersection, "each side of '*'");
}

int node_translate(lua_State* L) {
  const NodePointer inner = solid_at(L, 1, "what :translate moves");
  Pose placement;
  if (lua_gettop(L) >= 4)
    placement.position = {number_at(L, 2, "translate: x"), number_at(L, 3, "translate: y"),
                          number_at(L, 4, "translate: z")};
  else
    placement.position = vector_at(L, 2, "translate: the way");
  return push_solid(L, {.kind = Solid::Kind::placed, .sizes = {}, .children = {inner->solid}, .placement = placement},
                    inner->pieces + 1);
}

int node_rotate(lua_State* L) {
  const NodePointer inner = solid_at(L, 1, "what :rotate turns");
  const Pose placement{.position = Vector3d::Zero(), .rotation = rotation_at(L, 2, "rotate: the rotation")};
  return push_solid(L, {.kind = Solid::Kind::placed, .sizes = {}, .children = {inner->solid}, .placement = placement},
                    inner->pieces + 1);
}

int add_child(lua_State* L) {
  const NodePointer group_node = get<NodePointer>(L, 1, "what :addChild adds to");
  if (group_node->kind != Node::Kind::group) raise(L, "addChild: only a Group or Transform has children");
  const NodePointer child = get<NodePointer>(L, 2, "addChild: the child");
  if (hangs_below(*child, *group_node, [&] { Sandbox::charge(L, 10); }))
    raise(L, "addChild: the group hangs below what is to be its child; nothing can hold itself");
  Sandbox::of(L).keep(2 * sizeof child);
  group_node->children.push_back(child);
  return 0;
}

// A method that is not there belongs to the drawing side of a node (state sets, node masks).
int node_member(lua_State* L) {
  const std::string name = text_at(L, 2, "a node's member");
  lua_getfield(L, lua_upvalueindex(1), name.c_str());
  if (!lua_isnil(L, -1)) return 1;
  Sandbox::charge(L, kEventWork);
  ScriptState::of(L).notice(fmt::format("{}: node:{} only draws and is ignored", where(L), name));
  lua_getfield(L, LUA_REGISTRYINDEX, "verisim.drawing");
  return 1;
}

}  // namespace

void add_node_words(lua_State* L) {
  push_metatable<NodePointer>(L);
  set_function<subtract, Charge::call>(L, "__sub");
  set_function<add, Charge::call>(L, "__add");
  set_function<intersect, Charge::call>(L, "__mul");
  lua_newtable(L);
  set_function<node_translate, Charge::call>(L, "translate");
  set_function<node_rotate, Charge::call>(L, "rotate");
  set_function<add_child, Charge::call>(L, "addChild");
  push_function<node_member, Charge::call>(L, 1);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);

  set_global<model, Charge::call>(L, "Model");
  set_global<model_parts, Charge::call>(L, "modelParts");
  set_global<transform, Charge::call>(L, "Transform");
  set_global<group, Charge::call>(L, "Group");
  set_global<matrix_transform, Charge::call>(L, "MatrixTransform");
  lua_newtable(L);
  set_function<box, Charge::call>(L, "box");
  set_function<cylinder, Charge::call>(L, "cylinder");
  set_function<cone, Charge::call>(L, "cone");
  set_function<sphere, Charge::call>(L, "sphere");
  set_function<tube, Charge::call>(L, "tube");
  set_function<torus, Charge::call>(L, "torus");
  lua_setglobal(L, "Solid");
}

}  // namespace verisim::script

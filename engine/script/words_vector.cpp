// osg.Vec3 and osg.Quat with OpenSceneGraph's meaning of every operator, and VR JuggLua's short words for them.
//
// OpenSceneGraph's products run from left to right: (q1 * q2) * v turns v by q1 first, then by q2.
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

Vector3d& vector_of(lua_State* L, int index, const char* what) {
  return get<Vector3d>(L, index, what);
}
Quaterniond& quat_of(lua_State* L, int index, const char* what) {
  return get<Quaterniond>(L, index, what);
}

int push_vector(lua_State* L, const Vector3d& v) {
  push(L, Vector3d(v));
  return 1;
}
int push_quat(lua_State* L, const Quaterniond& q) {
  push(L, Quaterniond(q));
  return 1;
}
int push_number(lua_State* L, double value) {
  lua_pushnumber(L, value);
  return 1;
}

// --- osg.Vec3 -------------------------------------------------------------------------------------------------------

// osg.Vec3(), osg.Vec3(x, y, z), osg.Vec3(other), osg.Vec3({x, y, z})
int make_vector(lua_State* L) {
  const int count = lua_gettop(L);
  if (count == 0) return push_vector(L, Vector3d::Zero());
  if (count == 1) return push_vector(L, vector_at(L, 1, "osg.Vec3: the vector"));
  return push_vector(L,
                     {number_at(L, 1, "osg.Vec3: x"), number_at(L, 2, "osg.Vec3: y"), number_at(L, 3, "osg.Vec3: z")});
}

int add_vectors(lua_State* L) {
  return push_vector(L, vector_of(L, 1, "a side of '+'") + vector_of(L, 2, "a side of '+'"));
}
int subtract_vectors(lua_State* L) {
  return push_vector(L, vector_of(L, 1, "a side of '-'") - vector_of(L, 2, "a side of '-'"));
}
int negate_vector(lua_State* L) {
  return push_vector(L, -vector_of(L, 1, "what '-' negates"));
}

// v * w: dot product; v * s and s * v: scaled. v * M is the matrix's business (words_matrix.cpp).
int multiply_vector(lua_State* L) {
  const Vector3d* a = get_if<Vector3d>(L, 1);
  const Vector3d* b = get_if<Vector3d>(L, 2);
  if (a != nullptr && b != nullptr) return push_number(L, a->dot(*b));
  if (a != nullptr) {
    if (const Matrix* M = get_if<Matrix>(L, 2)) {
      const Eigen::RowVector4d product = Eigen::RowVector4d(a->x(), a->y(), a->z(), 1) * *M;
      return push_vector(L, product.head<3>().transpose() / product[3]);
    }
    return push_vector(L, *a * number_at(L, 2, "the right side of '*'"));
  }
  return push_vector(L, number_at(L, 1, "the left side of '*'") * vector_of(L, 2, "the right side of '*'"));
}

int divide_vector(lua_State* L) {
  return push_vector(L, vector_of(L, 1, "the left side of '/'") / number_at(L, 2, "the right side of '/'"));
}
int cross_vectors(lua_State* L) {
  return push_vector(L, vector_of(L, 1, "a side of '^'").cross(vector_of(L, 2, "a side of '^'")));
}

int vectors_equal(lua_State* L) {
  lua_pushboolean(L, vector_of(L, 1, "a side of '=='") == vector_of(L, 2, "a side of '=='") ? 1 : 0);
  return 1;
}

int vector_text(lua_State* L) {
  const Vector3d& v = vector_of(L, 1, "a vector");
  push_text(L, fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()));
  return 1;
}

template <int Axis>
int vector_component(lua_State* L) {
  return push_number(L, vector_of(L, 1, "what a component is asked of")[Axis]);
}

int vector_length(lua_State* L) {
  return push_number(L, std::sqrt(vector_of(L, 1, "what has a length").squaredNorm()));
}
int vector_length_squared(lua_State* L) {
  return push_number(L, vector_of(L, 1, "what has a length").squaredNorm());
}

// In place; returns the length that it had (OpenSceneGraph). The zero vector stays.
int normalize_vector(lua_State* L) {
  Vector3d& v = vector_of(L, 1, "what is normalized");
  const double length = std::sqrt(v.squaredNorm());
  if (length > 0) v /= length;
  return push_number(L, length);
}

int set_vector(lua_State* L) {
  Vector3d& v = vector_of(L, 1, "what is set");
  if (lua_gettop(L) == 2)
    v = vector_at(L, 2, "set: the vector");
  else
    v = {number_at(L, 2, "set: x"), number_at(L, 3, "set: y"), number_at(L, 4, "set: z")};
  return 0;
}

// v[1] … v[3] beside v:x() … v:z(), and the methods.
int vector_member(lua_State* L) {
  const Vector3d& v = vector_of(L, 1, "what a member is asked of");
  if (lua_type(L, 2) == LUA_TNUMBER) {
    const double index = lua_tonumber(L, 2);
    if (index != 1 && index != 2 && index != 3) return 0;
    return push_number(L, v[static_cast<int>(index) - 1]);
  }
  const std::string name = text_at(L, 2, "a vector's member");
  lua_getfield(L, lua_upvalueindex(1), name.c_str());
  if (lua_isnil(L, -1))
    raise(L, "a vector has no '{}'{}", name,
          suggestion(name, {"x", "y", "z", "length", "length2", "normalize", "set"}));
  return 1;
}

// --- osg.Quat -------------------------------------------------------------------------------------------------------

Quaterniond turning(double angle, const Vector3d& axis) {
  const double length = std::sqrt(axis.squaredNorm());
  if (length == 0) return Quaterniond::Identity();  // as OpenSceneGraph has it
  const Vector3d v = axis * (pinned::sin(angle / 2) / length);
  return {pinned::cos(angle / 2), v.x(), v.y(), v.z()};
}

// osg.Quat(), osg.Quat(x, y, z, w), osg.Quat(angle, axis)
int make_quat(lua_State* L) {
  switch (lua_gettop(L)) {
    case 0:
      return push_quat(L, Quaterniond::Identity());
    case 1:
      return push_quat(L, rotation_at(L, 1, "osg.Quat: the rotation"));
    case 2:
      return push_quat(L, turning(number_at(L, 1, "osg.Quat: the angle"), vector_at(L, 2, "osg.Quat: the axis")));
    default:
      return push_quat(L, Quaterniond(number_at(L, 4, "osg.Quat: w"), number_at(L, 1, "osg.Quat: x"),
                                      number_at(L, 2, "osg.Quat: y"), number_at(L, 3, "osg.Quat: z")));
  }
}

int multiply_quat(lua_State* L) {
  const Quaterniond& q = quat_of(L, 1, "the left side of '*'");
  if (const Vector3d* v = get_if<Vector3d>(L, 2)) return push_vector(L, q * *v);
  if (lua_type(L, 2) == LUA_TNUMBER) return push_quat(L, Quaterniond(q.coeffs() * lua_tonumber(L, 2)));
  return push_quat(L, quat_of(L, 2, "the right side of '*'") * q);
}

int quat_inverse(lua_State* L) {
  return push_quat(L, quat_of(L, 1, "what is inverted").inverse());
}
int quat_conjugate(lua_State* L) {
  return push_quat(L, quat_of(L, 1, "what is conjugated").conjugate());
}
int quat_length(lua_State* L) {
  return push_number(L, std::sqrt(quat_of(L, 1, "what has a length").squaredNorm()));
}

template <int Index>
int quat_component(lua_State* L) {
  return push_number(L, quat_of(L, 1, "what a component is asked of").coeffs()[Index]);
}

// q:makeRotate(angle, axis), or from one direction to another: q:makeRotate(from, to)
int quat_make_rotate(lua_State* L) {
  Quaterniond& q = quat_of(L, 1, "what is set");
  if (lua_type(L, 2) == LUA_TNUMBER)
    q = turning(lua_tonumber(L, 2), vector_at(L, 3, "makeRotate: the axis"));
  else
    q = turn_between(vector_at(L, 2, "makeRotate: from"), vector_at(L, 3, "makeRotate: to"));
  return 0;
}

// q:slerp(t, from, to) sets q.
int slerp_quat(lua_State* L) {
  Quaterniond& q = quat_of(L, 1, "what is set");
  q = slerp(rotation_at(L, 3, "slerp: from"), rotation_at(L, 4, "slerp: to"), number_at(L, 2, "slerp: t"));
  return 0;
}

// q:getAngle(), q:getAxis()
int quat_angle(lua_State* L) {
  return push_number(L, std::sqrt(vector_from_rotation(quat_of(L, 1, "a rotation").normalized()).squaredNorm()));
}
int quat_axis(lua_State* L) {
  const Vector3d w = vector_from_rotation(quat_of(L, 1, "a rotation").normalized());
  const double angle = std::sqrt(w.squaredNorm());
  return push_vector(L, angle > 0 ? Vector3d(w / angle) : Vector3d::UnitZ());
}

int quat_text(lua_State* L) {
  const Quaterniond& q = quat_of(L, 1, "a rotation");
  push_text(L, fmt::format("({:g}, {:g}, {:g}, {:g})", q.x(), q.y(), q.z(), q.w()));
  return 1;
}

int quats_equal(lua_State* L) {
  lua_pushboolean(L, quat_of(L, 1, "a side of '=='").coeffs() == quat_of(L, 2, "a side of '=='").coeffs() ? 1 : 0);
  return 1;
}

// --- short words ----------------------------------------------------------------------------------------------------

int angle_axis(lua_State* L) {
  return push_quat(L, turning(number_at(L, 1, "AngleAxis: the angle"), vector_at(L, 2, "AngleAxis: the axis")));
}
int axis(lua_State* L) {
  return push_vector(L, vector_at(L, 1, "Axis: the direction"));
}
int radians_of_degrees(lua_State* L) {
  return push_number(L, number_at(L, 1, "Degrees: the angle") * (pinned::kPi / 180));
}
int radians(lua_State* L) {
  return push_number(L, number_at(L, 1, "Radians: the angle"));
}

void add_vector_type(lua_State* L) {
  push_metatable<Vector3d>(L);
  set_function<add_vectors, Charge::call>(L, "__add");
  set_function<subtract_vectors, Charge::call>(L, "__sub");
  set_function<negate_vector, Charge::call>(L, "__unm");
  set_function<multiply_vector, Charge::call>(L, "__mul");
  set_function<divide_vector, Charge::call>(L, "__div");
  set_function<cross_vectors, Charge::call>(L, "__pow");
  set_function<vectors_equal, Charge::call>(L, "__eq");
  set_function<vector_text, Charge::call>(L, "__tostring");
  lua_newtable(L);
  set_function<vector_component<0>, Charge::call>(L, "x");
  set_function<vector_component<1>, Charge::call>(L, "y");
  set_function<vector_component<2>, Charge::call>(L, "z");
  set_function<vector_length, Charge::call>(L, "length");
  set_function<vector_length_squared, Charge::call>(L, "length2");
  set_function<normalize_vector, Charge::call>(L, "normalize");
  set_function<set_vector, Charge::call>(L, "set");
  push_function<vector_member, Charge::call>(L, 1);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
}

void add_quat_type(lua_State* L) {
  push_metatable<Quaterniond>(L);
  set_function<multiply_quat, Charge::call>(L, "__mul");
  set_function<quat_inverse, Charge::call>(L, "__unm");
  set_function<quats_equal, Charge::call>(L, "__eq");
  set_function<quat_text, Charge::call>(L, "__tostring");
  lua_newtable(L);
  set_function<quat_component<0>, Charge::call>(L, "x");
  set_function<quat_component<1>, Charge::call>(L, "y");
  set_function<quat_component<2>, Charge::call>(L, "z");
  set_function<quat_component<3>, Charge::call>(L, "w");
  set_function<quat_inverse, Charge::call>(L, "inverse");
  set_function<quat_conjugate, Charge::call>(L, "conj");
  set_function<quat_length, Charge::call>(L, "length");
  set_function<quat_make_rotate, Charge::call>(L, "makeRotate");
  set_function<slerp_quat, Charge::call>(L, "slerp");
  set_function<quat_angle, Charge::call>(L, "getAngle");
  set_function<quat_axis, Charge::call>(L, "getAxis");
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
}

}  // namespace

void add_vector_words(lua_State* L) {
  add_vector_type(L);
  add_quat_type(L);
  lua_newtable(L);  // osg
  for (const char* name : {"Vec3", "Vec3d", "Vec3f"}) set_function<make_vector, Charge::call>(L, name);
  set_function<make_quat, Charge::call>(L, "Quat");
  lua_setglobal(L, "osg");
  for (const char* name : {"Vec", "Vecd", "Vecf"}) set_global<make_vector, Charge::call>(L, name);
  set_global<angle_axis, Charge::call>(L, "AngleAxis");
  set_global<axis, Charge::call>(L, "Axis");
  set_global<radians_of_degrees, Charge::call>(L, "Degrees");
  set_global<radians, Charge::call>(L, "Radians");
  lua_newtable(L);
  const std::pair<const char*, double> units[] = {
      {"inches", 0.0254}, {"feet", 0.3048}, {"meters", 1}, {"centimeters", 0.01}, {"millimeters", 0.001}};
  for (const auto& [name, metres] : units) {
    lua_pushnumber(L, metres);
    lua_setfield(L, -2, name);
  }
  lua_setglobal(L, "ScaleFrom");
}

}  // namespace verisim::script

// Values between Lua and C++: objects of the engine as Lua userdata, and checked reading of a script's values. Errors
// are Lua errors that name the word, the field, its value and the required value.
#pragma once

#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/pose.hpp"
#include "engine/script/sandbox.hpp"

namespace verisim::script {

inline constexpr std::size_t kLongestLine = 4096;
inline constexpr std::size_t kLongestText = std::size_t{16} << 20;

/// osg.Matrix: 4 x 4, rows act on row vectors from the left (v * M), as OpenSceneGraph has it.
using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

struct Node;
struct BodyHandle;
struct DeviceNode;
struct HeadNode;
struct CollisionCounter;
struct FrameActionHandle;
struct Drawing;

/// The name of each type in messages and as the key of its metatable.
template <typename T>
inline constexpr const char* kTypeName = nullptr;
template <>
inline constexpr const char* kTypeName<Vector3d> = "osg.Vec3d";
template <>
inline constexpr const char* kTypeName<Quaterniond> = "osg.Quat";
template <>
inline constexpr const char* kTypeName<Matrix> = "osg.Matrix";
template <>
inline constexpr const char* kTypeName<Pose> = "pose";
template <>
inline constexpr const char* kTypeName<std::shared_ptr<Node>> = "node";
template <>
inline constexpr const char* kTypeName<BodyHandle> = "body";
template <>
inline constexpr const char* kTypeName<std::shared_ptr<DeviceNode>> = "device";
template <>
inline constexpr const char* kTypeName<std::shared_ptr<HeadNode>> = "WiiHead";
template <>
inline constexpr const char* kTypeName<std::shared_ptr<CollisionCounter>> = "CollisionCounter";
template <>
inline constexpr const char* kTypeName<FrameActionHandle> = "frame action";
template <>
inline constexpr const char* kTypeName<Drawing> = "drawing";

namespace detail {
template <typename T>
T* aligned(void* block) {  // Lua aligns userdata to 8 bytes, Eigen's quaternions want 16 or more
  std::size_t space = sizeof(T) + alignof(T);
  return static_cast<T*>(std::align(alignof(T), sizeof(T), block, space));
}
template <typename T>
void destroy(void* block) {
  aligned<T>(block)->~T();
}
}  // namespace detail

/// Leaves the metatable of T on the stack; makes it at first use. Scripts cannot get at it.
template <typename T>
void push_metatable(lua_State* L) {
  static_assert(kTypeName<T> != nullptr, "a type that scripts hold has a name");
  lua_getfield(L, LUA_REGISTRYINDEX, kTypeName<T>);
  if (!lua_isnil(L, -1)) return;
  lua_pop(L, 1);
  lua_newtable(L);
  lua_pushstring(L, kTypeName<T>);
  lua_setfield(L, -2, "__metatable");
  lua_pushvalue(L, -1);
  lua_setfield(L, LUA_REGISTRYINDEX, kTypeName<T>);  // last: each of these may raise
}

template <typename T>
void push(lua_State* L, T value) {
  push_metatable<T>(L);
  Sandbox& sandbox = Sandbox::of(L);
  const std::uint32_t destroyer = std::is_trivially_destructible_v<T> ? 0 : sandbox.destroyer(detail::destroy<T>);
  void* block = lua_newuserdata(L, sizeof(T) + alignof(T));
  new (detail::aligned<T>(block)) T(std::move(value));
  if (destroyer != 0) sandbox.destroy_later(L, -1, destroyer);
  lua_insert(L, -2);
  lua_setmetatable(L, -2);
}

/// The T at `index`, or null if something else is there.
template <typename T>
T* get_if(lua_State* L, int index) {
  void* block = lua_touserdata(L, index);
  if (block == nullptr || lua_getmetatable(L, index) == 0) return nullptr;
  lua_getfield(L, LUA_REGISTRYINDEX, kTypeName<T>);
  const bool same = lua_rawequal(L, -1, -2) != 0;
  lua_pop(L, 2);
  return same ? detail::aligned<T>(block) : nullptr;
}

/// __newindex of what a script can only read: raises, with the type and the member.
int refuse_assignment(lua_State* L);

/// osg.Matrix of a placement, and the placement in a matrix (scales taken out). words_matrix.cpp.
void push_matrix_of(lua_State* L, const Pose& pose);
[[nodiscard]] Pose pose_of_matrix(lua_State* L, const Matrix& matrix, const std::string& what);

/// Description of the value at `index` for messages: "a text ('abc')", "nothing", "a body".
[[nodiscard]] std::string described(lua_State* L, int index);

/// The T at `index`; `what` begins the message if something else is there.
template <typename T>
T& get(lua_State* L, int index, const std::string& what) {
  T* value = get_if<T>(L, index);
  if (value == nullptr) raise(L, "{} must be a {}, not {}", what, kTypeName<T>, described(L, index));
  return *value;
}

[[nodiscard]] double number_at(lua_State* L, int index, const std::string& what);  ///< finite
/// One line of UTF-8 of at most kLongestLine bytes without control characters (engine/base/text.hpp): what a word is
/// given may end in the run file, in JSON or on the terminal.
[[nodiscard]] std::string text_at(lua_State* L, int index, const std::string& what);
/// The same, of at most kLongestName bytes: what names something.
[[nodiscard]] std::string name_at(lua_State* L, int index, const std::string& what);
/// What the run file calls what is called `name`: its names are groups of groups, and a pair of format 1 was 'A~B'.
/// Characters that would break those are replaced, with a notice; `what` begins the message if nothing is left.
[[nodiscard]] std::string recordable(lua_State* L, const std::string& what, const std::string& name);
/// Any bytes, of at most kLongestText: code, or what is said and then made harmless (shown).
[[nodiscard]] std::string any_text_at(lua_State* L, int index, const std::string& what);
[[nodiscard]] bool boolean_at(lua_State* L, int index, const std::string& what);
[[nodiscard]] Vector3d vector_at(lua_State* L, int index, const std::string& what);  ///< osg.Vec3 or {x, y, z}
[[nodiscard]] Quaterniond rotation_at(lua_State* L, int index,
                                      const std::string& what);  ///< osg.Quat or {x, y, z, w}; unit
void push_text(lua_State* L, std::string_view text);

/// A word that is accepted and does nothing.
int no_effect(lua_State* L);

/// ", or an empty string": "; did you mean 'x'? (a, b, c)" for a wrong name among `known` (sorted here).
[[nodiscard]] std::string suggestion(const std::string& name, std::vector<std::string> known);

/// The table that a word is called with: word{ field = value, child, … }. Each read names a field; finish() refuses the
/// rest.
class Fields {
 public:
  /// Raises if there is no table at `index`. @pre index counts from the bottom of the stack, and word is not empty
  Fields(lua_State* L, int index, std::string word);

  [[nodiscard]] std::optional<double> number(const char* name);
  [[nodiscard]] double number(const char* name, double otherwise) { return number(name).value_or(otherwise); }
  /// A number that must be above zero.
  [[nodiscard]] std::optional<double> positive(const char* name);
  /// A number that must not be below zero.
  [[nodiscard]] double not_negative(const char* name, double otherwise);
  [[nodiscard]] std::optional<std::string> text(const char* name);
  /// The field "name".
  [[nodiscard]] std::optional<std::string> name();
  [[nodiscard]] std::optional<bool> boolean(const char* name);
  [[nodiscard]] std::optional<Vector3d> vector(const char* name);
  [[nodiscard]] std::optional<Quaterniond> rotation(const char* name);
  /// Leaves the field's value on the stack if there is one.
  [[nodiscard]] bool push(const char* name);
  /// A field that is allowed and has no effect; true if it is there.
  [[nodiscard]] bool accepted(const char* name);

  /// Entries without a name: 1 … n.
  [[nodiscard]] int children() const { return static_cast<int>(lua_objlen(L_, index_)); }
  /// Leaves the entry, or nil beyond the last, on the stack. @pre i > 0
  void push_child(int i) {
    VERISIM_ASSERT(i > 0);
    lua_rawgeti(L_, index_, i);
  }
  [[nodiscard]] std::string name_of(const char* field) const { return word_ + ": " + field; }

  /// Raises for a field that no read has named: "addObject has no 'densty'; did you mean 'density'? (…)".
  void finish(bool children_allowed);

 private:
  lua_State* L_;
  int index_;
  std::string word_;
  std::vector<std::string> known_;
};

}  // namespace verisim::script

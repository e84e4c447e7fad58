// Our copy of Lua's tables (lua_tables.cpp) keeps keys where Lua's own keeps them: random programs visit them in the
// same order in the shared library that Lua's package brings.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "tests/length.hpp"
#include "tests/script/bare_sandbox.hpp"

namespace verisim::script::lua_tables_test {
namespace {

/// A program that fills, empties and visits a table and returns what it met.
std::string program(std::uint64_t seed) {
  const RandomStream stream(seed, "tables");
  std::uint64_t drawn = 0;
  const auto draw = [&](int below) { return static_cast<int>(stream.uniform(drawn++) * below); };
  std::string text = "local t, out = {}, {} ";
  for (int i = 0; i < 300; ++i) {
    const int key = draw(40);
    const std::string keys[] = {fmt::format("{}", key),      fmt::format("{}", -key),         fmt::format("{}.5", key),
                                fmt::format("'k{}'", key),   key % 2 == 0 ? "true" : "false", fmt::format("2^{}", key),
                                fmt::format("1/{}", key + 1)};
    text += fmt::format("t[{}] = {} ", keys[draw(7)], draw(3) == 0 ? "nil" : fmt::format("{}", i));
    if (draw(20) == 0) text += "out[#out + 1] = #t for k, v in next, t do out[#out + 1] = tostring(k) .. '=' .. v end ";
  }
  return text + "return table.concat(out, ' ')";
}

class PackagedLua {
 public:
  PackagedLua() : library_(dlopen("liblua5.1.so.0", RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND)) {
    if (library_ == nullptr) return;
    state_ = function<lua_State*()>("luaL_newstate")();
    function<void(lua_State*)>("luaL_openlibs")(state_);
  }
  ~PackagedLua() {
    if (state_ != nullptr) function<void(lua_State*)>("lua_close")(state_);
  }
  PackagedLua(const PackagedLua&) = delete;
  PackagedLua& operator=(const PackagedLua&) = delete;

  [[nodiscard]] bool there() const { return state_ != nullptr; }
  std::string result_of(const std::string& text) {
    function<int(lua_State*, int, int)>("lua_gc")(state_, LUA_GCSTOP, 0);
    function<int(lua_State*, const char*)>("luaL_loadstring")(state_, text.c_str());
    function<int(lua_State*, int, int, int)>("lua_pcall")(state_, 0, 1, 0);
    const char* result = function<const char*(lua_State*, int, std::size_t*)>("lua_tolstring")(state_, -1, nullptr);
    std::string copy = result == nullptr ? "" : result;
    function<void(lua_State*, int)>("lua_settop")(state_, 0);
    return copy;
  }

 private:
  template <typename F>
  F* function(const char* name) {
    return reinterpret_cast<F*>(dlsym(library_, name));
  }
  void* library_;
  lua_State* state_ = nullptr;
};

TEST(LuaTables, KeysAreVisitedInTheOrderOfLuasOwnTables) {
  if (test::kSanitized) GTEST_SKIP() << "AddressSanitizer refuses RTLD_DEEPBIND";
  PackagedLua packaged;
  ASSERT_TRUE(packaged.there()) << "liblua5.1-0 is a dependency of liblua5.1-0-dev";
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    BareSandbox sandbox;
    lua_gc(sandbox.lua(), LUA_GCSTOP, 0);  // a removed key that is collected comes back in another slot
    const std::string text = program(seed);
    const std::string wanted = packaged.result_of(text);
    ASSERT_GT(wanted.size(), 100u);
    ASSERT_EQ(sandbox.failure_of("RESULT = (function() " + text + " end)()"), "");
    EXPECT_EQ(sandbox.value_of("RESULT"), wanted) << "seed " << seed;
  }
}

TEST(LuaTables, RefuseWhatIsNoKey) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("local t = {} t[nil] = 1"), "test.lua:1: table index is nil");
  EXPECT_EQ(sandbox.failure_of("local t = {} t[0/0] = 1"), "test.lua:1: table index is NaN");
  EXPECT_NE(sandbox.failure_of("next({}, 'nowhere')").find("invalid key to 'next'"), std::string::npos);
}

// Keys that are removed while they are visited, with the collector at work.
TEST(LuaTables, EntriesMayBeRemovedWhileTheyAreVisited) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of(R"(
    local t = {}
    for i = 1, 20000 do t['k' .. i] = i end
    local n = 0
    for k in pairs(t) do
      t[k] = nil
      n = n + 1
      local garbage = { k .. 'x' }
    end
    assert(n == 20000 and next(t) == nil))"),
            "");
}

}  // namespace
}  // namespace verisim::script::lua_tables_test

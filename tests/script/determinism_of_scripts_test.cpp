// What differs between two runs of an ordinary Lua (addresses, clocks, seeds) must not be seen by a script.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "engine/base/pinned_math.hpp"
#include "tests/script/bare_sandbox.hpp"

namespace verisim::script::determinism_of_scripts_test {
namespace {

// Shifts where the next objects lie, as another run would.
std::unique_ptr<char[]> disturb_addresses(std::size_t bytes) {
  return std::make_unique<char[]>(bytes);
}

std::vector<std::string> printed_by(const std::string& text) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of(text), "");
  return sandbox.printed;
}

constexpr const char* kPrintsObjectKeys = R"(
  local t, made = {}, {}
  for i = 1, 100 do
    local key = i % 3 == 0 and {} or i % 3 == 1 and function() return i end or coroutine.create(function() end)
    made[key] = i
    t[key] = i
    t['name' .. i] = i
    t[-i] = i
  end
  for key, value in pairs(t) do print(type(key), value) end
  for i = 1, 3 do print({}, print, function() end) end)";

TEST(PairsOfObjectKeys, ComeInTheSameOrderWhereverTheObjectsLie) {
  const auto first = printed_by(kPrintsObjectKeys);
  ASSERT_EQ(first.size(), 303u);
  for (std::size_t bytes = 100; bytes < 100'000; bytes *= 3) {
    const auto disturbance = disturb_addresses(bytes);
    EXPECT_EQ(printed_by(kPrintsObjectKeys), first);
  }
}

TEST(PairsOfObjectKeys, ComeInTheOrderOfTheirMaking) {
  EXPECT_EQ(printed_by("local a, b, c = {}, {}, {} for k, v in pairs{[c] = 3, [a] = 1, [b] = 2} do print(v) end"),
            (std::vector<std::string>{"1", "2", "3"}));
}

TEST(PairsOfObjectKeys, SkipWhatTheLoopRemoves) {
  EXPECT_EQ(printed_by("local a, b, c = {}, {}, {} local t = {[a] = 1, [b] = 2, [c] = 3} "
                       "for k, v in pairs(t) do t[b] = nil print(v) end"),
            (std::vector<std::string>{"1", "3"}));
}

TEST(Next, RefusesATableWhoseOrderWouldDependOnAddresses) {
  BareSandbox sandbox;
  EXPECT_NE(sandbox.failure_of("local t = {[{}] = 1} next(t)").find("use pairs()"), std::string::npos);
  EXPECT_EQ(sandbox.failure_of("assert(next({}) == nil) local k, v = next{x = 1} assert(k == 'x' and v == 1)"), "");
}

TEST(ToString, NumbersObjectsInTheOrderOfAsking) {
  EXPECT_EQ(printed_by("local t = {} print({}) print(t) print(t) print(print)"),
            (std::vector<std::string>{"table: 0x00000001", "table: 0x00000002", "table: 0x00000002",
                                      "function: 0x00000003"}));
}

TEST(RandomNumbers, AreTheRunsOwnStream) {
  const auto first = printed_by("for i = 1, 5 do print(math.random()) end");
  EXPECT_EQ(printed_by("for i = 1, 5 do print(math.random()) end"), first);
  const auto seeded = printed_by("math.randomseed(42) for i = 1, 5 do print(math.random()) end");
  EXPECT_NE(seeded, first);
  EXPECT_EQ(printed_by("math.random() math.randomseed(42) for i = 1, 5 do print(math.random()) end"), seeded);
}

TEST(RandomNumbers, KeepToTheirInterval) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of(R"(
    local seen = {}
    for i = 1, 1000 do
      local die, wide = math.random(6), math.random(-3, 3)
      assert(die >= 1 and die <= 6 and die == math.floor(die))
      assert(wide >= -3 and wide <= 3 and wide == math.floor(wide))
      seen[die] = true
    end
    assert(#seen == 6))"),
            "");
  EXPECT_NE(sandbox.failure_of("math.random(0)").find("interval is empty"), std::string::npos);
}

TEST(Clocks, ShowSimulatedTimeOnly) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.value_of("os.clock()"), "1.5");
  EXPECT_EQ(sandbox.value_of("os.time()"), "1");
  EXPECT_EQ(sandbox.value_of("os.getenv('HOME')"), "nil");
}

TEST(OsExit, AsksTheRunToStop) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("os.exit()"), "");
  EXPECT_TRUE(sandbox.stopped);
}

// The operator ^ and math.* give the bits of the pinned implementation, not those of this machine's C library.
TEST(Mathematics, IsPinned) {
  BareSandbox sandbox;
  for (int i = 1; i < 200; ++i) {
    const double x = 0.37 * i;
    lua_State* L = sandbox.lua();
    const auto evaluated = [&](const std::string& expression) {
      EXPECT_EQ(sandbox.failure_of("local x = 0.37 * " + std::to_string(i) + " y = " + expression), "");
      lua_getglobal(L, "y");
      const double y = lua_tonumber(L, -1);
      lua_pop(L, 1);
      return y;
    };
    EXPECT_EQ(evaluated("math.sin(x)"), pinned::sin(x));
    EXPECT_EQ(evaluated("math.exp(x)"), pinned::exp(x));
    EXPECT_EQ(evaluated("math.atan2(x, 2)"), pinned::atan2(x, 2));
    EXPECT_EQ(evaluated("x ^ 1.7"), pinned::pow(x, 1.7));
    EXPECT_EQ(evaluated("x ^ 2"), x * x);
    EXPECT_NEAR(evaluated("math.tanh(x)"), std::tanh(x), 4e-16);
    EXPECT_NEAR(evaluated("math.sinh(x / 40)"), std::sinh(x / 40), 4e-15);
  }
  EXPECT_EQ(sandbox.value_of("math.log10(1000)"), "3");
}

TEST(Print, JoinsWithTabsAsLuaDoes) {
  EXPECT_EQ(printed_by("print(1, 'a', nil, true, 0.5)"), (std::vector<std::string>{"1\ta\tnil\ttrue\t0.5"}));
}

}  // namespace
}  // namespace verisim::script::determinism_of_scripts_test

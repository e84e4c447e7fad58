// No function of a script works without paying for it. Every function that a script can reach is called on the worst
// that a script can hand it, until the allowance is spent.
#include <gtest/gtest.h>

#include <ctime>
#include <fstream>
#include <memory>
#include <set>

#include "engine/script/script_state.hpp"
#include "tests/length.hpp"
#include "tests/script/bare_sandbox.hpp"
#include "tests/script/every_function.hpp"
#include "tests/script/written_scenario.hpp"

namespace verisim::script::work_test {
namespace {

constexpr double kOverrunMax = test::kSanitized ? 20 : 2;  // s of processor time beyond what the allowance stands for

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// What a script can build within its memory that makes other functions work for long.
constexpr const char* kWorstValues = R"lua(
  local text = ("x"):rep(4e6)
  local digits = ("1"):rep(4e6)
  local list = {} for i = 1, 2e5 do list[i] = i end
  local emptied = {} for i = 1, 2e5 do emptied[i + 0.5] = true end
  for i = 1, 2e5 - 1 do emptied[i + 0.5] = nil end
  local texts = {} for i = 1, 1e5 do texts[i] = "x" end
  local deep = {} for i = 1, 1000 do deep = setmetatable({}, { __index = deep }) end
  local loop = {} loop[1] = loop
  local shared = 1 for i = 1, 7 do local row = {} for j = 1, 200 do row[j] = shared end shared = row end
  local strange = setmetatable({}, { __tostring = function() return text end, __call = function() return text end,
    __index = function(_, k) return k end, __lt = function() return true end, __concat = function() return text end })
  local set = "[" .. ("ab"):rep(5e5) .. "]"
  local function same(...) return ... end
  local function fails() error(text) end
  WORST = {
    {}, { text }, { digits }, { digits, 10 }, { digits, 16 }, { text, text }, { text, ("x"):rep(1e6) .. "y", 1, true },
    { text, ".-.-.-y" }, { text, set .. "*" }, { text, "(" .. ("."):rep(190) .. ")" }, { text, 1e9 }, { "", 1e15 },
    { "x", 6e7 }, { text, "x", text }, { text, ".", "%0%0" }, { text, "", same }, { "%99.99f", 1e308 },
    { ("%s"):rep(200), text, text, text }, { ("%d"):rep(3e5), 1 }, { "%q", text }, { list }, { list, 1, 1 },
    { list, -2147483647, 1 }, { {}, -2147483647, 1 }, { {}, 2147483647 }, { list, 1 }, { texts, text }, { list, "," , 1, 2e9 },
    { emptied }, { emptied, nil }, { list, function(a, b) return true end }, { list, function() return false end },
    { deep, "x" }, { deep }, { loop }, { { loop } }, { { x = shared } }, { shared }, { strange }, { strange, strange },
    { fails }, { fails, fails }, { same, text }, { text, 0 / 0 }, { same, 1 / 0 }, { 0 / 0, {} }, { function() while true do end end },
    { function() while true do end end, function() while true do end end }, { coroutine.create(fails) },
    { coroutine.create(function() while true do end end) }, { 19999 }, { 1e308, 1e-308 }, { 2^53, -2^53 }, { 0/0, 1/0 },
    { osg.Vec3(1, 2, 3), osg.Vec3(0, 0, 0) }, { osg.Vec3(1, 2, 3), text }, { osg.Quat(), 0.5, osg.Quat(), osg.Quat() },
    { osg.Matrix(), osg.Matrix() }, { Group{}, Group{} }, { Solid.box{1, 1, 1}, Solid.box{1, 1, 1} },
    { { Group{}, Group{} } }, { "return " .. ("a or "):rep(5e4) .. "a" }, { ("local function f() "):rep(150) .. ("x=x "):rep(1e5) },
    { ("("):rep(1e6) }, { "return " .. ("{"):rep(190) .. ("}"):rep(190) }, { text, 1, "N" }, { "kind", text }, { runbuf, text },
    { simulation, text }, { simulation, fails }, { simulation, same }, { Plane(), text }, { FeatureSet(), Plane() },
  })lua";

/// A scenario's state, with the worst values built.
class Worst {
 public:
  Worst() : inputs_(Inputs::live("/", {})), state_(options(), inputs_) {
    state_.allow(1'000'000'000);
    run(kWorstValues);
    run(kSampleValues);
  }
  std::optional<LuaFailure> run(const std::string& text) {
    auto failure = state_.load(state_.lua(), "worst.lua", text);
    if (!failure) failure = state_.call(state_.lua(), 0, 1);
    EXPECT_FALSE(failure) << failure->text;
    return failure;
  }
  ScriptState& state() { return state_; }

 private:
  static ScenarioOptions options() {
    ScenarioOptions options;
    options.path = "/worst.lua";
    return options;
  }
  Inputs inputs_;
  ScriptState state_;
};

TEST(Work, EveryFunctionThatAScriptCanReachDeclaresItsCharge) {
  Worst worst;
  lua_State* L = worst.state().lua();
  FunctionWalk walk(L);
  walk.visit("sample");
  ASSERT_GT(walk.functions().size(), 200u);
  for (const ReachedFunction& function : walk.functions())
    EXPECT_TRUE(worst.state().is_declared(function.address)) << function.path;
}

TEST(Work, NoFunctionTakesMuchLongerThanItsAllowance) {
  constexpr std::uint64_t kUnits = 30'000;
  std::size_t tuples = 60;
  std::string slowest;
  double slowest_seconds = 0;
  for (std::size_t tuple = 1; tuple <= tuples; ++tuple) {
    Worst worst;  // a new one: what a function has kept must not stop the next
    ScriptState& state = worst.state();
    lua_State* L = state.lua();
    FunctionWalk walk(L);
    walk.visit("sample");
    lua_getglobal(L, "WORST");
    tuples = lua_objlen(L, -1);
    lua_rawgeti(L, -1, static_cast<int>(tuple));
    lua_setglobal(L, "ARGUMENTS");
    lua_settop(L, 0);
    for (const ReachedFunction& function : walk.functions()) {
      lua_rawgeti(L, LUA_REGISTRYINDEX, function.reference);
      lua_setglobal(L, "F");
      state.allow(kUnits);
      const double begin = processor_seconds();
      auto failure = state.load(L, "loop.lua",
                                "local f, pcall, unpack, a = F, pcall, unpack, ARGUMENTS "
                                "for i = 1, 50 do pcall(f, unpack(a)) end");
      if (!failure) failure = state.call(L, 0, 0);
      const double seconds = processor_seconds() - begin;
      lua_settop(L, 0);
      EXPECT_LT(seconds, kOverrunMax) << function.path << " with arguments " << tuple;
      if (seconds > slowest_seconds) {
        slowest_seconds = seconds;
        slowest = fmt::format("{} with arguments {}", function.path, tuple);
      }
    }
  }
  std::printf("slowest: %.3f s, %s\n", slowest_seconds, slowest.c_str());
}

// What is cheap to call may be called often: the whole allowance goes into one function, with simple arguments.
TEST(Work, ManyCallsOfOneFunctionTakeNoLongerThanTheirAllowance) {
  constexpr std::uint64_t kUnits = 500'000;
  constexpr double kSecondsPerUnit = 20e-9, kTimes = test::kSanitized ? 100 : 10;
  Worst worst;
  ScriptState& state = worst.state();
  lua_State* L = state.lua();
  worst.run("for i = 1, 99 do vrjLua.appendToModelSearchPath('folder' .. i) end");
  FunctionWalk walk(L);
  walk.visit("sample");
  lua_settop(L, 0);
  std::string slowest;
  double slowest_seconds = 0;
  for (const ReachedFunction& function : walk.functions()) {
    for (const char* arguments : {"", "1", "'none'", "'a/b/c/d/e/f/g/h', 'none'", "{}"}) {
      lua_rawgeti(L, LUA_REGISTRYINDEX, function.reference);
      lua_setglobal(L, "F");
      state.allow(kUnits);
      const double begin = processor_seconds();
      auto failure = state.load(L, "loop.lua",
                                fmt::format("local f, pcall = F, pcall for i = 1, 1e5 do pcall(f{}{}) end",
                                            *arguments ? ", " : "", arguments));
      if (!failure) failure = state.call(L, 0, 0);
      const double seconds = processor_seconds() - begin;
      lua_settop(L, 0);
      EXPECT_LT(seconds, kTimes * kSecondsPerUnit * kUnits) << function.path << "(" << arguments << ")";
      if (seconds > slowest_seconds) {
        slowest_seconds = seconds;
        slowest = fmt::format("{}({})", function.path, arguments);
      }
    }
  }
  std::printf("slowest: %.3f s, %s\n", slowest_seconds, slowest.c_str());
}

// --- what no function does: instructions and tables -----------------------------------------------------------------

/// Spends an allowance of some 20 ms on `text`; processor time that it took.
double seconds_of(const std::string& text, std::uint64_t units = 2'000'000) {
  BareSandbox sandbox(std::size_t{256} << 20);
  sandbox.allow(units);
  auto failure = sandbox.load(sandbox.lua(), "test.lua", text);
  const double begin = processor_seconds();
  if (!failure) failure = sandbox.call(sandbox.lua(), 0, 0);
  const double seconds = processor_seconds() - begin;
  EXPECT_TRUE(failure && failure->text.find("without coming to an end") != std::string::npos)
      << text << "\n"
      << (failure ? failure->text : "came to an end");
  return seconds;
}

TEST(Work, InstructionsArePaidByWhatTheyDo) {
  const std::string longs = "local s = ('x'):rep(1e6) ";
  for (const std::string& text : {
           longs + "while true do local t = 'y' .. s end",                               // interned: no new memory
           longs + "local a, b = s .. 'a', s .. 'a' while true do local c = a < b end",  // the same text
           longs + "local a, b = s .. 'a', s .. 'b' while true do local c = a < b end",
           std::string("local s = ('1'):rep(1e6) while true do local n = tonumber(s) end"),
           std::string("local s = (' '):rep(1e6) .. 'z' while true do pcall(function() return s + 1 end) end"),
           std::string("while true do local s = 1e308 .. '' end"),
           std::string("local x = 1.5 while true do x = x ^ 1.0000001 end"),
           std::string("local function f(...) while true do local n = select('#', ...) end end f(unpack({}, 1, 7000))"),
           std::string("local function g() end local function f(n, ...) if n == 0 then while true do g(...) end end "
                       "return f(n - 1, 1, ...) end f(200)"),
           std::string("local t = {} for i = 1, 1e4 do t[i] = i end for k in pairs(t) do t[k] = nil end t[1e5] = 1 "
                       "while true do next(t) end"),
           std::string("local t = {} for i = 1, 65536 do t[i] = i end t.a = 1 t.b = 1 local n = 0 "
                       "while true do n = n + 1 t['k' .. n] = 1 t['k' .. n] = nil end"),
           std::string("local t = {} for k = 0, 30 do t[2 ^ k] = 1 end for i = 1, 1e4 do t[i] = 1 end "
                       "while true do local n = #t end"),
           // 2^52 k + j: numbers whose halves have one sum collide in every table.
           std::string(
               "local t = {} for i = 0, 1e6 do t[(2^32 + 1) * 2^19 * 1 + i * (2^32 - 1)] = i end while true do end"),
           std::string("while true do pcall(error) end"),
           std::string("while true do coroutine.resume(coroutine.create(function() error() end)) end"),
           std::string("while true do loadstring(('-- '):rep(1e5)) end"),
           std::string("local s = ('while x do if x then break end end '):rep(2000) while true do loadstring(s) end"),
           std::string("local s = 'while x do ' .. ('if x then break end '):rep(4000) .. 'end' while true do "
                       "loadstring(s) end"),
       })
    EXPECT_LT(seconds_of(text), kOverrunMax) << text;
}

// Memory and allowance may end in one and the same request: it is paid for, and then refused.
TEST(Work, MayEndTogetherWithTheMemory) {
  for (const std::string& text : {
           std::string("local t = {} for i = 1, 1e9 do t[i] = i end"),
           std::string("coroutine.wrap(function() local t = {} for i = 1, 1e9 do t[i] = i end end)()"),
           std::string("pcall(function() local t = {} for i = 1, 1e9 do t[i] = i end end)"),
           std::string("xpcall(function() local t = {} for i = 1, 1e9 do t[i] = i end end, "
                       "function() local t = {} for i = 1, 1e9 do t[i] = i end end)"),
           std::string("local s = 'x' for i = 1, 1e9 do s = s .. s end"),
           std::string("local function f() return f() + 1 end f()"),
           std::string("local function f() return unpack({}, 1, 7000), f() end f()"),
       })
    for (double units = 1e4; units < 1e7; units *= 1.04) {
      BareSandbox sandbox;
      sandbox.failure_of(text, static_cast<std::uint64_t>(units));  // and the program goes on
      EXPECT_EQ(sandbox.value_of("1 + 1"), "2") << text;
    }
}

TEST(Work, NothingCatchesTheEndOfTheAllowance) {
  const std::string forever = "while true do end";
  for (const std::string& text : {
           "while true do pcall(function() " + forever + " end) end",
           "pcall(function() " + forever + " end) AFTER = true",
           "xpcall(function() " + forever + " end, function() AFTER = true " + forever + " end) AFTER = true",
           "coroutine.resume(coroutine.create(function() " + forever + " end)) AFTER = true",
           "pcall(coroutine.wrap(function() " + forever + " end)) AFTER = true",
           "pcall(string.gsub, 'x', 'x', function() " + forever + " end) AFTER = true",
           "pcall(table.sort, {3, 2, 1}, function() " + forever + " end) AFTER = true",
           "pcall(tostring, setmetatable({}, { __tostring = function() " + forever + " end })) AFTER = true",
           "pcall(function() return setmetatable({}, { __index = function() " + forever + " end }).x end) AFTER = true",
           "pcall(load, function() " + forever + " end) AFTER = true",
           "local ok, e = pcall(pcall, pcall, function() " + forever + " end) AFTER = true",
       }) {
    BareSandbox sandbox;
    EXPECT_NE(sandbox.failure_of(text).find("without coming to an end"), std::string::npos) << text;
    EXPECT_EQ(sandbox.value_of("AFTER"), "nil") << text;
  }
}

TEST(Work, DeepCallsEndInAnErrorNotInTheProcessorsStack) {
  for (const char* text : {
           "local function f() return coroutine.wrap(f)() end f()",
           "local function f() coroutine.resume(coroutine.create(f)) end f()",
           "local function f() return pcall(f) end f()",
           "local function f() string.gsub('x', 'x', f) end f()",
           "local function f() string.gsub('x', 'x', function() coroutine.wrap(f)() end) end f()",
           "local t = {} setmetatable(t, { __index = function(_, k) return t[k .. 'x'] end }) local x = t.a",
           "local function f() return f() + 1 end f()",
           "local f = loadstring(('('):rep(1e5)) assert(f)",
       }) {
    BareSandbox sandbox(std::size_t{64} << 20);
    sandbox.failure_of(text);
  }
}

// Objects are hashed by address, which differs from one sandbox to the next.
TEST(Work, WhatAScriptPaysDoesNotDependOnAddresses) {
  std::set<std::string> ends;
  std::vector<std::unique_ptr<BareSandbox>> all;  // kept, so that addresses differ
  for (int i = 0; i < 20; ++i) {
    all.push_back(std::make_unique<BareSandbox>(std::size_t{64} << 20));
    all.back()->failure_of(
        "local t, n = {}, 0 while true do n = n + 1 t[{}] = n t[n / 3] = n t['k' .. n] = n N = n "
        "if n % 100 == 0 then for k in pairs(t) do t[k] = nil end end end",
        3'000'000);
    ends.insert(all.back()->value_of("N"));
  }
  EXPECT_EQ(ends.size(), 1u) << *ends.begin() << " " << *ends.rbegin();
}

// --- memory -------------------------------------------------------------------------------------------------------

/// The most that this process took since the last call.
std::size_t most_resident() {
  std::ifstream status("/proc/self/status");
  std::size_t kilobytes = 0;
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) kilobytes = std::stoul(line.substr(6));
  std::ofstream("/proc/self/clear_refs") << "5";
  return kilobytes * 1024;
}

TEST(Work, AScriptTakesNoMoreThanItsMemoryAnd64Megabytes) {
  if (test::kSanitized)
    GTEST_SKIP() << "AddressSanitizer keeps what was freed: the process's memory is not the script's";
  for (const std::string& text : {
           std::string("local t = {} for i = 1, 1e9 do t[i] = Group{} end"),
           std::string("local g = Group{} for i = 1, 1e9 do g = Group{ g } end"),
           std::string("local t = {} for i = 1, 1e9 do t[i] = Solid.box{1, 1, 1} end"),
           std::string("local x = {} for i = 1, 8 do local row = {} for j = 1, 1000 do row[j] = x end x = row end "
                       "params{ x = x }"),
           std::string("local x = {} x[1] = x x[2] = x params{ x = x }"),
           std::string("params{ x = ('x'):rep(5e7) }"),
           std::string("for i = 1, 1e9 do measure('m' .. i, 1) end"),
           std::string("for i = 1, 1e9 do event('kind', ('x'):rep(1000)) end"),
           std::string("for i = 1, 1e9 do runbuf:addString(('x'):rep(1e6) .. i) end"),
           std::string("for i = 1, 1e9 do loadstring('osg[\"m' .. i .. '\"]()')() end"),
           std::string("for i = 1, 1e9 do vrjLua.appendToModelSearchPath('f' .. i) end"),
           std::string("local s = ('x'):rep(6e7) print(s, s, s, s) error(s)"),
           std::string("local s = ('x'):rep(6e7) loadstring(s, s) outcome(s)"),
           std::string("local s = ('x'):rep(6e7) s:gsub('x', 'xxxx')"),
           std::string("local t = {} for i = 1, 1e9 do t[i] = 'x' .. i end"),
           std::string("local t = {} for i = 1, 1e9 do t[i] = {} end"),
       }) {
    most_resident();
    const std::size_t before = most_resident();
    WrittenScenario written(text);
    written.options.memory_limit = std::size_t{32} << 20;
    EXPECT_NE(written.refusal(), "") << text;
    constexpr std::size_t kMost = (std::size_t{32} + 64) * 1'000'000;
    EXPECT_LT(most_resident() - before, kMost) << text;
  }
}

}  // namespace
}  // namespace verisim::script::work_test

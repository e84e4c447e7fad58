// Attacks that the sandbox stops. Each attack runs in the bare sandbox; what it must say is part of the
// promise.
#include <gtest/gtest.h>

#include "tests/script/bare_sandbox.hpp"

namespace verisim::script::sandbox_test {
namespace {

constexpr const char* kSpent = "without coming to an end";

TEST(Sandbox, StopsALoopThatNeverEnds) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local i = 0\nwhile true do i = i + 1 end");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
  EXPECT_EQ(failure.rfind("test.lua:2: ", 0), 0u) << failure;
}

TEST(Sandbox, StopsALoopThatCatchesItsErrors) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("while true do pcall(function() while true do end end) end");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
}

TEST(Sandbox, StopsALoopWhoseErrorHandlerLoops) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of(
      "while true do xpcall(function() while true do end end, function() while true do end end) end");
  EXPECT_FALSE(failure.empty());
}

TEST(Sandbox, StopsALoopInACoroutine) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local c = coroutine.wrap(function() while true do end end)\nc()");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
}

// Each coroutine is shorter than the interval at which work is looked at: they have to be paid for at their making.
TEST(Sandbox, StopsCoroutinesThatAreEachTooShortToBeSeen) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of(R"(
    local function breed(depth)
      return function()
        if depth == 0 then return end
        for i = 1, 20 do coroutine.wrap(breed(depth - 1))() end
      end
    end
    coroutine.wrap(breed(10))())");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
}

TEST(Sandbox, GoesOnWithANewAllowanceAfterOneWasSpent) {
  BareSandbox sandbox;
  ASSERT_FALSE(sandbox.failure_of("function forever() while true do end end forever()").empty());
  EXPECT_EQ(sandbox.failure_of("local s = 0 for i = 1, 1e5 do s = s + i end assert(s == 5000050000)"), "");
}

TEST(Sandbox, StopsATableThatGrowsWithoutEnd) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local t = {}\nfor i = 1, 1e9 do\n  t[i] = i\nend", 1'000'000'000);
  EXPECT_NE(failure.find("needs more than 16 MiB of memory"), std::string::npos) << failure;
  EXPECT_EQ(failure.rfind("test.lua:", 0), 0u) << failure;
}

TEST(Sandbox, StopsATextThatDoublesWithoutEnd) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local s = 'x' while true do s = s .. s end");
  EXPECT_NE(failure.find("memory"), std::string::npos) << failure;
}

TEST(Sandbox, StopsARepetitionThatWouldNotFit) {
  BareSandbox sandbox;
  EXPECT_NE(sandbox.failure_of("local s = string.rep('x', 1e9)").find("1000000000 bytes"), std::string::npos);
  EXPECT_NE(sandbox.failure_of("local s = string.rep('x', 6e7)").find("memory"), std::string::npos);
  EXPECT_EQ(sandbox.failure_of("assert(string.rep('', 1e15) == '') assert(('ab'):rep(3) == 'ababab')"), "");
}

TEST(Sandbox, CopiesOfLongTextsCountAsWork) {
  BareSandbox sandbox;
  const std::string failure =
      sandbox.failure_of("local s = string.rep('x', 2e5) for i = 1, 1e6 do local t = s .. i end");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
}

TEST(Sandbox, LongListsAreShiftedOnlyForTheirPrice) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local t = {} for i = 1, 2e5 do table.insert(t, 1, i) end");
  EXPECT_NE(failure.find(kSpent), std::string::npos) << failure;
}

TEST(Sandbox, HasNoFilesProcessesOrForeignCode) {
  BareSandbox sandbox;
  for (const char* name : {"io", "package", "debug", "loadfile", "newproxy", "string.dump", "os.execute", "os.remove",
                           "os.rename", "os.tmpname", "table.foreach"})
    EXPECT_EQ(sandbox.value_of(name), "nil") << name;
}

TEST(Sandbox, RefusesCompiledLua) {
  BareSandbox sandbox;
  EXPECT_EQ(
      sandbox.failure_of("local f, e = loadstring('\\27Lua') assert(f == nil and e:find('compiled', 1, true), e)"), "");
  EXPECT_EQ(
      sandbox.failure_of(
          "local once local f = load(function() if not once then once = 1 return '\\27Lua' end end) assert(not f)"),
      "");
  EXPECT_EQ(sandbox.failure_of("assert(loadstring('return 1 + 1')() == 2)"), "");
}

TEST(Sandbox, RunsLibraryFunctionsOnlyOnWhatTheyAreFor) {
  BareSandbox sandbox;
  EXPECT_NE(sandbox.failure_of("setmetatable('', {})"), "");
  EXPECT_NE(sandbox.failure_of("table.insert(1, 2)"), "");
}

TEST(Sandbox, SaysFileAndLineOfEveryError) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("\n\nlocal x = nil + 1"), "test.lua:3: attempt to perform arithmetic on a nil value");
  EXPECT_EQ(sandbox.failure_of("error('broken')"), "test.lua:1: broken");
  EXPECT_EQ(sandbox.failure_of("\nerror('broken', 0)"), "test.lua:2: broken");
  EXPECT_EQ(sandbox.failure_of("\nerror({})"), "test.lua:2: the script raised an error that is a table, not a text");
  EXPECT_EQ(sandbox.failure_of("x = = 1"), "test.lua:1: unexpected symbol near '='");
}

TEST(Sandbox, CallsTheHandlerOfXpcall) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("local ok, text = xpcall(function() error('x', 0) end, function(e) return e .. '!' end) "
                               "assert(ok == false and text == 'x!')"),
            "");
  EXPECT_EQ(
      sandbox.failure_of("local ok, a, b = xpcall(function() return 1, 2 end, print) assert(ok and a == 1 and b == 2)"),
      "");
}

int lack_a_library(lua_State*) {
  fail(ErrorKind::io, "a library is not installed");
}

TEST(Sandbox, TellsWhatTheSystemLacksFromWhatTheScriptDoesWrong) {
  BareSandbox sandbox;
  set_global<lack_a_library, Charge::call>(sandbox.lua(), "lack");
  const auto kind_of = [&](const std::string& text) {
    EXPECT_FALSE(sandbox.load(sandbox.lua(), "test.lua", text));
    const auto failure = sandbox.call(sandbox.lua(), 0, 0);
    EXPECT_TRUE(failure);
    return failure ? failure->kind : ErrorKind::usage;
  };
  EXPECT_EQ(kind_of("error('mine')"), ErrorKind::input);
  EXPECT_EQ(kind_of("lack()"), ErrorKind::io);
  EXPECT_EQ(kind_of("local ok, why = pcall(lack) error('a part: ' .. why)"), ErrorKind::io);
  EXPECT_EQ(kind_of("pcall(lack) error('mine')"), ErrorKind::input);
}

TEST(Sandbox, SuggestsTheGlobalThatWasMeant) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("prnt(1)"),
            "test.lua:1: attempt to call global 'prnt' (a nil value); did you mean 'print'?");
}

TEST(Sandbox, LeavesTheStackAsItWas) {
  BareSandbox sandbox;
  const int top = lua_gettop(sandbox.lua());
  sandbox.failure_of("x = 1");
  sandbox.failure_of("error('broken')");
  sandbox.failure_of("x = = 1");
  EXPECT_EQ(lua_gettop(sandbox.lua()), top);
}

}  // namespace
}  // namespace verisim::script::sandbox_test

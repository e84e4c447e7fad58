// Files that a scenario may use, and those that it may not.
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::file_words_test {
namespace {

TEST(Files, OutsideTheScenariosFolderCannotBeReached) {
  for (const char* name : {"/etc/passwd", "../secret.lua", "sub/../../secret.lua", "link.lua", "linked/secret.lua"}) {
    WrittenScenario written(std::string("dofile('") + name + "')");
    const std::filesystem::path outside = written.folder().string() + "_outside";
    std::filesystem::create_directories(outside);
    std::ofstream(outside / "secret.lua") << "x = 1";
    std::filesystem::create_symlink(outside / "secret.lua", written.folder() / "link.lua");
    std::filesystem::create_directory_symlink(outside, written.folder() / "linked");
    const std::string refusal = written.refusal();
    std::filesystem::remove_all(outside);
    EXPECT_NE(refusal.find("lies outside the scenario's folder"), std::string::npos) << name << ": " << refusal;
    EXPECT_EQ(refusal.rfind("pin.lua:1: ", 0), 0u) << refusal;
  }
}

TEST(Files, OutsideCannotBeReachedByAnyWord) {
  for (const char* word :
       {"addObject{ Model '../secret.stl' }", "modelParts('/etc/passwd.stl')", "runfile('../secret')",
        "require '...secret'", "Devices.Replay{ trace = '../hand.csv' }", "runbuf:addFile('/etc/passwd')",
        "vrjLua.appendToModelSearchPath('/etc') dofile(vrjLua.findInModelSearchPath('passwd'))"})
    EXPECT_NE(refusal_of(word), "") << word;
}

TEST(Files, ThatTheCommandLineNamesMayBeRead) {
  WrittenScenario written("");
  const std::filesystem::path outside = written.folder().string() + "_named";
  std::filesystem::create_directories(outside);
  std::ofstream(outside / "more.lua") << "x = 1";
  written.write("pin.lua", "dofile('" + (outside / "more.lua").string() + "') assert(x == 1)");
  written.allowed = {outside.string()};
  EXPECT_EQ(written.refusal(), "");
  std::filesystem::remove_all(outside);
}

TEST(Require, RunsAModuleOfTheFolderOnce) {
  WrittenScenario written(
      "count = 0 local a, b = require 'lib.parts', require 'lib.parts' assert(a == b and a.x == 1 and count == 1)");
  written.write("lib/parts.lua", "count = count + 1 return {x = 1}");
  EXPECT_EQ(written.refusal(), "");
  EXPECT_NE(refusal_of("require 'socket'").find("there is no module 'socket'"), std::string::npos);
}

TEST(SearchPath, FindsFilesBesideTheScriptThatAsks) {
  WrittenScenario written("dofile('sub/load.lua')");
  written.write("sub/load.lua", R"(
    require("getScriptFilename")
    assert(getScriptFilename() == "sub/load.lua")
    vrjLua.appendToModelSearchPath(getScriptFilename())
    assert(vrjLua.findInModelSearchPath("part.lua") == "sub/part.lua")
    require "AddAppDirectory"
    AddAppDirectory(true)
    assert(vrjLua.getModelSearchPath() == "sub")
    assert(runfile("part") == 7)
    assert(dofile(vrjLua.findInModelSearchPath([[part.lua]])) == 7))");
  written.write("sub/part.lua", "return 7");
  EXPECT_EQ(written.refusal(), "");
}

TEST(Runfile, SaysWhatItCouldNotFind) {
  EXPECT_EQ(refusal_of("runfile('gone')"), "pin.lua:1: Could not find gone in model search path to run!");
}

TEST(Errors, NameTheFileTheyHappenIn) {
  WrittenScenario written("dofile('parts.lua')");
  written.write("parts.lua", "\n\nlocal x = nil + 1");
  EXPECT_EQ(written.refusal(), "parts.lua:3: attempt to perform arithmetic on a nil value");
  written.write("parts.lua", "\nx = = 1");
  EXPECT_EQ(written.refusal(), "parts.lua:2: unexpected symbol near '='");
}

}  // namespace
}  // namespace verisim::file_words_test

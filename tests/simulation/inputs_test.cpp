#include "engine/simulation/inputs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/base/error.hpp"
#include "tests/support/folder.hpp"

namespace verisim::inputs_test {
namespace {

namespace fs = std::filesystem;

/// A folder with a file, beside a file that is not in it, and a link that leads out.
class InputsTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(top_ / "scene");
    std::ofstream(top_ / "scene" / "inside.txt") << "inside";
    std::ofstream(top_ / "outside.txt") << "outside";
    fs::create_symlink(top_ / "outside.txt", top_ / "scene" / "link.txt");
  }
  const test::Folder folder_;
  const fs::path top_ = folder_.path() / "with a blank";
};

TEST_F(InputsTest, ReadsWithinItsFolderAndRemembersWhatItRead) {
  Inputs inputs = Inputs::live(top_ / "scene", {});
  EXPECT_EQ(inputs.read("inside.txt"), "inside");
  ASSERT_EQ(inputs.files().size(), 1U);
  EXPECT_EQ(inputs.files()[0].name, "inside.txt");
  EXPECT_EQ(inputs.files()[0].content, "inside");
}

TEST_F(InputsTest, RefusesWhatLiesOutside) {
  Inputs inputs = Inputs::live(top_ / "scene", {});
  for (const std::string& name : {std::string("../outside.txt"), (top_ / "outside.txt").string(),
                                  std::string("link.txt"), std::string("../scene/../outside.txt")}) {
    EXPECT_THROW((void)inputs.read(name), Error) << name;
    EXPECT_FALSE(inputs.exists(name)) << name;
  }
}

TEST_F(InputsTest, ReadsOutsideWhatTheCommandLineNamed) {
  Inputs inputs = Inputs::live(top_ / "scene", {(top_ / "outside.txt").string()});
  EXPECT_EQ(inputs.read((top_ / "outside.txt").string()), "outside");
}

TEST_F(InputsTest, FindsARelativeNameOfTheCommandLineWhereTheUserStands) {
  const fs::path before = fs::current_path();
  fs::current_path(top_);
  Inputs inputs = Inputs::live(top_ / "scene", {"outside.txt"});
  EXPECT_EQ(inputs.read("outside.txt"), "outside");
  EXPECT_EQ(inputs.read("inside.txt"), "inside");
  fs::current_path(before);
}

TEST_F(InputsTest, AFolderWhoseNameBeginsAlikeIsOutside) {
  fs::create_directories(top_ / "scene2");
  std::ofstream(top_ / "scene2" / "x.txt") << "x";
  Inputs inputs = Inputs::live(top_ / "scene", {});
  EXPECT_THROW((void)inputs.read("../scene2/x.txt"), Error);
}

TEST_F(InputsTest, SaysWhatIsWrongWithAName) {
  Inputs inputs = Inputs::live(top_ / "scene", {});
  EXPECT_THROW((void)inputs.read("missing.txt"), Error);
  EXPECT_THROW((void)inputs.read("."), Error);
}

TEST_F(InputsTest, StoredInputsServeOnlyWhatTheyHold) {
  Inputs stored = Inputs::stored({{"a.lua", "", "content", true}}, {});
  EXPECT_EQ(stored.read("a.lua"), "content");
  EXPECT_TRUE(stored.exists("a.lua"));
  EXPECT_FALSE(stored.exists("inside.txt"));
  EXPECT_THROW((void)stored.read("inside.txt"), Error);
}

}  // namespace
}  // namespace verisim::inputs_test

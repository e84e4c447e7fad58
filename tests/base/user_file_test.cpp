#include "engine/base/user_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "engine/base/error.hpp"
#include "tests/support/folder.hpp"

namespace verisim::user_file_test {
namespace {

namespace fs = std::filesystem;

class UserFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string written(const std::string& name, const std::string& content) const {
    std::ofstream(path(name)) << content;
    return path(name);
  }

 private:
  test::Folder folder_;
};

std::string refusal(const std::string& path) {
  try {
    const UserFile file("thing", path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "opened";
}

TEST_F(UserFileTest, GivesAPlainFilesContentAndBeginning) {
  const UserFile file("thing", written("a", "0123456789"));
  EXPECT_EQ(file.size(), 10u);
  EXPECT_EQ(file.content(), "0123456789");
  EXPECT_EQ(file.content(10), "0123456789");
  EXPECT_THROW((void)file.content(9), Error);
  EXPECT_EQ(file.beginning(3), "012");
  EXPECT_EQ(file.beginning(100), "0123456789");
}

TEST_F(UserFileTest, ReadsWhatHasNoSizeUpToItsEnd) {
  const UserFile file("thing", "/proc/self/status");
  EXPECT_EQ(file.size(), 0u);
  EXPECT_NE(file.content().find("VmRSS"), std::string::npos);
  EXPECT_THROW((void)file.content(10), Error);
}

// A FIFO without a writer would make open() wait for ever.
TEST_F(UserFileTest, NamesWhatIsNoPlainFileAndDoesNotWaitForIt) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  fs::create_symlink("fifo", path("link"));
  for (const auto& [name, type] : {std::pair{"fifo", "a FIFO"}, {"link", "a FIFO"}, {".", "a folder"}}) {
    EXPECT_EQ(other_than_plain(path(name)), type);
    EXPECT_NE(refusal(path(name)).find(std::string("thing: is ") + type), std::string::npos);
  }
  EXPECT_EQ(other_than_plain("/dev/zero"), "a device");
  EXPECT_NE(refusal("/dev/zero").find("thing: is a device"), std::string::npos);
  EXPECT_EQ(other_than_plain(path("none")), "");
  EXPECT_NE(refusal(path("none")).find("No such file"), std::string::npos);
}

TEST_F(UserFileTest, OneFileHasOneIdentityUnderAllItsNames) {
  const std::string one = written("one", "x");
  const std::string other = written("other", "x");
  fs::create_hard_link(one, path("hard"));
  fs::create_symlink("one", path("soft"));
  EXPECT_EQ(identity_of(path("hard")), identity_of(one));
  EXPECT_EQ(identity_of(path("soft")), identity_of(one));
  EXPECT_EQ(UserFile("thing", path("soft")).identity(), identity_of(one));
  EXPECT_NE(identity_of(other), identity_of(one));
  EXPECT_EQ(identity_of(path("none")), std::nullopt);
}

TEST_F(UserFileTest, CountsWhatIsStoredAndNotTheHoles) {
  const std::string full = written("full", std::string(1 << 20, 'x'));
  EXPECT_EQ(UserFile("thing", full).stored_bytes(), 1u << 20);
  fs::resize_file(full, std::uint64_t{1} << 40);
  EXPECT_LE(UserFile("thing", full).stored_bytes(), 2u << 20);
  EXPECT_THROW((void)UserFile("thing", full).content(), Error);
}

}  // namespace
}  // namespace verisim::user_file_test

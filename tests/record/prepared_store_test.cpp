// The folder of prepared parts: what was kept comes back, and nothing else ever does.
#include "engine/record/prepared_store.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/folder.hpp"

namespace verisim::prepared_store_test {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void write(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

class Store : public testing::Test {
 protected:
  PreparedStore store(const std::string& version = "1") { return {folder_.file("store"), version}; }
  fs::path only_entry() { return *fs::directory_iterator(folder_.path() / "store"); }
  test::Folder folder_;
};

TEST_F(Store, GivesBackWhatWasKept) {
  PreparedStore first = store();
  EXPECT_FALSE(first.find("voxels", "key"));
  const std::string content("a\0b", 3);
  first.keep("voxels", "key", content);
  first.keep("voxels", "empty", "");
  PreparedStore second = store();
  EXPECT_EQ(second.find("voxels", "key"), content);
  EXPECT_EQ(second.find("voxels", "empty"), "");
  EXPECT_FALSE(second.find("voxels", "another key"));
  EXPECT_FALSE(second.find("parts", "key"));
  EXPECT_FALSE(store("2").find("voxels", "key")) << "another version's";
  EXPECT_EQ(PreparedStore::size_of(second.folder()).entries, 2U);
  EXPECT_EQ(PreparedStore::size_of(folder_.file("none")).entries, 0U);
  EXPECT_EQ(second.found(), 2U);
  EXPECT_EQ(second.damaged(), 0U);
}

TEST_F(Store, IsItsOwnersAlone) {
  store().keep("voxels", "key", "content");
  struct stat info {};
  ASSERT_EQ(::stat((folder_.path() / "store").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0700U);
  ASSERT_EQ(::stat(only_entry().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600U);
}

// Every byte changed, every length cut, bytes added: never another content.
TEST_F(Store, TakesNoEntryThatIsNotWhatWasWritten) {
  const std::string content = "what the CAD kernel said";
  store().keep("parts", "key", content);
  const fs::path path = only_entry();
  const std::string whole = content_of(path);
  std::vector<std::string> damaged;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    damaged.push_back(whole);
    damaged.back()[i] = static_cast<char>(damaged.back()[i] ^ (1 << (i % 8)));
    damaged.push_back(whole.substr(0, i));
  }
  damaged.push_back(whole + "x");
  damaged.push_back(whole + whole);
  for (const std::string& bytes : damaged) {
    write(path, bytes);
    PreparedStore now = store();
    EXPECT_FALSE(now.find("parts", "key"));
    EXPECT_EQ(now.damaged(), 1U);
    now.keep("parts", "key", content);
    EXPECT_EQ(now.find("parts", "key"), content) << "and is made anew";
  }
}

TEST_F(Store, TakesNoEntryUnderAnothersName) {
  store().keep("parts", "one", "content of one");
  const std::string one = content_of(only_entry());
  fs::remove(only_entry());
  store().keep("parts", "two", "content of two");
  write(only_entry(), one);
  PreparedStore now = store();
  EXPECT_FALSE(now.find("parts", "two"));
  EXPECT_EQ(now.damaged(), 1U);
}

TEST_F(Store, KeepsNothingWhereItCannotWriteAndFailsAtNothing) {
  write(folder_.path() / "file", "");
  for (const std::string folder : {"file", "file/below", "/proc/none"}) {
    PreparedStore none(folder.front() == '/' ? folder : folder_.file(folder), "1");
    none.keep("parts", "key", "content");
    EXPECT_EQ(none.kept(), 0U) << folder;
    EXPECT_FALSE(none.find("parts", "key")) << folder;
  }
  PreparedStore odd(folder_.file("\n/\x01"), "1");
  odd.keep("parts", "key", "content");
  EXPECT_EQ(odd.find("parts", "key"), "content") << "an odd name is as good as any";
  fs::create_directories(folder_.path() / "store");
  store().keep("parts", "key", "content");
  const fs::path path = only_entry();
  fs::remove(path);
  fs::create_directory(path);  // a folder in an entry's place
  PreparedStore now = store();
  EXPECT_FALSE(now.find("parts", "key"));
  now.keep("parts", "key", "content");
  EXPECT_FALSE(now.find("parts", "key"));
}

TEST_F(Store, LetsGoOfWhatWasUsedLongestAgo) {
  PreparedStore small(folder_.file("store"), "1", 5000);
  const std::string content(1000, 'x');
  const auto age = [&](const std::string& key, int hours) {
    for (const auto& entry : fs::directory_iterator(folder_.path() / "store"))
      if (entry.path().string().find(key) != std::string::npos)
        fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (const std::string kind : {"a", "b", "c", "d"}) {
    small.keep(kind, "key", content);
    age("/" + kind + "-", 'z' - kind[0]);
  }
  EXPECT_TRUE(small.find("a", "key")) << "the oldest: it has been used now";
  small.keep("e", "key", content);
  EXPECT_TRUE(small.find("a", "key"));
  EXPECT_FALSE(small.find("b", "key"));
  EXPECT_TRUE(small.find("e", "key"));
  small.keep("large", "key", std::string(2000, 'x'));
  EXPECT_FALSE(small.find("large", "key")) << "more than a quarter";
}

TEST_F(Store, OfTwoThatKeepAtOnceEachKeepsTheLimitButForWhatTheOtherKeeps) {
  const std::uint64_t limit = 20'000;
  PreparedStore first(folder_.file("store"), "1", limit), second(folder_.file("store"), "1", limit);
  const std::string content(1000, 'x');
  for (int i = 0; i < 200; ++i) {
    (i % 3 == 0 ? first : second).keep("parts", std::to_string(i), content);
    EXPECT_LE(PreparedStore::size_of(folder_.file("store")).bytes, 2 * limit) << i;
  }
  PreparedStore third(folder_.file("store"), "1", limit);
  third.keep("parts", "last", content);
  EXPECT_LE(PreparedStore::size_of(folder_.file("store")).bytes, limit);
}

// What one process keeps is found by counting, not by looking through the folder each time: files that another process
// adds are not seen until the limit may be passed.
TEST_F(Store, IsLookedThroughOnceWhileItHasRoom) {
  PreparedStore mine(folder_.file("store"), "1", 100'000);
  mine.keep("parts", "first", "content");
  const fs::path other = folder_.path() / "store" / "parts-other.prepared";
  write(other, std::string(99'000, 'x'));
  fs::last_write_time(other, fs::file_time_type::clock::now() - std::chrono::hours(1));
  const std::string content(2000, 'x');
  for (int i = 0; i < 40; ++i) mine.keep("parts", std::to_string(i), content);
  EXPECT_TRUE(fs::exists(other));
  for (int i = 40; i < 60; ++i) mine.keep("parts", std::to_string(i), content);
  EXPECT_FALSE(fs::exists(other));
}

// Readers and writers of one folder at once, some of them killed: what is found is whole.
TEST_F(Store, IsSafeBetweenProcesses) {
  constexpr int kKeys = 20;
  const auto content = [](int key) {
    return std::string(static_cast<std::size_t>(1000 * key), static_cast<char>('a' + key));
  };
  std::vector<pid_t> children;
  for (int child = 0; child < 4; ++child) {
    const pid_t pid = fork();
    ASSERT_GE(pid, 0);
    if (pid == 0) {
      bool right = true;
      PreparedStore mine = store();
      for (int round = 0; round < 50; ++round) {
        for (int key = 0; key < kKeys; ++key) {
          const std::string name = std::to_string(key);
          const auto found = mine.find("parts", name);
          right = right && (!found || *found == content(key));
          if (!found || (round + key + child) % 7 == 0) mine.keep("parts", name, content(key));
        }
      }
      _exit(right && mine.damaged() == 0 ? 0 : 1);
    }
    children.push_back(pid);
  }
  kill(children.back(), SIGKILL);
  for (std::size_t i = 0; i + 1 < children.size(); ++i) {
    int status = 0;
    ASSERT_EQ(waitpid(children[i], &status, 0), children[i]);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  waitpid(children.back(), nullptr, 0);
  PreparedStore after = store();
  for (int key = 0; key < kKeys; ++key) EXPECT_EQ(after.find("parts", std::to_string(key)), content(key));
}

}  // namespace
}  // namespace verisim::prepared_store_test

// The loop's side of recording: what it promises about memory, waiting, errors and files left behind.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/time.h>

#include <array>
#include <atomic>
#include <csignal>
#include <memory>
#include <thread>

#include "engine/base/error.hpp"
#include "tests/record/counted_new.hpp"
#include "tests/record/small_run.hpp"

/// HDF5 dates objects that it makes by itself, and has no option to leave that out: in this program the calendar stands
/// still, so that bytes can be compared.
extern "C" int gettimeofday(timeval* out, void* /*zone*/) noexcept {
  *out = {};
  return 0;
}

namespace verisim::recorder_test {
namespace {

using namespace small_run;

// DESIGN rule 3. The ring is filled several times over, so that the loop also has had to wait.
TEST(Recorder, AllocatesNothingInTheLoop) {
  const Folder folder;
  for (const bool paced : {false, true}) {
    Recorder recorder(folder.file("run.h5"), schema(), header(), {.paced = paced, .ring_rows = paced ? 8192u : 0u});
    record(recorder, 0, 1);
    const std::size_t before = allocations();
    for (std::uint64_t i = 1; i < 3000; ++i) {
      record_frame(recorder, i);
      recorder.event(0.001 * static_cast<double>(i), "contact", "pin on block");
    }
    EXPECT_EQ(allocations() - before, 0u);
    recorder.close({}, {});
  }
}

TEST(Recorder, WrapsItsRingWithoutLosingARow) {
  const Folder folder;
  // 37 divides neither the rows nor what is flushed at once.
  Recorder recorder(folder.file("run.h5"), schema(), header(),
                    {.paced = false, .frames_unflushed = 30, .ring_rows = 37});
  record(recorder, 0, 5000);
  recorder.close({}, {});
  const RunFile run(folder.file("run.h5"));
  EXPECT_EQ(run.rows(), 5000u);
  EXPECT_EQ(first_wrong_row(run), 5000u);
}

TEST(Recorder, WorksWithNothingUnsafeAtAll) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {.paced = false, .frames_unflushed = 1});
  record(recorder, 0, 40);
  recorder.close({}, {});
  EXPECT_EQ(RunFile(folder.file("run.h5")).rows(), 40u);
}

TEST(Recorder, GivesRowsThatAreZero) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {.paced = false, .frames_unflushed = 4, .ring_rows = 4});
  for (int i = 0; i < 20; ++i) {
    const std::span<std::byte> row = recorder.begin_row();
    ASSERT_EQ(row.size(), schema().row_bytes());
    for (std::byte& b : row) {
      ASSERT_EQ(b, std::byte{0});
      b = std::byte{0xff};
    }
    recorder.end_row();
  }
}

// A frame may have more links than the table's ring had room for at the start; the ring wraps, grows and wraps again.
TEST(Recorder, MakesRoomForEveryNumberOfLinks) {
  const Folder folder;
  Schema s = schema();
  Recorder recorder(folder.file("run.h5"), s, header(), {.frames_unflushed = 7, .ring_rows = 7, .table_rows = 1});
  const std::size_t row_bytes = s.table_row_bytes();
  std::vector<std::byte> expected;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const std::size_t count = i % 50 == 49 ? 40 * i : i % 11;
    recorder.make_room(count);
    std::vector<std::byte> rows(count * row_bytes);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::byte>(k * 31 + i);
    const std::span<std::byte> row = recorder.begin_row();
    const auto links = static_cast<std::uint32_t>(count);
    for (const Column& c : s.columns())
      if (c.path == "/cost/links") std::memcpy(row.data() + c.offset, &links, sizeof links);
    recorder.add_table_rows(rows);
    recorder.end_row();
    expected.insert(expected.end(), rows.begin(), rows.end());
  }
  recorder.close({}, {});
  const RunFile run(folder.file("run.h5"));
  ASSERT_EQ(run.rows(), 200U);
  for (const Column& c : run.schema().table()) {
    const std::vector<std::byte> values = run.column(c);
    ASSERT_EQ(values.size() * row_bytes, expected.size() * c.bytes());
    for (std::size_t k = 0; k * row_bytes < expected.size(); ++k)
      ASSERT_EQ(std::memcmp(&values[k * c.bytes()], &expected[k * row_bytes + c.offset], c.bytes()), 0) << c.path << k;
  }
}

// INTERFACES section 2: paced, the loop never waits; when the file cannot keep up, that is an error, not a stall.
TEST(Recorder, PacedSaysThatTheDiskIsTooSlow) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {.paced = true, .ring_rows = 16, .table_rows = 64});
  const Error e = error_of([&] { record(recorder, 0, 100'000); });
  EXPECT_EQ(e.kind(), ErrorKind::io);
  EXPECT_NE(std::string(e.what()).find("16 frames behind"), std::string::npos) << e.what();
}

TEST(Recorder, KeepsEveryEventWhenFreeRunning) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {});
  for (int i = 0; i < 5000; ++i) recorder.event(i, "tick", std::to_string(i));
  recorder.close({}, {});
  const std::vector<Event> events = RunFile(folder.file("run.h5")).events();
  ASSERT_EQ(events.size(), 5000u);
  EXPECT_EQ(events[4321].text, "4321");
}

TEST(Recorder, PacedCountsTheEventsThatItLoses) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {.paced = true});
  for (int i = 0; i < 100'000; ++i) recorder.event(i, "tick", "");
  recorder.close({}, {});
  const std::vector<Event> events = RunFile(folder.file("run.h5")).events();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().kind, "events lost");
  EXPECT_EQ(std::stoul(events.back().text) + events.size() - 1, 100'000u);
}

TEST(Recorder, CutsLongEventsBetweenCharacters) {
  const Folder folder;
  Recorder recorder(folder.file("run.h5"), schema(), header(), {});
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "ä";
  recorder.event(1, "a kind of more than thirty-one letters", umlauts);
  recorder.close({}, {});
  const Event e = RunFile(folder.file("run.h5")).events().at(0);
  EXPECT_EQ(e.kind, "a kind of more than thirty-one ");
  EXPECT_EQ(e.text, umlauts.substr(0, 222));
}

TEST(Recorder, HasNoFileOfThatNameBeforeARowIsSafe) {
  const Folder folder;
  write_content(folder.file("run.h5"), "the former run");
  {
    Recorder recorder(folder.file("run.h5"), schema(), header(), {});
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(content_of(folder.file("run.h5")), "the former run");
  }
  EXPECT_EQ(content_of(folder.file("run.h5")), "the former run");
  EXPECT_EQ(folder.files(), 1u);  // and no leftover
}

TEST(Recorder, LeavesOneFileBehind) {
  const Folder folder;
  write_content(folder.file("run.h5.part"), "left by a killed run");
  write_content(folder.file("run.h5.closing"), "left by a killed run");
  write(folder.file("run.h5"), 10);
  EXPECT_EQ(folder.files(), 1u);
  EXPECT_EQ(RunFile(folder.file("run.h5")).rows(), 10u);
}

TEST(Recorder, KeepsTheRowsOfARunThatEndsInAnException) {
  const Folder folder;
  try {
    Recorder recorder(folder.file("run.h5"), schema(), header(), {});
    record(recorder, 0, 77);
    throw std::runtime_error("diverged");
  } catch (const std::runtime_error&) {
  }
  const RunFile run(folder.file("run.h5"));
  EXPECT_EQ(run.rows(), 77u);
  EXPECT_EQ(first_wrong_row(run), 77u);
  EXPECT_TRUE(run.summary().empty());
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Recorder, RefusesAPlaceThatCannotBeWritten) {
  const Folder folder;
  write_content(folder.file("plain"), "a file, not a folder");
  for (const std::string& path : {folder.file("plain/run.h5"), folder.file("no/such/folder/run.h5"), folder.file("")}) {
    const Error e = error_of([&] { Recorder recorder(path, schema(), header(), {}); });
    EXPECT_EQ(e.kind(), ErrorKind::io) << e.what();
    EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
  }
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Recorder, RefusesAFileThatAnotherRunIsWriting) {
  const Folder folder;
  Recorder first(folder.file("run.h5"), schema(), header(), {});
  EXPECT_EQ(error_of([&] { Recorder second(folder.file("run.h5"), schema(), header(), {}); }).kind(), ErrorKind::io);
  record(first, 0, 60);
  EXPECT_EQ(error_of([&] { Recorder second(folder.file("run.h5"), schema(), header(), {}); }).kind(), ErrorKind::io);
  first.close({}, {});
  EXPECT_EQ(RunFile(folder.file("run.h5")).rows(), 60u);
}

// The file of a run gets its own name while it is written: there is no moment between the two names.
TEST(Recorder, RefusesASecondRunAtEveryMomentOfTheFirst) {
  const Folder folder;
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const std::string path = folder.file("run_" + std::to_string(trial) + ".h5");
    Recorder first(path, schema(), header(), {.paced = false, .frames_unflushed = 2});
    std::atomic<bool> done{false};
    std::thread loop([&] {
      record(first, 0, 10);
      done = true;
    });
    do {
      EXPECT_EQ(error_of([&] { Recorder second(path, schema(), header(), {}); }).kind(), ErrorKind::io);
    } while (!done);
    loop.join();
    first.close({}, {});
    EXPECT_EQ(RunFile(path).rows(), 10u);
  }
}

TEST(Recorder, GivesAFileToOneOfTwoRunsThatStartAtOnce) {
  const Folder folder;
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    std::array<std::unique_ptr<Recorder>, 2> runs;
    std::atomic<int> ready{0};
    const auto start = [&](std::unique_ptr<Recorder>& run) {
      ++ready;
      while (ready < 2) std::this_thread::yield();
      try {
        run = std::make_unique<Recorder>(folder.file("run.h5"), schema(), header(), RecorderOptions{});
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("another run"), std::string::npos) << e.what();
      }
    };
    std::thread other([&] { start(runs[1]); });
    start(runs[0]);
    other.join();
    ASSERT_NE(runs[0] == nullptr, runs[1] == nullptr);
    Recorder& winner = *(runs[0] ? runs[0] : runs[1]);
    record(winner, 0, 10);
    winner.close({}, {});
    EXPECT_EQ(RunFile(folder.file("run.h5")).rows(), 10u);
    EXPECT_EQ(folder.files(), 1u);
  }
}

/// No file of this process may grow beyond `bytes`, as on a full disk, until the end of the scope.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*signal_)(int);
};

// The frames that were safe before the disk was full are still there, and nothing else is.
TEST(Recorder, TellsTheLoopThatTheDiskIsFull) {
  const Folder folder;
  ::testing::internal::CaptureStderr();
  Error e(ErrorKind::check_failed, "");
  {
    const FileSizeLimit limit(1'000'000);
    Recorder recorder(folder.file("run.h5"), schema(), header(), {});
    e = error_of([&] { record(recorder, 0, 100'000); });
    EXPECT_EQ(error_of([&] { static_cast<void>(recorder.begin_row()); }).kind(), ErrorKind::io);
    EXPECT_EQ(error_of([&] { recorder.close({}, {}); }).kind(), ErrorKind::io);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // HDF5's own complaints
  EXPECT_EQ(e.kind(), ErrorKind::io);
  EXPECT_NE(std::string(e.what()).find("File too large"), std::string::npos) << e.what();
  EXPECT_EQ(folder.files(), 1u);
  const RunFile run(folder.file("run.h5"));
  EXPECT_GT(run.rows(), 500u);
  EXPECT_EQ(first_wrong_row(run), run.rows());
  EXPECT_FALSE(run.recovered());  // it could even be closed
}

/// A file system of its own in a folder, until the end of the scope; not there if this process may not mount.
class SmallDisk {
 public:
  SmallDisk(const std::string& folder, const std::string& size) : folder_(folder) {
    std::filesystem::create_directory(folder);
    mounted_ = ::mount("none", folder.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount(folder_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }

 private:
  std::string folder_;
  bool mounted_ = false;
};

TEST(Recorder, KeepsWhatWasSafeOnADiskThatIsReallyFull) {
  const Folder folder;
  const SmallDisk disk(folder.file("disk"), "2m");
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small tmpfs here: a full disk was not tried";
  const Error e = error_of([&] {
    Recorder recorder(folder.file("disk/run.h5"), schema(), header(), {});
    record(recorder, 0, 1'000'000);
  });
  EXPECT_EQ(e.kind(), ErrorKind::io);
  EXPECT_NE(std::string(e.what()).find("No space left"), std::string::npos) << e.what();
  const RunFile run(folder.file("disk/run.h5"));
  EXPECT_GT(run.rows(), 5000u);
  EXPECT_EQ(first_wrong_row(run), run.rows());
}

// Closing needs room for a copy. Without it the frames stay readable; only /summary is missing.
TEST(Recorder, KeepsEveryRowWhenThereIsNoRoomToClose) {
  const Folder folder;
  const SmallDisk disk(folder.file("disk"), "8m");
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small tmpfs here: a full disk was not tried";
  {
    Recorder recorder(folder.file("disk/run.h5"), schema(), header(), {});
    record(recorder, 0, 25'000);  // more than half of the disk
    EXPECT_EQ(error_of([&] { recorder.close({}, {}); }).kind(), ErrorKind::io);
  }
  const RunFile run(folder.file("disk/run.h5"));
  EXPECT_FALSE(run.recovered());
  EXPECT_EQ(run.rows(), 25'000u);
  EXPECT_EQ(first_wrong_row(run), 25'000u);
  EXPECT_FALSE(std::filesystem::exists(folder.file("disk/run.h5.closing")));
}

TEST(Recorder, SaysAtOnceThatTheDiskWasFullFromTheStart) {
  const Folder folder;
  {
    const FileSizeLimit limit(100);
    EXPECT_EQ(error_of([&] { Recorder recorder(folder.file("run.h5"), schema(), header(), {}); }).kind(),
              ErrorKind::io);
  }
  EXPECT_EQ(folder.files(), 0u);
}

// INTERFACES section 2: two runs of the same input differ in nothing.
// A loop that naps and one that does not: where the file has its chunks must not hang on who was faster.
TEST(Recorder, WritesTheSameBytesHoweverFastTheLoopIs) {
  const Folder folder;
  const auto write_with_naps = [&](const std::string& name, std::uint64_t every) {
    Recorder recorder(folder.file(name), schema(), header(), {});
    for (std::uint64_t i = 0; i < 333; ++i) {
      if (every > 0 && i % every == every - 1) std::this_thread::sleep_for(std::chrono::milliseconds(3));
      if (i % 40 == 7) recorder.event(0.001 * static_cast<double>(i), "contact", "pin on block");
      record_frame(recorder, i);
    }
    recorder.close({}, {});
    return content_of(folder.file(name));
  };
  const std::string at_once = write_with_naps("at_once.h5", 0);
  for (const std::uint64_t every : {1, 2, 7, 30, 51, 100})
    EXPECT_TRUE(write_with_naps("naps.h5", every) == at_once) << "a nap every " << every << " rows";
}

TEST(Recorder, WritesTheSameBytesForTheSameRun) {
  const Folder folder;
  RunHeader head = header();
  head.files = {{"pin.lua", "ab", "addObject{}", true}};
  write(folder.file("a.h5"), 50, head);
  write(folder.file("b.h5"), 50, head);
  EXPECT_EQ(content_of(folder.file("a.h5")).size(), content_of(folder.file("b.h5")).size());
  EXPECT_TRUE(content_of(folder.file("a.h5")) == content_of(folder.file("b.h5")));
  EXPECT_EQ(objects_with_times(content_of(folder.file("a.h5"))), 0u) << "in another second they would differ";
}

}  // namespace
}  // namespace verisim::recorder_test

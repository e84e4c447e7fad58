// INTERFACES section 2: a run that is killed at any moment leaves a file that h5py opens with swmr=True and that
// recover() closes; at most the last 100 frames are missing.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <thread>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/record/small_run.hpp"

namespace verisim::killed_run_test {
namespace {

using namespace small_run;
using std::chrono::microseconds;

/// Numbers that a child process shares with the test, and that outlive its kill.
struct Shared {
  std::atomic<std::uint64_t> rows{0};  ///< frames computed: begin_row was called
  std::atomic<bool> started{false};
};

class SharedMemory {
 public:
  SharedMemory()
      : shared_(new (::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))
                    Shared) {}
  ~SharedMemory() { ::munmap(shared_, sizeof(Shared)); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  Shared* operator->() const { return shared_; }
  Shared& operator*() const { return *shared_; }

 private:
  Shared* shared_;
};

/// Runs `work` in a child process and kills that `delay` after it set `started`.
template <typename Work>
void run_and_kill(Shared& shared, microseconds delay, Work work) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    try {
      work();
    } catch (...) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  while (!shared.started) std::this_thread::sleep_for(microseconds(50));
  std::this_thread::sleep_for(delay);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

void write_until_killed(const std::string& path, Shared& shared, bool paced) {
  Recorder recorder(path, schema(), header(), {.paced = paced});
  shared.started = true;
  for (std::uint64_t i = 0;; ++i) {
    shared.rows = i + 1;
    record_frame(recorder, i);
    if (paced) std::this_thread::sleep_for(microseconds(300));
  }
}

/// The rows that a plain h5py can read in each of the files, by its swmr=True; "" if there is no h5py here.
std::string rows_by_h5py(const Folder& folder, const std::string& files) {
  const std::string program =
      "import h5py, glob\n"
      "for name in sorted(glob.glob('" +
      folder.file(files) +
      "')):\n"
      "    with h5py.File(name, 'r', swmr=True) as f:\n"
      "        n = min(len(f['/state/time']), len(f['/state/body/pin/pose']), len(f['/timing/stage_ns']))\n"
      "        t, p = f['/state/time'][:n], f['/state/body/pin/pose'][:n]\n"
      "        assert f.attrs['format'] == 'verisim-run'\n"
      "        assert all(abs(t[i] - 0.001 * (i + 1)) < 1e-12 and p[i, 0] == i for i in range(n))\n"
      "        print(n, end=' ')\n";
  write_content(folder.file("read.py"), program);
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) return "";
  const std::string command = "/usr/bin/python3 " + folder.file("read.py") + " > " + folder.file("rows.txt") + " 2>&1";
  static_cast<void>(std::system(command.c_str()));
  return content_of(folder.file("rows.txt"));
}

/// One kill; the file, if there is one already, is recovered and holds all but the last 100 frames. Paced, these last
/// 30 ms here, for which the writer may not have been given the processor.
void check_one_kill(const Folder& folder, std::uint64_t trial, bool paced, microseconds delay) {
  const std::string path = folder.file("run.h5");
  const std::uint64_t missing_max = paced ? 200 : 100;
  std::filesystem::remove(path);
  const SharedMemory shared;
  run_and_kill(*shared, delay, [&] { write_until_killed(path, *shared, paced); });
  const std::uint64_t computed = shared->rows;
  if (!std::filesystem::exists(path)) {
    EXPECT_LE(computed, missing_max) << "no file although there were frames enough";
    return;
  }
  if (trial % 5 == 0) std::filesystem::copy_file(path, folder.file("kept_" + std::to_string(trial) + ".h5"));
  const RunFile run(path);
  EXPECT_TRUE(run.recovered());
  EXPECT_GE(run.rows() + missing_max, computed) << "killed after " << delay.count() << " us";
  EXPECT_EQ(first_wrong_row(run), run.rows()) << "killed after " << delay.count() << " us";
  EXPECT_TRUE(run.summary().empty());
  EXPECT_EQ(recover(path), std::nullopt);  // closed by now
}

TEST(KilledRun, KeepsAllButTheLastHundredFramesAtAHundredRandomMoments) {
  const Folder folder;
  const RandomStream random(7, "moments of kills");
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    check_one_kill(folder, trial, trial % 2 == 1, microseconds(random.bits(trial) % 40'000));
  }
  const std::string rows = rows_by_h5py(folder, "kept_*.h5");
  if (rows.empty()) GTEST_SKIP() << "no h5py at /usr/bin/python3: its reading of killed files was not tried";
  EXPECT_GE(std::count(rows.begin(), rows.end(), ' '), 10) << rows;  // some were killed before there was a file
  EXPECT_EQ(rows.find("Error"), std::string::npos) << rows;
}

/// Records 400 frames and closes the file. @return how long closing takes
microseconds close_after_400_frames(const std::string& path, const std::function<void()>& before_closing) {
  Recorder recorder(path, schema(), header(), {});
  record(recorder, 0, 400);
  before_closing();
  const auto begin = std::chrono::steady_clock::now();
  recorder.close({{"frames", std::int64_t{400}}}, {{"state_hash", std::string("00")}});
  return std::chrono::duration_cast<microseconds>(std::chrono::steady_clock::now() - begin);
}

// The moment of closing is another: the copy, its attributes, the renaming.
TEST(KilledRun, IsWholeWhenKilledWhileClosing) {
  const Folder folder;
  const auto usual = close_after_400_frames(folder.file("undisturbed.h5"), [] {});  // another on every machine
  const std::string path = folder.file("run.h5");
  const RandomStream random(8, "moments of kills");
  std::size_t finished = 0, unfinished = 0;
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    std::filesystem::remove(path);
    const SharedMemory shared;
    // From an eighth to eight times that: some come before its end and some after, though single times scatter.
    const double delay = static_cast<double>(usual.count()) * std::exp2(6 * random.uniform(trial) - 3);
    run_and_kill(*shared, microseconds(static_cast<std::int64_t>(delay)),
                 [&] { (void)close_after_400_frames(path, [&] { shared->started = true; }); });
    const RunFile run(path);
    EXPECT_GE(run.rows(), 300u);
    EXPECT_EQ(first_wrong_row(run), run.rows());
    EXPECT_TRUE(run.summary().empty() || run.rows() == 400);
    ++(run.summary().empty() ? unfinished : finished);
  }
  EXPECT_GT(finished, 0u);
  EXPECT_GT(unfinished, 0u) << "no kill came before the end of closing: this test would prove nothing";
}

TEST(KilledRun, IsNotRecoveredWhileItLives) {
  const Folder folder;
  const std::string path = folder.file("run.h5");
  Recorder recorder(path, schema(), header(), {});
  record(recorder, 0, 200);
  const std::string before = content_of(path).substr(0, 48);
  for (const auto& open : {+[](const std::string& p) { recover(p); }, +[](const std::string& p) { RunFile run(p); }}) {
    const Error e = error_of([&] { open(path); });
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find("still writing"), std::string::npos) << e.what();
  }
  EXPECT_EQ(folder.files(), 1u);
  record(recorder, 200, 500);
  recorder.close({}, {});
  EXPECT_EQ(RunFile(path).rows(), 500u);
}

TEST(KilledRun, SaysHowManyRowsItKeeps) {
  const Folder folder;
  const std::string path = folder.file("run.h5");
  const SharedMemory shared;
  run_and_kill(*shared, microseconds(20'000), [&] { write_until_killed(path, *shared, false); });
  const std::optional<std::size_t> rows = recover(path);
  ASSERT_TRUE(rows.has_value());
  EXPECT_GT(*rows, 0u);
  EXPECT_EQ(RunFile(path).rows(), *rows);
  EXPECT_FALSE(RunFile(path).recovered());
  EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace verisim::killed_run_test

#include "engine/batch/workers.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "engine/base/error.hpp"
#include "tests/length.hpp"

namespace verisim::batch::workers_test {
namespace {

using Work = std::function<std::string(std::uint64_t)>;

std::vector<WorkerEnd> all_of(std::uint64_t runs, unsigned jobs, const WorkerLimits& limits, const Work& work) {
  Workers workers(jobs, limits, work);
  std::vector<WorkerEnd> ended;
  std::uint64_t next = 0;
  while (ended.size() < runs) {
    for (; next < runs && workers.is_free(); ++next) workers.begin(next);
    for (WorkerEnd& end : workers.wait(10)) ended.push_back(std::move(end));
  }
  EXPECT_TRUE(workers.are_idle());
  return ended;
}

WorkerEnd one(const WorkerLimits& limits, const Work& work) {
  return all_of(1, 1, limits, work).front();
}

TEST(Workers, BringEveryAnswerOnce) {
  const auto ended = all_of(50, 4, {}, [](std::uint64_t run) { return std::string(run * 5000, 'x'); });
  std::vector<int> found(50, 0);
  for (const WorkerEnd& end : ended) {
    ++found[end.run];
    EXPECT_EQ(end.exit_code, 0);
    EXPECT_EQ(end.answer.size(), end.run * 5000);
  }
  EXPECT_EQ(found, std::vector<int>(50, 1));
}

TEST(Workers, ACrashIsTheEndOfOneOfThem) {
  const auto ended = all_of(4, 2, {}, [](std::uint64_t run) -> std::string {
    if (run == 1) std::raise(SIGKILL);
    if (run == 2) {
      std::fputs("the last words", stderr);
      std::signal(SIGABRT, SIG_DFL);
      std::abort();
    }
    return "fine";
  });
  for (const WorkerEnd& end : ended) {
    EXPECT_EQ(end.signal, end.run == 1 ? SIGKILL : end.run == 2 ? SIGABRT : 0);
    EXPECT_EQ(end.last_words, end.run == 2 ? "the last words" : "");
    EXPECT_EQ(end.answer, end.run == 0 || end.run == 3 ? "fine" : "");
  }
}

TEST(Workers, AHangEndsAtTheTimeLimit) {
  const WorkerEnd end = one({.time_s = 0.2}, [](std::uint64_t) -> std::string {
    for (;;) ::pause();
  });
  EXPECT_TRUE(end.timed_out);
  EXPECT_GE(end.wall_s, 0.2);
  EXPECT_LT(end.wall_s, 5) << "a machine that schedules badly has this long";
}

TEST(Workers, AMemoryBombEndsAtTheMemoryLimit) {
  if (test::kSanitized) GTEST_SKIP() << "shadow memory takes terabytes of address space";
  const WorkerEnd end = one({.memory_bytes = std::uint64_t{1} << 30}, [](std::uint64_t) -> std::string {
    std::string grown(1, 'x');
    for (;;) grown += grown;
  });
  EXPECT_TRUE(end.out_of_memory) << end.last_words;
}

TEST(Workers, AnErrorKeepsItsExitCodeAndText) {
  const WorkerEnd end = one({}, [](std::uint64_t) -> std::string { fail(ErrorKind::io, "the disk is full"); });
  EXPECT_EQ(end.exit_code, 5);
  EXPECT_EQ(end.last_words, "the disk is full");
}

TEST(Workers, WhoTalksWithoutEndKeepsTheEndOfItAndDoesNotHang) {
  const WorkerEnd end = one({}, [](std::uint64_t) -> std::string {
    for (int i = 0; i < 200'000; ++i) std::fputs("blah ", stderr);
    std::fputs("end", stderr);
    return "fine";
  });
  EXPECT_EQ(end.answer, "fine");
  EXPECT_TRUE(end.last_words.ends_with("end"));
  EXPECT_LT(end.last_words.size(), std::size_t{1} << 20);
}

TEST(Workers, ThoseThatWorkEndWithTheirMaker) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  {
    Workers workers(1, {}, [&](std::uint64_t) -> std::string {
      for (;;) ::pause();
    });
    workers.begin(0);
    ::close(pipe[1]);  // the worker alone holds it now
  }
  char byte = 0;
  EXPECT_EQ(::read(pipe[0], &byte, 1), 0) << "closed: it is gone";
  ::close(pipe[0]);
}

}  // namespace
}  // namespace verisim::batch::workers_test

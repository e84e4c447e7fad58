// Columns of what is at rest (engine/record/resting_columns.hpp): a file says of every row what was so, and holds bytes
// for those rows alone that say something else than at rest.
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "engine/record/repeated_row.hpp"
#include "tests/record/small_run.hpp"

namespace verisim::resting_test {

/// How many writes are still done in this process; below 0: all. The one after them kills it.
std::atomic<std::int64_t> writes_left{-1};

}  // namespace verisim::resting_test

/// As HDF5 calls it: the test decides which write is the last.
extern "C" __attribute__((visibility("default"))) ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  if (verisim::resting_test::writes_left >= 0 && verisim::resting_test::writes_left-- == 0) ::raise(SIGKILL);
  return ::syscall(SYS_pwrite64, file, bytes, size, at);
}

namespace verisim::resting_test {
namespace {

using small_run::Folder;
using small_run::header;

constexpr std::size_t kParts[] = {0, 3, 70};  // of more than a word of bits
constexpr std::array<double, 7> kPose = {1, -2, 0.1, 0, 0, 0.6, 0.8};

std::vector<std::byte> bytes_of(const void* values, std::size_t size) {
  const auto* const bytes = static_cast<const std::byte*>(values);
  return {bytes, bytes + size};
}

Schema schema(std::size_t more_parts = 0) {
  Schema s;
  const auto add = [&](const std::string& path, std::size_t width, std::size_t part, std::vector<std::byte> rest) {
    s.add({.path = path,
           .dtype = Dtype::f64,
           .width = width,
           .units = "1",
           .description = "What it says",
           .enum_names = {},
           .part = part,
           .rest = std::move(rest)});
  };
  const auto add_body = [&](std::size_t part) {
    const std::string path = "/state/body/" + std::to_string(part);
    const std::array<double, 6> nothing{};
    add(path + "/pose", 7, part, bytes_of(kPose.data(), sizeof kPose));
    add(path + "/force", 6, part, bytes_of(nothing.data(), sizeof nothing));
  };
  add("/state/time", 1, Column::kNoPart, {});
  for (const std::size_t part : kParts) add_body(part);
  for (std::size_t i = 0; i < more_parts; ++i) add_body(100 + i);
  add("/timing/frame", 1, Column::kNoPart, {});
  return s;
}

bool is_touched(std::uint64_t row, std::size_t part) {
  if (part == 0) return (row >= 100 && row < 180) || row % 997 == 5;
  if (part == 70) return row % 2 == 1;  // a kill may come in any of them
  return part == 3 && (row == 0 || (row >= 4090 && row < 4100) || row == 9000);
}

struct Body {
  std::array<double, 7> pose = kPose;
  std::array<double, 6> force{};
};

Body body(std::uint64_t row, std::size_t part) {
  Body b;
  if (!is_touched(row, part)) return b;
  for (std::size_t i = 0; i < 6; ++i) b.force[i] = static_cast<double>(row) + 0.125 * static_cast<double>(i);
  if (part == 3) b.pose[2] += static_cast<double>(row);  // not of what is fixed, but who knows
  return b;
}

void record_row(Recorder& recorder, const Schema& s, std::uint64_t row) {
  std::vector<std::size_t> awake;
  for (const std::size_t part : kParts)
    if (is_touched(row, part)) awake.push_back(part);
  const std::span<std::byte> to = recorder.begin_row(awake);
  for (const Column& c : s.columns()) {
    const bool at_rest = c.part != Column::kNoPart && !is_touched(row, c.part);
    const Body b = c.part == Column::kNoPart ? Body{} : body(row, c.part);
    const double number = static_cast<double>(row);
    if (at_rest)
      std::memset(&to[c.offset], 0xee, c.bytes());  // nobody looks
    else if (c.part == Column::kNoPart)
      std::memcpy(&to[c.offset], &number, sizeof number);
    else
      std::memcpy(&to[c.offset], c.width == 7 ? b.pose.data() : b.force.data(), c.bytes());
  }
  recorder.end_row();
}

void write(const std::string& path, std::uint64_t rows, std::size_t planned, const Schema& s = schema()) {
  Recorder recorder(path, s, header(), {.frames_planned = planned});
  for (std::uint64_t i = 0; i < rows; ++i) record_row(recorder, s, i);
  recorder.close({}, {});
}

void expect_right(const RunFile& run) {
  for (const Column& c : run.schema().columns()) {
    const std::vector<std::byte> values = run.column(c);
    ASSERT_EQ(values.size(), run.rows() * c.bytes()) << c.path;
    for (std::size_t i = 0; i < run.rows(); ++i) {
      const bool is_pose = c.path.ends_with("/pose");
      Body b;
      if (c.path.starts_with("/state/body/")) b = body(i, std::stoul(c.path.substr(12)));
      const double number = static_cast<double>(i);
      const void* expected = is_pose ? static_cast<const void*>(b.pose.data()) : b.force.data();
      if (c.width == 1) expected = &number;
      ASSERT_EQ(std::memcmp(&values[i * c.bytes()], expected, c.bytes()), 0) << c.path << ", row " << i;
    }
  }
}

TEST(Resting, EveryRowSaysWhatWasSoHoweverManyWerePlanned) {
  const Folder folder;
  for (const std::size_t planned : {10000, 0, 3000, 4096, 4097, 20000}) {
    SCOPED_TRACE(planned);
    write(folder.file("run.h5"), 10000, planned);
    const RunFile run(folder.file("run.h5"));
    ASSERT_EQ(run.rows(), 10000U);
    expect_right(run);
    EXPECT_TRUE(run.altered().empty());
    std::filesystem::remove(folder.file("run.h5"));
  }
}

std::uintmax_t size_of_run(const Folder& folder, std::uint64_t rows, std::size_t more_parts) {
  const std::string path = folder.file(std::to_string(rows) + "_" + std::to_string(more_parts));
  write(path, rows, rows, schema(more_parts));
  return std::filesystem::file_size(path);
}

TEST(Resting, WhatIsAtRestTakesNoBytesForItsRows) {
  const Folder folder;
  const std::uintmax_t few = size_of_run(folder, 20000, 100) - size_of_run(folder, 1000, 100);
  const std::uintmax_t none = size_of_run(folder, 20000, 0) - size_of_run(folder, 1000, 0);
  EXPECT_LT(few - none, 100 * 19000);  // a byte a row; they have 104
}

/// Writes 400 rows in a process that is killed in the place of its `writes`th write into the file. Returns whether it
/// came to that.
bool write_and_kill(const std::string& path, std::uint64_t writes) {
  const pid_t child = ::fork();
  if (child == 0) {
    const Schema s = schema();
    Recorder recorder(path, s, header(), {.frames_unflushed = 100, .frames_planned = 5000});
    for (std::uint64_t i = 0; i < 400; ++i) {
      if (i == 1) writes_left = static_cast<std::int64_t>(writes);
      record_row(recorder, s, i);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

// What was done to a body is safe before the frame is that it was done in, whichever write is the last.
TEST(Resting, IsRightInTheFileOfAKilledRun) {
  const Folder folder;
  const std::string path = folder.file("run.h5");
  std::uint64_t writes = 1;
  for (; write_and_kill(path, writes); ++writes) {
    SCOPED_TRACE(writes);
    if (!std::filesystem::exists(path)) continue;
    const RunFile run(path);
    EXPECT_TRUE(run.recovered());
    EXPECT_GT(run.rows(), 0U);
    ASSERT_NO_FATAL_FAILURE(expect_right(run));
    std::filesystem::remove(path);
    std::filesystem::remove(path + ".part");
  }
  EXPECT_GT(writes, 50U) << "no kill came between two writes: this test would prove nothing";
}

// HDF5's own reader, which is zlib's, inflates what deflated() makes; the shortest rows have other codes than long
// ones.
TEST(Resting, RowsOfAnyWidthComeBack) {
  const Folder folder;
  for (const Dtype dtype : {Dtype::u8, Dtype::u16, Dtype::u32, Dtype::f64})
    for (const std::size_t width : {1, 2, 3, 5, 17, 32}) {
      SCOPED_TRACE(width * size_of(dtype));
      std::vector<std::byte> rest(width * size_of(dtype));
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = static_cast<std::byte>(255 - 37 * i);
      Schema s;
      s.add(
          {.path = "/state/time", .dtype = Dtype::f64, .width = 1, .units = "s", .description = "", .enum_names = {}});
      s.add({.path = "/state/x",
             .dtype = dtype,
             .width = width,
             .units = "1",
             .description = "",
             .enum_names = {},
             .part = 0,
             .rest = rest});
      const std::string path = folder.file("run.h5");
      {
        Recorder recorder(path, s, header(), {.frames_planned = 5000});
        for (int i = 0; i < 5000; ++i) {
          static_cast<void>(recorder.begin_row());
          recorder.end_row();
        }
        recorder.close({}, {});
      }
      const RunFile run(path);
      const std::vector<std::byte> values = run.column(run.schema().columns()[1]);
      ASSERT_EQ(values.size(), 5000 * rest.size());
      for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], rest[i % rest.size()]) << i;
      std::filesystem::remove(path);
    }
}

TEST(Resting, IsCompressedToLittle) {
  EXPECT_LT(deflated(bytes_of(kPose.data(), sizeof kPose), 4096).size(), 2300U);
  EXPECT_LT(deflated(bytes_of(kPose.data(), sizeof kPose), 1).size(), 80U);
}

}  // namespace
}  // namespace verisim::resting_test

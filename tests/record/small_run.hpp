// A small run for tests: columns of every kind, whose values are functions of the row number, and a folder to write in.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/record/run_file.hpp"

namespace verisim::small_run {

/// A folder of this test's own, removed at its end.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("verisim_record_" + std::to_string(::getpid()) + "_" + name())) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& file_name) const { return (path_ / file_name).string(); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
  static std::string name() { return ::testing::UnitTest::GetInstance()->current_test_info()->name(); }
};

inline Schema schema() {
  Schema s;
  s.add({.path = "/state/time",
         .dtype = Dtype::f64,
         .width = 1,
         .units = "s",
         .description = "Simulated time",
         .enum_names = {}});
  s.add({.path = "/state/body/pin/pose",
         .dtype = Dtype::f64,
         .width = 7,
         .units = "m, 1",
         .description = "Pose",
         .enum_names = {}});
  s.add({.path = "/state/link/pin~block/contacts",
         .dtype = Dtype::u32,
         .width = 1,
         .units = "1",
         .description = "Pairs",
         .enum_names = {}});
  s.add({.path = "/state/link/pin~block/constraint",
         .dtype = Dtype::u8,
         .width = 1,
         .units = "1",
         .description = "Strongest",
         .enum_names = {"none", "planar", "cylindrical"}});
  s.add({.path = "/state/wii/head/time",
         .dtype = Dtype::f64,
         .width = 1,
         .units = "s",
         .description = "At a rate of its own",
         .enum_names = {},
         .due = "/cost/wii/head/reports"});
  s.add(
      {.path = "/state/hash", .dtype = Dtype::u64, .width = 1, .units = "1", .description = "Hash", .enum_names = {}});
  s.add({.path = "/timing/stage_ns",
         .dtype = Dtype::u32,
         .width = 2,
         .units = "ns",
         .description = "Time by stage",
         .enum_names = {"query", "integrate"}});
  s.add({.path = "/cost/wii/head/reports",
         .dtype = Dtype::u32,
         .width = 1,
         .units = "1",
         .description = "Reports",
         .enum_names = {}});
  return s;
}

/// A frame in ten adds a row to the column that has a rate of its own; what it holds in the others is not stored.
inline bool has_report(std::uint64_t i) {
  return i % 10 == 3;
}
inline constexpr double kNoReport = -1;

template <typename T>
void put(std::span<std::byte> row, std::size_t& at, T value) {
  std::memcpy(row.data() + at, &value, sizeof value);
  at += sizeof value;
}

/// Row i: every value differs from its neighbours in row and column.
inline void fill(std::span<std::byte> row, std::uint64_t i) {
  std::size_t at = 0;
  put(row, at, 0.001 * static_cast<double>(i + 1));
  for (int k = 0; k < 7; ++k) put(row, at, static_cast<double>(i) + 0.125 * k);
  put(row, at, static_cast<std::uint32_t>(i * 3));
  put(row, at, static_cast<std::uint8_t>(i % 3));
  put(row, at, has_report(i) ? static_cast<double>(i) : kNoReport);
  put(row, at, i * 0x9e3779b97f4a7c15ULL);
  put(row, at, static_cast<std::uint32_t>(i));
  put(row, at, static_cast<std::uint32_t>(i + 7));
  put(row, at, has_report(i) ? 2U : 0U);
}

inline RunHeader header() {
  RunHeader h;
  h.attributes = {{"scenario", std::string("pin.lua")}, {"seed", std::int64_t{42}}, {"dt", 0.001}};
  return h;
}

inline void record(Recorder& recorder, std::uint64_t from, std::uint64_t to) {
  for (std::uint64_t i = from; i < to; ++i) {
    fill(recorder.begin_row(), i);
    recorder.end_row();
  }
}

/// Writes a whole run of `rows` rows.
inline void write(const std::string& path, std::uint64_t rows, const RunHeader& head = header()) {
  Recorder recorder(path, schema(), head, {});
  record(recorder, 0, rows);
  recorder.close({{"frames", static_cast<std::int64_t>(rows)}}, {{"state_hash", std::string("0123456789abcdef")}});
}

/// The first row that does not hold what fill() put into it; rows() if all do.
inline std::size_t first_wrong_row(const RunFile& run) {
  const Schema& stored = run.schema();
  std::vector<std::byte> rows(run.rows() * stored.row_bytes());
  for (const Column& c : stored.columns()) {
    const std::vector<std::byte> values = run.column(c);
    std::size_t next = 0;
    for (std::size_t i = 0; i < run.rows(); ++i) {
      std::byte* at = &rows[i * stored.row_bytes() + c.offset];
      if (c.due.empty() || has_report(i))
        std::memcpy(at, &values.at(next++ * c.bytes()), c.bytes());
      else
        std::memcpy(at, &kNoReport, sizeof kNoReport);
    }
    if (next * c.bytes() != values.size()) return 0;
  }
  std::vector<std::byte> expected(stored.row_bytes());
  for (std::size_t i = 0; i < run.rows(); ++i) {
    fill(expected, i);
    if (std::memcmp(expected.data(), &rows[i * stored.row_bytes()], expected.size()) != 0) return i;
  }
  return run.rows();
}

inline std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_content(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// What `work` throws; an Error of kind check_failed with an empty text if it throws nothing.
template <typename Work>
Error error_of(Work work) {
  try {
    work();
  } catch (const Error& e) {
    return e;
  }
  return {ErrorKind::check_failed, ""};
}

}  // namespace verisim::small_run

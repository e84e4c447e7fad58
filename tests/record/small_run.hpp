// A small run for tests: columns of every kind, whose values are functions of the row number, and a folder to write in.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/record/run_file.hpp"
#include "tests/support/folder.hpp"

namespace verisim::small_run {

using test::Folder;

inline Schema schema() {
  Schema s;
  struct Extra {
    std::vector<std::string> names = {};
    std::string due = {}, rows_in_frame = {};
  };
  const auto add = [&](const std::string& path, Dtype dtype, std::size_t width, const Extra& extra = {}) {
    s.add({.path = path,
           .dtype = dtype,
           .width = width,
           .units = path == "/state/time" ? "s" : "1",
           .description = "What " + path + " says",
           .enum_names = extra.names,
           .due = extra.due,
           .rows_in_frame = extra.rows_in_frame});
  };
  add("/state/time", Dtype::f64, 1);
  add("/state/body/pin/pose", Dtype::f64, 7);
  add("/state/body/pin/contacts", Dtype::u32, 1);
  add("/state/body/pin/constraint", Dtype::u8, 1, {.names = {"none", "planar", "cylindrical"}});
  add("/state/wii/head/time", Dtype::f64, 1, {.due = "/cost/wii/head/reports"});
  add("/state/hash", Dtype::u64, 1);
  add("/timing/stage_ns", Dtype::u32, 2, {.names = {"query", "integrate"}});
  for (const char* count : {"/cost/wii/head/reports", "/cost/links", "/cost/pairs_met"}) add(count, Dtype::u32, 1);
  add("/state/links/frame", Dtype::u32, 1, {.rows_in_frame = "/cost/links"});
  add("/state/links/pair", Dtype::u32, 1, {.rows_in_frame = "/cost/links"});
  add("/state/links/wrench", Dtype::f64, 6, {.rows_in_frame = "/cost/links"});
  s.bodies = {"pin", "block", "größer"};
  s.pairs_in_frame = "/cost/pairs_met";
  return s;
}

/// Pairs come near one after the other, and later part and meet again: frame i has the first i, then 0 to 3 of them.
inline constexpr BodyPair kPairs[] = {{0, 1}, {0, 2}, {1, 2}};
inline std::uint32_t links_in(std::uint64_t i) {
  return static_cast<std::uint32_t>(i <= 3 ? i : i % 4);
}
inline bool meets_in(std::uint64_t i) {
  return i >= 1 && i <= 3;
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
  put(row, at, links_in(i));
  put(row, at, meets_in(i) ? 1U : 0U);
}

/// The table's rows of a frame: no allocation, as in a loop.
class Links {
 public:
  explicit Links(std::uint64_t i) : size_(links_in(i) * kRowBytes) {
    std::size_t at = 0;
    for (std::uint32_t pair = 0; pair < links_in(i); ++pair) {
      put(std::span<std::byte>(bytes_), at, static_cast<std::uint32_t>(i));
      put(std::span<std::byte>(bytes_), at, pair);
      for (int k = 0; k < 6; ++k)
        put(std::span<std::byte>(bytes_), at, static_cast<double>(i) + 0.25 * pair + 0.03125 * k);
    }
  }
  [[nodiscard]] std::span<const std::byte> rows() const { return std::span(bytes_).first(size_); }

 private:
  static constexpr std::size_t kRowBytes = 2 * sizeof(std::uint32_t) + 6 * sizeof(double);
  std::array<std::byte, 3 * kRowBytes> bytes_{};
  std::size_t size_;
};

/// Frame i, whole.
inline void record_frame(Recorder& recorder, std::uint64_t i) {
  if (meets_in(i)) recorder.pair(kPairs[i - 1]);
  fill(recorder.begin_row(), i);
  recorder.add_table_rows(Links(i).rows());
  recorder.end_row();
}

inline RunHeader header() {
  RunHeader h;
  h.attributes = {{"scenario", std::string("pin.lua")}, {"seed", std::int64_t{42}}, {"dt", 0.001}};
  return h;
}

inline void record(Recorder& recorder, std::uint64_t from, std::uint64_t to) {
  for (std::uint64_t i = from; i < to; ++i) record_frame(recorder, i);
}

/// Writes a whole run of `rows` rows.
inline void write(const std::string& path, std::uint64_t rows, const RunHeader& head = header()) {
  Recorder recorder(path, schema(), head, {});
  record(recorder, 0, rows);
  recorder.close({{"frames", static_cast<std::int64_t>(rows)}}, {{"state_hash", std::string("0123456789abcdef")}});
}

/// Do the table and the list of pairs hold what record_frame() put into them, and no more?
inline bool tables_are_right(const RunFile& run) {
  std::vector<std::byte> expected;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < run.rows(); ++i) {
    const Links links(i);
    expected.insert(expected.end(), links.rows().begin(), links.rows().end());
    pairs += meets_in(i) ? 1 : 0;
  }
  const std::size_t row_bytes = run.schema().table_row_bytes();
  std::vector<std::byte> stored(expected.size());
  for (const Column& c : run.schema().table()) {
    const std::vector<std::byte> values = run.column(c);
    if (values.size() * row_bytes != expected.size() * c.bytes()) return false;
    for (std::size_t row = 0; row * row_bytes < stored.size(); ++row)
      std::memcpy(&stored[row * row_bytes + c.offset], &values[row * c.bytes()], c.bytes());
  }
  const std::vector<std::string> names = schema().bodies;
  if (stored != expected || run.pairs().size() != pairs) return false;
  for (std::size_t i = 0; i < pairs; ++i)
    if (run.pairs()[i] != std::pair(names[kPairs[i].first], names[kPairs[i].second])) return false;
  return true;
}

/// The first row that does not hold what fill() put into it; rows() if all do, 0 if the tables are wrong.
inline std::size_t first_wrong_row(const RunFile& run) {
  if (!tables_are_right(run)) return 0;
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

/// Objects of an HDF5 file's bytes that keep times: bit 5 of the flags in a header of version 2. Such files differ by
/// the second in which they were written.
inline std::size_t objects_with_times(const std::string& content) {
  const std::string header("OHDR\x02", 5);
  std::size_t timed = 0;
  for (std::size_t at = content.find(header); at != std::string::npos; at = content.find(header, at + 1))
    timed += static_cast<unsigned char>(content.at(at + header.size())) >> 5 & 1;
  return timed;
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

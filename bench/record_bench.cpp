// What recording costs: the loop, which must not feel it (under 1 us a frame), and the writer beside it. A row of 41
// columns and about 1 kB, as the peg scene with three links writes it; the run is the dissertation's, 45,833 frames.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <vector>

#include "bench/promise.hpp"
#include "engine/base/random.hpp"
#include "engine/record/run_file.hpp"
#include "engine/record/synth.hpp"
#include "engine/record/trace.hpp"
#include "tests/support/folder.hpp"

namespace verisim {
namespace {

using Clock = std::chrono::steady_clock;

std::string file() {
  static const test::Folder folder;
  return folder.file("run.h5");
}

Schema schema() {
  Schema s;
  const auto add = [&](const std::string& path, Dtype dtype, std::size_t width) {
    s.add({.path = path, .dtype = dtype, .width = width, .units = "1", .description = path, .enum_names = {}});
  };
  add("/state/time", Dtype::f64, 1);
  for (const char* body : {"block", "pin", "plate"}) {
    const std::string path = std::string("/state/body/") + body;
    add(path + "/pose", Dtype::f64, 7);
    add(path + "/twist", Dtype::f64, 6);
    add(path + "/force", Dtype::f64, 6);
  }
  for (const char* field : {"handle_pose", "raw_pose"}) add(std::string("/state/device/omni/") + field, Dtype::f64, 7);
  add("/state/device/omni/wrench", Dtype::f64, 6);
  add("/state/hash", Dtype::u64, 1);
  for (const char* field : {"points", "voxels", "lookups", "bytes"}) add(std::string("/cost/") + field, Dtype::u64, 1);
  add("/timing/frame_ns", Dtype::u64, 1);
  add("/timing/stage_ns", Dtype::u32, 9);
  add("/cost/links", Dtype::u32, 1);
  add("/cost/pairs_met", Dtype::u32, 1);
  const auto add_to_table = [&](const char* fact, Dtype dtype, std::size_t width) {
    s.add({.path = std::string("/state/links/") + fact,
           .dtype = dtype,
           .width = width,
           .units = "1",
           .description = fact,
           .enum_names = {},
           .rows_in_frame = "/cost/links"});
  };
  for (const char* fact : {"frame", "pair", "contacts", "by_voxels", "cache_hits", "cache_misses"})
    add_to_table(fact, Dtype::u32, 1);
  add_to_table("constraint", Dtype::u8, 1);
  for (const char* fact : {"alignment", "max_penetration"}) add_to_table(fact, Dtype::f64, 1);
  add_to_table("wrench", Dtype::f64, 6);
  s.bodies = {"block", "pin", "plate"};
  s.pairs_in_frame = "/cost/pairs_met";
  return s;
}

constexpr std::uint32_t kLinks = 3;  // near in every frame

/// Numbers that do not compress and do not repeat; drawn before the clock starts.
std::vector<std::byte> make_bytes(const char* stream, std::size_t count) {
  const RandomStream random(42, stream);
  std::vector<std::byte> rows(count);
  for (std::size_t i = 0; i + 8 <= rows.size(); i += 8) {
    const std::uint64_t value = random.bits(i);
    std::memcpy(&rows[i], &value, sizeof value);
  }
  return rows;
}

/// What is recorded, over and over: rows, and the table's rows of each.
struct Given {
  std::size_t kinds = 257;
  std::vector<std::byte> rows, table;
  explicit Given(const Schema& s)
      : rows(make_bytes("record_bench", kinds * s.row_bytes())),
        table(make_bytes("record_bench links", kinds * kLinks * s.table_row_bytes())) {
    for (const Column& c : s.columns())
      for (std::size_t i = 0; i < kinds; ++i) {
        const std::uint32_t count = c.path == "/cost/links" ? kLinks : 0;
        if (c.path == "/cost/links" || c.path == s.pairs_in_frame)
          std::memcpy(&rows[i * s.row_bytes() + c.offset], &count, sizeof count);
      }
  }
};

struct Measured {
  std::vector<double> loop_ns;  ///< begin_row, copying the row, end_row
  double total_s = 0;           ///< first row to closed file
  double close_s = 0;
  double writer_cpu_s = 0;  ///< of all threads but this one, closing included
};

/// Processor time used so far by the whole process (RUSAGE_SELF) or by this thread alone (RUSAGE_THREAD).
double cpu_seconds(int who) {
  rusage used{};
  ::getrusage(who, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

Measured record(const Given& given, const Schema& s, std::size_t frames, bool paced, std::size_t ring_rows) {
  Measured m;
  m.loop_ns.reserve(frames);
  Recorder recorder(file(), s, {}, {.paced = paced, .ring_rows = ring_rows, .table_rows = kLinks * ring_rows});
  const std::size_t table_bytes = kLinks * s.table_row_bytes();
  const double others = cpu_seconds(RUSAGE_SELF) - cpu_seconds(RUSAGE_THREAD);
  const auto start = Clock::now();
  for (std::size_t i = 0; i < frames; ++i) {
    const auto before = Clock::now();
    const std::size_t kind = i % given.kinds;
    std::memcpy(recorder.begin_row().data(), &given.rows[kind * s.row_bytes()], s.row_bytes());
    recorder.add_table_rows({&given.table[kind * table_bytes], table_bytes});
    recorder.end_row();
    m.loop_ns.push_back(std::chrono::duration<double, std::nano>(Clock::now() - before).count());
  }
  const auto closing = Clock::now();
  const double own = cpu_seconds(RUSAGE_THREAD);
  recorder.close({}, {});
  const double closing_cpu = cpu_seconds(RUSAGE_THREAD) - own;
  m.writer_cpu_s = cpu_seconds(RUSAGE_SELF) - cpu_seconds(RUSAGE_THREAD) - others + closing_cpu;
  m.close_s = std::chrono::duration<double>(Clock::now() - closing).count();
  m.total_s = std::chrono::duration<double>(Clock::now() - start).count();
  std::sort(m.loop_ns.begin(), m.loop_ns.end());
  return m;
}

/// Is every row in the file as it was given?
bool file_holds(const Given& given, const Schema& s, std::size_t frames) {
  const RunFile run(file());
  if (run.rows() != frames) return false;
  const auto holds = [&](const Column& c, const std::vector<std::byte>& rows, std::size_t row_bytes,
                         std::size_t count) {
    const std::vector<std::byte> values = run.column(c);
    if (values.size() != count * c.bytes()) return false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* expected = &rows[(i * row_bytes) % rows.size() + c.offset];
      if (std::memcmp(&values[i * c.bytes()], expected, c.bytes()) != 0) return false;
    }
    return true;
  };
  bool all = true;
  for (const Column& c : s.columns()) all = all && holds(c, given.rows, s.row_bytes(), frames);
  for (const Column& c : s.table()) all = all && holds(c, given.table, s.table_row_bytes(), kLinks * frames);
  return all;
}

void report(benchmark::State& state, const Measured& m, const Schema& s, std::size_t frames) {
  const double n = static_cast<double>(frames);
  state.counters["loop_ns_p50"] = m.loop_ns[frames / 2];
  state.counters["loop_ns_p99"] = m.loop_ns[frames * 99 / 100];
  state.counters["loop_ns_max"] = m.loop_ns.back();
  state.counters["rows_per_s"] = n / m.total_s;
  state.counters["close_ms"] = m.close_s * 1e3;
  state.counters["writer_cpu_ms"] = m.writer_cpu_s * 1e3;
  state.counters["columns"] = static_cast<double>(s.columns().size() + s.table().size());
  state.counters["row_bytes"] = static_cast<double>(s.row_bytes() + kLinks * s.table_row_bytes());
  state.counters["file_per_row_bytes"] = static_cast<double>(std::filesystem::file_size(file())) / n;
}

// The loop alone: a ring that takes the whole run, so that it never waits.
void BM_LoopNeverWaits(benchmark::State& state) {
  const Schema s = schema();
  const std::size_t frames = bench::smoke() ? 500 : 45'833;
  const Given given(s);
  Measured m;
  for (auto _ : state) m = record(given, s, frames, true, frames + 1);
  if (!file_holds(given, s, frames)) bench::wrong(state, "the file does not hold what was recorded");
  report(state, m, s, frames);
  bench::at_most(state, "loop_ns_p50", m.loop_ns[frames / 2], 1000);
  std::filesystem::remove(file());
}
BENCHMARK(BM_LoopNeverWaits)->Unit(benchmark::kMillisecond)->Iterations(3)->UseRealTime();

// The whole dissertation run as fast as the file takes it: the loop does nothing but record, so it waits most of the
// time.
void BM_WriterAlone(benchmark::State& state) {
  const Schema s = schema();
  const std::size_t frames = bench::smoke() ? 500 : 45'833;
  const Given given(s);
  Measured m;
  for (auto _ : state) m = record(given, s, frames, false, 0);
  if (!file_holds(given, s, frames)) bench::wrong(state, "the file does not hold what was recorded");
  report(state, m, s, frames);
  std::filesystem::remove(file());
}
BENCHMARK(BM_WriterAlone)->Unit(benchmark::kMillisecond)->Iterations(3)->UseRealTime();

// Parsing a CSV trace, in bytes a second.
void BM_ParseTrace(benchmark::State& state) {
  const Trace trace = synthesize("tremor", {{"duration", bench::smoke() ? 1.0 : 60.0}}, 1);
  const std::string path = file() + ".csv";
  write_trace(path, trace);
  std::string content(std::filesystem::file_size(path), '\0');
  if (std::FILE* in = std::fopen(path.c_str(), "rb"); in != nullptr) {
    if (std::fread(content.data(), 1, content.size(), in) != content.size())
      bench::wrong(state, "cannot read the trace");
    std::fclose(in);
  }
  Trace parsed;
  for (auto _ : state) parsed = parse_trace("bench.csv", content, "haptic", {});
  if (parsed.values != trace.values) bench::wrong(state, "the trace did not come back as it was");
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(content.size()));
  std::filesystem::remove(path);
}
BENCHMARK(BM_ParseTrace)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim

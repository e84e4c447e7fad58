// Files that Google Benchmark wrote (--benchmark_out=FILE --benchmark_repetitions=N, JSON), two compared or one read.
// The repetitions are taken one by one; means and deviations that the file has beside them are not used. Of real and
// CPU time the one that the benchmark itself goes by is judged, as its name tells (…/real_time, …/manual_time; else CPU
// time), and the other shown: judging both would double the chance of a false alarm. A counter of the benchmark's own
// that has one value in all repetitions (two or more) of both files is a count and has to be equal; others scatter as
// times do, and are not judged.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/compare/bounds.hpp"
#include "engine/compare/comparison.hpp"

namespace verisim::compare {

struct Benchmark {
  std::string name, unit;  ///< unit: ns, us, ms, s
  std::vector<double> real, cpu;
  std::map<std::string, std::vector<double>> counters{};  ///< its own, a value a repetition that has them
};

struct BenchmarkFile {
  Origin origin;                                             ///< version is empty, commit from the context
  std::vector<std::pair<std::string, std::string>> context;  ///< what else it says of machine and build, but dates
  std::vector<Benchmark> benchmarks;                         ///< in the file's order
};

/// Whether it begins as JSON does, so that a wrong file is told what it should be.
[[nodiscard]] bool looks_like_json(const std::string& path);

/// Error(input): not there, not JSON (NaN is none), not of Google Benchmark, no benchmark in it, only aggregates, a
/// time that is not finite and above 0, a benchmark that failed.
[[nodiscard]] BenchmarkFile read_benchmarks(const std::string& path);

/// How many ns a unit of time has. @pre one of ns, us, ms, s
[[nodiscard]] double nanoseconds_of(const std::string& unit);

/// Whether a benchmark's name says that it goes by real time, not by CPU time.
[[nodiscard]] bool goes_by_real_time(const std::string& name);

/// Error(input) as above.
[[nodiscard]] Comparison compare_benchmarks(const std::string& a, const std::string& b, const Bounds& bounds);

}  // namespace verisim::compare

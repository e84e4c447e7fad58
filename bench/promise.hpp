// What every benchmark program does alike: short runs in ctest, answers that are checked, figures that are promised,
// and a main() that ends with 1 if an answer was wrong or a promise missed.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace verisim::bench {

/// Whether this is ctest's short run (VERISIM_BENCH_SMOKE is set): answers count, times mean nothing.
[[nodiscard]] bool smoke();

/// An answer is wrong: the benchmark stops with an error.
void wrong(benchmark::State& state, const std::string& what);

/// Notes a figure under `counter` and holds it to its promise. A miss is told on stderr with both numbers; the
/// benchmark goes on, so that its other figures are seen too. Not held in a short run.
void at_most(benchmark::State& state, const std::string& counter, double value, double promised);
void at_least(benchmark::State& state, const std::string& counter, double value, double promised);

}  // namespace verisim::bench

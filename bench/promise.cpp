#include "bench/promise.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace verisim::bench {
namespace {

int failures = 0;

void hold(benchmark::State& state, const std::string& counter, double value, bool kept, const std::string& promised) {
  state.counters[counter] = value;
  if (kept || smoke()) return;
  ++failures;
  const std::string line = fmt::format("MISSED: {} is {:.4g}, promised {}\n", counter, value, promised);
  std::fputs(line.c_str(), stderr);
}

}  // namespace

bool smoke() {
  return std::getenv("VERISIM_BENCH_SMOKE") != nullptr;
}

void wrong(benchmark::State& state, const std::string& what) {
  ++failures;
  state.SkipWithError(what.c_str());
}

void at_most(benchmark::State& state, const std::string& counter, double value, double promised) {
  hold(state, counter, value, value <= promised, fmt::format("at most {:.4g}", promised));
}

void at_least(benchmark::State& state, const std::string& counter, double value, double promised) {
  hold(state, counter, value, value >= promised, fmt::format("at least {:.4g}", promised));
}

}  // namespace verisim::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return verisim::bench::failures == 0 ? 0 : 1;
}

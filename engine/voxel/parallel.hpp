// Splits a loop over independent items among threads. Items write only what is theirs, so the result is the same for
// any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace verisim {

/// Calls work(begin, end) for runs of items that together cover [0, count). `work` must not throw.
template <class Work>
void for_each_run(std::size_t count, unsigned threads, const Work& work) {
  constexpr std::size_t kRun = 256;  // items per run: large against handing one out, small against the whole
  if (threads <= 1 || count <= kRun) return work(std::size_t{0}, count);
  std::atomic<std::size_t> next{0};
  const auto take_runs = [&] {
    for (std::size_t begin = next.fetch_add(kRun); begin < count; begin = next.fetch_add(kRun)) {
      work(begin, std::min(begin + kRun, count));
    }
  };
  std::vector<std::jthread> helpers;
  for (unsigned i = 1; i < threads; ++i) helpers.emplace_back(take_runs);
  take_runs();
}

}  // namespace verisim

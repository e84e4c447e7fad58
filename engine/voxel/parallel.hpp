// Parallel loop over independent items. Each item writes its own data only, so the result is the same for any number of
// threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace verisim {

/// Calls work(begin, end) for chunks of items that together cover [0, count). `work` must not throw.
template <class Work>
void for_each_chunk(std::size_t count, unsigned threads, const Work& work) {
  constexpr std::size_t kChunk = 256;  // items per chunk: large against the cost of a hand-out, small against the whole
  if (threads <= 1 || count <= kChunk) return work(std::size_t{0}, count);
  std::atomic<std::size_t> next{0};
  const auto take_chunks = [&] {
    for (std::size_t begin = next.fetch_add(kChunk); begin < count; begin = next.fetch_add(kChunk)) {
      work(begin, std::min(begin + kChunk, count));
    }
  };
  std::vector<std::jthread> helpers;
  for (unsigned i = 1; i < threads; ++i) helpers.emplace_back(take_chunks);
  take_chunks();
}

}  // namespace verisim

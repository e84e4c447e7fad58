#include "engine/compare/series.hpp"

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace verisim::compare {

bool is_b_first(std::uint64_t seed, std::uint64_t pair) {
  return (RandomStream(seed, "compare.order").bits(pair) >> 63U) != 0;
}

void Series::add_pair(const RunTimes& a, const RunTimes& b) {
  VERISIM_ASSERT(a.size() == figures_.size());
  VERISIM_ASSERT(b.size() == figures_.size());
  a_.push_back(a);
  b_.push_back(b);
}

std::vector<TimeSamples> Series::samples() const {
  std::vector<TimeSamples> samples;
  for (std::size_t f = 0; f < figures_.size(); ++f) {
    TimeSamples s{.name = figures_[f].name, .unit = figures_[f].unit, .is_paired = true};
    for (std::size_t i = 0; i < a_.size(); ++i) {
      s.a.push_back(a_[i][f]);
      s.b.push_back(b_[i][f]);
    }
    samples.push_back(std::move(s));
  }
  return samples;
}

}  // namespace verisim::compare

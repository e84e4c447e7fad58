#include "engine/compare/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/text.hpp"

namespace verisim::compare {
namespace {

/// Columns of timing.csv (engine/batch/conditions.hpp), the most telling first.
constexpr const char* kConditions[] = {"jobs", "cache", "threads", "simd", "recorded", "cpu", "cores"};

std::string value_in(const std::string& cell) {
  return cell.empty() ? std::string("not told") : shown(cell, 60);
}

/// "jobs 1 and 2", "cache cold and warm in 3 of 40 runs"; empty: the pairs have the same. Marks those that have not.
std::string difference_in(const char* name, const IndexTable& a, const IndexTable& b,
                          const std::vector<TimedPair>& pairs, std::vector<bool>& differs) {
  const std::size_t of_a = *a.find(name), of_b = *b.find(name);
  std::string text;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string &x = a.cell(pairs[i].row_a, of_a), &y = b.cell(pairs[i].row_b, of_b);
    if (x == y) continue;
    differs[i] = true;
    if (++count == 1) text = fmt::format("{} {} and {}", name, value_in(x), value_in(y));
  }
  if (count > 0 && count < pairs.size()) text += fmt::format(" in {} of {} runs", count, pairs.size());
  return text;
}

}  // namespace

ComparableTimes comparable_times(const IndexTable& a, const IndexTable& b, const std::vector<TimedPair>& pairs) {
  ComparableTimes found;
  std::vector<bool> differs(pairs.size(), false);
  for (const char* name : kConditions) {
    if (!a.find(name) || !b.find(name)) {
      found.is_known = false;
      continue;
    }
    const std::string text = difference_in(name, a, b, pairs, differs);
    if (!text.empty()) found.difference += (found.difference.empty() ? "" : "; ") + text;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!differs[i]) found.pairs.push_back(pairs[i]);
  return found;
}

}  // namespace verisim::compare

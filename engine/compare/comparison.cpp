#include "engine/compare/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace verisim::compare {
namespace {

Change change_of(const TimeFigure& figure) {
  switch (figure.change) {
    case TimeChange::faster:
      return Change::better;
    case TimeChange::slower:
      return Change::worse;
    case TimeChange::none:
    case TimeChange::unknown:
      return Change::none;
  }
  return Change::none;
}

template <typename Items>
std::vector<std::string> names_with(const Items& items, Change wanted) {
  std::vector<std::string> names;
  for (const auto& item : items) {
    Change change;
    if constexpr (requires { item.ratio; })
      change = change_of(item);
    else
      change = item.change;
    if (change == wanted) names.push_back(item.name);
  }
  return names;
}

/// "points_tested, contacts and 3 more are"
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 3;
  std::string text = names[0];
  for (std::size_t i = 1; i < std::min(kMost, names.size()); ++i)
    text += (i + 1 == names.size() ? " and " : ", ") + names[i];
  if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
  return text + (names.size() == 1 ? " is" : " are");
}

struct Words {
  Change change;
  const char *counts, *accuracy, *outcomes, *times;
};
constexpr Words kWords[] = {
    {Change::worse, "higher", "worse by more than the bound", "worse", "slower"},
    {Change::changed, "different", "different by more than the bound", "different", ""},
    {Change::better, "lower", "better by more than the bound", "better", "faster"},
    {Change::bits, "different", "different", "different", ""},
};

std::vector<std::string> without_verdict(const Comparison& c) {
  std::vector<std::string> names;
  for (const TimeFigure& time : c.times)
    if (time.is_judged && time.change == TimeChange::unknown) names.push_back(time.name);
  return names;
}

bool is_any(const Comparison& c, Change change) {
  return !names_with(c.counts, change).empty() || !names_with(c.accuracy, change).empty() ||
         !names_with(c.outcomes, change).empty() || !names_with(c.times, change).empty();
}

}  // namespace

Verdict verdict_of(const Comparison& c) {
  const bool better = is_any(c, Change::better), worse = is_any(c, Change::worse);
  const bool changed = is_any(c, Change::changed) || !c.only_a.empty() || !c.only_b.empty();
  if (better && worse) return Verdict::different;
  if (worse) return Verdict::worse;
  if (changed) return Verdict::different;
  if (better) return Verdict::better;
  return is_any(c, Change::bits) || !c.first_difference.empty() ? Verdict::different : Verdict::same;
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::same:
      return "same";
    case Verdict::better:
      return "better";
    case Verdict::worse:
      return "worse";
    case Verdict::different:
      return "different";
  }
  return "";
}

std::vector<std::string> reasons_of(const Comparison& c) {
  std::vector<std::string> reasons;
  const auto add = [&](const std::vector<std::string>& names, const char* how) {
    if (!names.empty()) reasons.push_back(fmt::format("{} {}", listed(names), how));
  };
  for (const Words& words : kWords) {
    add(names_with(c.outcomes, words.change), words.outcomes);
    add(names_with(c.accuracy, words.change), words.accuracy);
    add(names_with(c.counts, words.change), words.counts);
    add(names_with(c.times, words.change), words.times);
  }
  add(c.only_a, "only in A");
  add(c.only_b, "only in B");
  if (c.kind == "programs") add(without_verdict(c), "without a verdict: too few runs");
  return reasons;
}

}  // namespace verisim::compare

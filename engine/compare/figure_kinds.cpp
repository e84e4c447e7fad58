#include "engine/compare/figure_kinds.hpp"

#include <set>

#include "engine/base/run_figures.hpp"

namespace verisim::compare {

FigureKind kind_of_figure(const std::string& name) {
  static const std::set<std::string> kSkipped = {"run",         "seed",     "error",       "scenario",
                                                 "simulated_s", "run_file", "overlap_pair"};
  if (kSkipped.count(name) != 0) return FigureKind::skipped;
  if (name == "state_hash") return FigureKind::hash;
  if (name == "status" || name == "outcome" || name == "overlap_unmeasured") return FigureKind::word;
  if (name.starts_with("cost.") || name.starts_with("constraints.")) return FigureKind::count;
  for (const RunFigure& figure : run_figures()) {
    if (name != figure.name) continue;
    if (figure.only_once) return FigureKind::skipped;
    const RunFigure::Value value = figure.value(RunFigures());
    if (std::holds_alternative<std::string>(value)) return FigureKind::word;
    return std::holds_alternative<double>(value) ? FigureKind::number : FigureKind::count;
  }
  return FigureKind::number;
}

Change change_of_count(const std::string& name, bool is_higher) {
  static const std::set<std::string> kFewerIsBetter = {"cache_misses", "null_misses", "by_voxels",
                                                       "exact_frames_by_voxels"};
  if (name.starts_with("/cost/") || name.starts_with("cost.") || kFewerIsBetter.count(name) != 0)
    return is_higher ? Change::worse : Change::better;
  // Look-ups that memoization answered: /cost/lookups less the misses, both of which are judged.
  return name == "cache_hits" ? Change::bits : Change::changed;
}

}  // namespace verisim::compare

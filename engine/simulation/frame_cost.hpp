// Work done in one frame; deterministic. One counter per kind of work, declared once: name below /cost, unit, meaning.
#pragma once

#include <array>
#include <cstdint>

namespace verisim {

struct FrameCost {
  std::uint64_t pairs_met = 0;
  std::uint64_t links = 0;
  std::uint64_t pairs_tested = 0;
  std::uint64_t clusters = 0;
  std::uint64_t points_tested = 0;
  std::uint64_t voxels_read = 0;
  std::uint64_t contacts = 0;
  std::uint64_t lookups = 0;
  std::uint64_t recognitions = 0;
  std::uint64_t exact_samples = 0;
  std::uint64_t solver_steps = 0;
  std::uint64_t bytes_touched = 0;
  // What found no room or no end: an event says so at the first time (stages/left_out.hpp).
  std::uint64_t rows_left_out = 0;
  std::uint64_t memo_overflows = 0;
  std::uint64_t contacts_left_out = 0;
  std::uint64_t solver_unfinished = 0;
};

struct CostCounter {
  const char* name;
  const char* unit;
  const char* meaning;
  std::uint64_t FrameCost::*count;
};

inline constexpr std::array kCostCounters = {
    CostCounter{"pairs_met", "1", "pairs of bodies that came near for the first time: rows added to /state/pairs",
                &FrameCost::pairs_met},
    CostCounter{"links", "1", "pairs of bodies that were near: rows added to /state/links", &FrameCost::links},
    CostCounter{"pairs_tested", "1", "pairs of bodies queried", &FrameCost::pairs_tested},
    CostCounter{"clusters", "1", "clusters of points looked at", &FrameCost::clusters},
    CostCounter{"points_tested", "1", "points transformed and looked up", &FrameCost::points_tested},
    CostCounter{"voxels_read", "1", "voxels read", &FrameCost::voxels_read},
    CostCounter{"contacts", "1", "contacts found", &FrameCost::contacts},
    CostCounter{"lookups", "1", "pairs of feature sets looked up", &FrameCost::lookups},
    CostCounter{"recognitions", "1", "pairs of entities that recognition looked at", &FrameCost::recognitions},
    CostCounter{"exact_samples", "1", "samples of precise edges tried against precise faces",
                &FrameCost::exact_samples},
    CostCounter{"solver_steps", "1", "Newton iterations of the exact response", &FrameCost::solver_steps},
    CostCounter{"bytes_touched", "B", "of voxels, points and contacts, by the queries", &FrameCost::bytes_touched},
    CostCounter{"rows_left_out", "1", "precise contacts beyond the capacity of a pair's list or of the solver",
                &FrameCost::rows_left_out},
    CostCounter{"memo_overflows", "1", "recognized constraints, or pairs of feature sets, that a memo had no room for",
                &FrameCost::memo_overflows},
    CostCounter{"contacts_left_out", "1", "contacts of contact = \"fcl\" beyond the capacity of a pair's list",
                &FrameCost::contacts_left_out},
    CostCounter{"solver_unfinished", "1", "convex problems that ended at the largest number of Newton iterations",
                &FrameCost::solver_unfinished},
};
static_assert(sizeof(FrameCost) == kCostCounters.size() * sizeof(std::uint64_t), "every counter is declared");

}  // namespace verisim

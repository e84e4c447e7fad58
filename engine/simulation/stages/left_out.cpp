#include "engine/simulation/stages/left_out.hpp"

#include <array>

namespace verisim {
namespace {

struct Notice {
  std::uint64_t FrameCost::*count;
  const char* text;
};

constexpr std::array kNotices = {
    Notice{&FrameCost::rows_left_out,
           "precise contacts found no room and did not act (/cost/rows_left_out); use larger voxels"},
    Notice{&FrameCost::memo_overflows,
           "a pair's memo is full: some constraints are recognized anew each time, or not at all "
           "(/cost/memo_overflows); use larger voxels"},
    Notice{&FrameCost::contacts_left_out,
           "contact = \"fcl\" found more contacts than a pair has room for; the rest did not act "
           "(/cost/contacts_left_out)"},
    Notice{&FrameCost::solver_unfinished,
           "the exact response ended before its minimum (/cost/solver_unfinished); use a smaller time step"},
};

}  // namespace

void LeftOut::tell(const FrameCost& cost, double time, std::vector<Event>& events) {
  for (const Notice& notice : kNotices) {
    if (cost.*notice.count == 0 || told_.*notice.count != 0) continue;
    told_.*notice.count = 1;
    events.push_back({time, "left out", notice.text});
  }
}

}  // namespace verisim

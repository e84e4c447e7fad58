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

std::string text_of_notice(const World&, const Note& note) {
  return kNotices[note.first].text;
}

}  // namespace

void LeftOut::tell(const FrameCost& cost, double time, Notes& notes) {
  for (std::size_t i = 0; i < kNotices.size(); ++i) {
    const auto count = kNotices[i].count;
    if (cost.*count == 0 || told_.*count != 0) continue;
    told_.*count = 1;
    notes.add({.time = time, .kind = "left out", .text = text_of_notice, .first = i});
  }
}

}  // namespace verisim

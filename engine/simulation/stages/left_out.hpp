// Tells once what found no room: the first time that a counter of FrameCost says so, an event with the remedy.
#pragma once

#include <vector>

#include "engine/record/run_file.hpp"
#include "engine/simulation/frame_cost.hpp"

namespace verisim {

class LeftOut {
 public:
  void tell(const FrameCost& cost, double time, std::vector<Event>& events);

 private:
  FrameCost told_;  ///< not 0: told
};

}  // namespace verisim

// Tells once what found no room: the first time that a counter of FrameCost says so, a note with the remedy.
#pragma once

#include "engine/simulation/frame_cost.hpp"
#include "engine/simulation/stages/notes.hpp"

namespace verisim {

class LeftOut {
 public:
  void tell(const FrameCost& cost, double time, Notes& notes);

 private:
  FrameCost told_;  ///< not 0: told
};

}  // namespace verisim

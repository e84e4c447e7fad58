// Where the recorded states of two runs part.
#pragma once

#include <string>
#include <vector>

namespace verisim {
class RunFile;
}

namespace verisim::compare {

struct StateDifference {
  std::string first;                        ///< "frame 1201, /state/body/pin/twist[3]: 0.5 in A, 0.25 in B"; or empty
  std::vector<std::string> only_a, only_b;  ///< datasets of /state
};

/// Of the frames that both have, bit by bit; of one frame, the first dataset in the order of A.
[[nodiscard]] StateDifference state_difference(const RunFile& a, const RunFile& b);

}  // namespace verisim::compare

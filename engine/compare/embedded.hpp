// Files of bench/baseline that are built into the program (engine/compare/CMakeLists.txt).
#pragma once

namespace verisim::compare {

extern const char* const kBoundsText;  ///< bounds.json
extern const char* const kTimesText;   ///< times.csv

}  // namespace verisim::compare

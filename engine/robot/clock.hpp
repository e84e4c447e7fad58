// The robot's time: a millisecond after the other, and cycles of its board's clock within one.
#pragma once

#include <cstdint>

#include "firmware_sim/board.hpp"

namespace verisim::robot {

inline constexpr double kMillisecond = 1e-3;  ///< s
inline constexpr std::uint32_t kCyclesPerMillisecond = firmware::kCyclesPerMs;

}  // namespace verisim::robot

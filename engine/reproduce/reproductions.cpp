#include "engine/reproduce/reproductions.hpp"

#include <array>

namespace verisim::reproduce {

std::span<const Reproduction> reproductions() {
  static constexpr std::array kReproductions = {
      Reproduction{"R1", "overruns of the paced trial", &r1_overruns},
      Reproduction{"R2", "passes with and without restoration", &r2_passes},
      Reproduction{"R3", "collisions and cache misses", &r3_collisions},
      Reproduction{"R4", "recognition of a pair (table 7.1)", &r4_recognition},
      Reproduction{"R5", "blending and association", &r5_blending},
      Reproduction{"R6", "the bubble's laws (figure 4.6)", &r6_bubble_laws},
      Reproduction{"R7", "trackable area and volume", &r7_coverage},
      Reproduction{"R8", "the robot's interrupts and top speed", &r8_firmware},
      Reproduction{"R9", "parts whose constraints conflict", &r9_conflicts},
      Reproduction{"R10", "stickiness of the bubble's laws", &r10_stickiness},
      Reproduction{"R11", "transparency of the mobile base", &r11_transparency},
  };
  return kReproductions;
}

}  // namespace verisim::reproduce

// firmware_sim/firmware/velocity.hpp
// Velocity of a motor from its encoder's counts and the time between its edges (M/T method): the edges since the last
// sample, divided by the time from the last edge before them to the last of them. Between standstill and 7000 RPM it
// has the resolution of the clock, 4 us in at least one sample: 0.04 %. C++14 without standard library; one 32-bit
// division.
#pragma once

#include "firmware_sim/firmware/encoder.hpp"
#include "firmware_sim/firmware/robot.hpp"

namespace verisim {
namespace firmware {

class VelocityEstimator {
 public:
  /// Velocity [RPM/16] at the sample that begins with millisecond `now_ms`. To be called once a sample of kSampleMs.
  /// - No edge in this sample: the last velocity, but at most one count in the time since the last edge.
  /// - No edge for 3 s (0.4 RPM): standstill, exactly 0.
  /// - From standstill, where the time before the first edge says nothing: what is certain, the edges after it in a
  /// sample.
  /// - A reversal: edges that cancel give 0.
  int32_t update(const Encoder& encoder, uint16_t now_ms);

 private:
  static uint32_t ticks_between(uint16_t ms, uint8_t tick, uint16_t later_ms, uint8_t later_tick);

  int32_t velocity_ = 0;
  int16_t count_ = 0;
  uint16_t edge_ms_ = 0;  ///< of the last edge that is counted in count_
  uint8_t edge_tick_ = 0;
  bool is_moving_ = false;  ///< there is such an edge, not 3 s ago
};

}  // namespace firmware
}  // namespace verisim

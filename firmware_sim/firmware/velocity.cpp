#include "firmware_sim/firmware/velocity.hpp"

#include "firmware_sim/firmware/arithmetic.hpp"

namespace verisim {
namespace firmware {
namespace {

constexpr uint32_t kStandstillTicks = 3000UL * kTicksPerMs;
constexpr int32_t kOneCountPerTick = kTicksPerMinute / kCountsPerTurn * kPerRpm;  // as a velocity: 5,000,000
constexpr int16_t kCountsMax = 400;  // 400 in a sample are 50,000 RPM: no motor; and 401 times the above wraps

int16_t limited(int16_t counts) {
  if (counts > kCountsMax) return kCountsMax;
  return counts < -kCountsMax ? static_cast<int16_t>(-kCountsMax) : counts;
}

int32_t velocity_of(int16_t counts, uint32_t ticks) {
  return counts * kOneCountPerTick / static_cast<int32_t>(ticks);
}

}  // namespace

uint32_t VelocityEstimator::ticks_between(uint16_t ms, uint8_t tick, uint16_t later_ms, uint8_t later_tick) {
  const auto whole = static_cast<uint16_t>(later_ms - ms);
  return static_cast<uint32_t>(whole) * kTicksPerMs + later_tick - tick;
}

int32_t VelocityEstimator::update(const Encoder& encoder, uint16_t now_ms) {
  const auto counts = static_cast<int16_t>(encoder.count - count_);
  const bool has_edge = counts != 0 || encoder.ms != edge_ms_ || encoder.tick != edge_tick_;
  if (!has_edge) {
    if (!is_moving_) return 0;
    const uint32_t age = ticks_between(edge_ms_, edge_tick_, now_ms, 0);
    if (age >= kStandstillTicks) {
      is_moving_ = false;
      velocity_ = 0;
      return 0;
    }
    const int32_t at_most = velocity_of(1, age > 0 ? age : 1);
    if (velocity_ > at_most) velocity_ = at_most;
    if (velocity_ < -at_most) velocity_ = -at_most;
    return velocity_;
  }
  const uint32_t time = is_moving_ ? ticks_between(edge_ms_, edge_tick_, encoder.ms, encoder.tick) : kStandstillTicks;
  if (time == 0) return velocity_;  // a new edge in the tick of the last one: the next sample counts it
  velocity_ = velocity_of(limited(counts), time);
  const auto sample_ms = static_cast<uint16_t>(now_ms - kSampleMs);
  if (time > 2UL * kSampleMs * kTicksPerMs && magnitude(counts) > 1) {
    // After a pause: all edges but the first came within this sample, which tells more than the pause does.
    const auto rest = static_cast<int16_t>(limited(counts) + (counts > 0 ? -1 : 1));
    const uint32_t sample = ticks_between(sample_ms, 0, encoder.ms, encoder.tick);
    if (sample > 0 && sample <= 2UL * kSampleMs * kTicksPerMs) velocity_ = velocity_of(rest, sample);
  }
  count_ = encoder.count;
  edge_ms_ = encoder.ms;
  edge_tick_ = encoder.tick;
  is_moving_ = true;
  return velocity_;
}

}  // namespace firmware
}  // namespace verisim

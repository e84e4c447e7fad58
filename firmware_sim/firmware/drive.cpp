#include "firmware_sim/firmware/drive.hpp"

#include "firmware_sim/firmware/arithmetic.hpp"

namespace verisim {
namespace firmware {

constexpr Gains Drive::kWheelGains;

namespace {

constexpr int32_t kLimit = kPwmMax * Pid::kOne;

int32_t feed_forward(int32_t setpoint) {
  if (setpoint == 0) return 0;
  return setpoint * Drive::kFeedForward + (setpoint > 0 ? Drive::kBridgePwm : -Drive::kBridgePwm) * Pid::kOne;
}

bool is_below(int32_t velocity, int32_t rpm) {
  return magnitude(velocity) < rpm * kPerRpm;
}

}  // namespace

int16_t Drive::update(const Encoder& encoder, uint16_t now_ms, int32_t setpoint) {
  velocity_ = estimator_.update(encoder, now_ms);
  watch(encoder);
  if (setpoint == 0 && is_below(velocity_, kStandstillRpm)) {
    pid_.reset(velocity_);
    duty_ = 0;
    return 0;
  }
  const int32_t ahead = feed_forward(setpoint);
  duty_ = static_cast<int16_t>(
      rounded(ahead + pid_.update(setpoint, velocity_, -kLimit - ahead, kLimit - ahead), Pid::kOne));
  return duty_;
}

void Drive::idle(const Encoder& encoder, uint16_t now_ms) {
  velocity_ = estimator_.update(encoder, now_ms);
  pid_.reset(velocity_);
  count_ = encoder.count;
  duty_ = 0;
  still_ = against_ = 0;
  contradicts_ = false;
}

void Drive::watch(const Encoder& encoder) {
  const bool is_hard = duty_ >= kHardPwm || duty_ <= -kHardPwm;
  const bool is_still = encoder.count == count_;
  const bool is_against = !is_below(velocity_, kReversedRpm) && (velocity_ < 0) != (duty_ < 0);
  count_ = encoder.count;
  still_ = is_hard && is_still ? static_cast<uint8_t>(still_ + 1) : uint8_t{0};
  against_ = is_hard && is_against ? static_cast<uint8_t>(against_ + 1) : uint8_t{0};
  if (still_ >= kStalledMs / kSampleMs || against_ >= kReversedMs / kSampleMs) contradicts_ = true;
}

}  // namespace firmware
}  // namespace verisim

#include "firmware_sim/firmware/mecanum.hpp"

#include "firmware_sim/firmware/arithmetic.hpp"

namespace verisim {
namespace firmware {
namespace {

constexpr uint32_t kGain = 5000;
// RPM/16 of a motor for 0.1 mm/s of a wheel's rim: 64 * 60 / (2 pi * 50 mm) * 16 / 10 = 19.55696, in 1/4096.
constexpr int32_t kRpmPerTenth = 80105;
constexpr int32_t kFastest = kRpmMax * kPerRpm;
constexpr int32_t kTenthsMax = 16383;  // times kFastest stays below 2^31

}  // namespace

Setpoints setpoints_for(int32_t vx, int32_t vy, int32_t omega) {
  const int32_t x = 10 * vx;
  const int32_t y = 10 * vy;
  const int32_t turn = 3 * omega;  // 300 mm * 1 mrad/s is 0.3 mm/s
  Setpoints at{{x - y - turn, x + y + turn, x + y - turn, x - y + turn}};
  int32_t fastest = 0;
  for (const int32_t wheel : at.wheels) fastest = magnitude(wheel) > fastest ? magnitude(wheel) : fastest;
  for (; fastest > kTenthsMax; fastest /= 2)
    for (int32_t& wheel : at.wheels) wheel /= 2;
  const bool is_in_reach = fastest * kRpmPerTenth / 4096 <= kFastest;
  for (int32_t& wheel : at.wheels)
    wheel = is_in_reach ? rounded(wheel * kRpmPerTenth, 4096) : rounded(wheel * kFastest, fastest);
  return at;
}

bool velocity_for_error(const float& error, int32_t& velocity) {
  uint32_t bits;
  static_assert(sizeof bits == sizeof error, "float32");
  __builtin_memcpy(&bits, &error, sizeof bits);
  const auto exponent = static_cast<uint8_t>(bits >> 23);
  const uint32_t fraction = bits & 0x7fffffUL;
  if (exponent == 255 && fraction != 0) return false;
  uint32_t magnitude = 0;
  if (exponent >= 127 + 11) {  // 2048 m and more, infinity too
    magnitude = kVelocityMax;
  } else if (exponent >= 127 - 14) {  // less is below half a mm/s: 5000 / 2^14 = 0.31, and rounds to 0
    const uint64_t product = static_cast<uint64_t>(fraction | 0x800000UL) * kGain;  // error = fraction 2^(exponent-150)
    const auto shift = static_cast<uint8_t>(150 - exponent);                        // 13 to 37
    const auto half = static_cast<uint64_t>(1) << (shift - 1);
    const uint64_t whole = (product + half) >> shift;
    magnitude = whole > static_cast<uint64_t>(kVelocityMax) ? kVelocityMax : static_cast<uint32_t>(whole);
  }
  velocity = static_cast<int32_t>(magnitude);
  if ((bits >> 31) != 0) velocity = -velocity;
  return true;
}

}  // namespace firmware
}  // namespace verisim

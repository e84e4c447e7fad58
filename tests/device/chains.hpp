// Recorded hands that move at random, and the frames that drive them.
#pragma once

#include "engine/device/sources.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::test {

inline constexpr double kStep = 1e-3;  // s

[[nodiscard]] inline DeviceFrame frame_at(std::uint64_t number, std::uint32_t collisions = 0, bool starts = false) {
  return {number, static_cast<double>(number) * kStep, kStep, collisions, starts};
}

/// A trace with a pose at random, within `reach` of the origin, every 20 ms.
[[nodiscard]] inline std::shared_ptr<Device> random_motion(std::uint64_t seed, double reach) {
  Inputs inputs(seed);
  HapticSamples samples;
  for (int i = 0; i < 12; ++i) {
    samples.t.push_back(0.02 * i);
    samples.pose.push_back({inputs.vector(reach), inputs.rotation()});
  }
  return make_replay("trace", std::move(samples));
}

/// A hand that holds still.
[[nodiscard]] inline std::shared_ptr<Device> still_at(const Vector3d& position) {
  return make_replay("trace", {{0}, {{position, Quaterniond::Identity()}}, {}});
}

}  // namespace verisim::test

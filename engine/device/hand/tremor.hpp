// Physiological tremor: 8 to 12 Hz, here four sines per axis with random frequencies in that band and phases, so that
// it is a function of time alone.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "engine/base/pinned_math.hpp"
#include "engine/base/pose.hpp"
#include "engine/base/random.hpp"

namespace verisim {

class Tremor {
 public:
  /// @param rms  of each axis
  Tremor(std::uint64_t seed, const std::string& name, double rms) : amplitude_(rms * std::sqrt(2.0 / kSines)) {
    const RandomStream stream(seed, name);
    std::uint64_t counter = 0;
    for (auto& axis : waves_)
      for (Wave& wave : axis) {
        wave.omega = 2 * pinned::kPi * (8 + 4 * stream.uniform(counter++));
        wave.phase = 2 * pinned::kPi * stream.uniform(counter++);
      }
  }
  [[nodiscard]] Vector3d at(double t) const {
    if (amplitude_ == 0) return Vector3d::Zero();
    Vector3d sum = Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis)
      for (const Wave& wave : waves_[static_cast<std::size_t>(axis)])
        sum[axis] += pinned::sin(wave.omega * t + wave.phase);
    return amplitude_ * sum;
  }

 private:
  static constexpr int kSines = 4;
  struct Wave {
    double omega, phase;
  };
  double amplitude_;
  std::array<std::array<Wave, kSines>, 3> waves_{};
};

}  // namespace verisim

// Seeded random inputs for laws that hold for all of them. A failing case names its seed: the seed is the bug report.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/base/random.hpp"

namespace verisim::test {

/// The numbers 1 to n, to loop over under SCOPED_TRACE.
[[nodiscard]] inline std::vector<std::uint64_t> seeds(std::uint64_t n) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t seed = 1; seed <= n; ++seed) all.push_back(seed);
  return all;
}

/// Draws one input after the other from one seed.
class Inputs {
 public:
  explicit Inputs(std::uint64_t seed) : stream_(seed, "test inputs") {}
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * stream_.uniform(next_++); }
  /// Each component in [-scale, scale].
  [[nodiscard]] Vector3d vector(double scale) {
    Vector3d v;
    for (double& x : v) x = between(-scale, scale);
    return v;
  }
  /// Uniform over all rotations (normalised normal numbers).
  [[nodiscard]] Quaterniond rotation() {
    Eigen::Vector4d q;
    for (double& x : q) x = stream_.normal(next_++);
    return Quaterniond(q.normalized());
  }
  [[nodiscard]] Pose pose(double scale) {
    const Vector3d p = vector(scale);
    return {p, rotation()};
  }

 private:
  RandomStream stream_;
  std::uint64_t next_ = 0;
};

}  // namespace verisim::test

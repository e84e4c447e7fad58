// Contacts of a pair of bodies for tests and benchmarks of the constraint link.
#pragma once

#include <vector>

#include "engine/constraint/constraint_link.hpp"

namespace verisim::test {

/// Contacts as rows, given to the link as columns.
struct Contacts {
  std::vector<float> x, y, z, fx, fy, fz;
  std::vector<FeatureSetId> a, b;
  Vector3d origin = Vector3d(-0.3, -0.2, -0.1);  ///< m, what points are stored relative to

  void add(const Vector3d& point, const Vector3d& force, FeatureSetId set_a, FeatureSetId set_b) {
    const Eigen::Vector3f p = (point - origin).cast<float>();
    const Eigen::Vector3f f = force.cast<float>();
    x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    fx.push_back(f.x()), fy.push_back(f.y()), fz.push_back(f.z());
    a.push_back(set_a), b.push_back(set_b);
  }
  ContactColumns columns() {
    return {static_cast<std::uint32_t>(x.size()),
            x.data(),
            y.data(),
            z.data(),
            fx.data(),
            fy.data(),
            fz.data(),
            a.data(),
            b.data(),
            origin};
  }
  [[nodiscard]] Vector3d force(std::size_t i) const { return Vector3d(fx[i], fy[i], fz[i]); }
  [[nodiscard]] Vector3d point(std::size_t i) const { return origin + Vector3d(x[i], y[i], z[i]); }
};

}  // namespace verisim::test

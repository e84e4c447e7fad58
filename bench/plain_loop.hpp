// The unit of comparison: a plain scalar voxmap loop, as anyone would write it for one pair of bodies. Double, one
// dense table of layers, one look-up a point; it accumulates the force and the torque and keeps no list, no culling.
#pragma once

#include <cmath>
#include <vector>

#include "engine/contact/penalty.hpp"

namespace verisim::bench {

class PlainLoop {
 public:
  PlainLoop(const Voxmap& a, const Pointshell& b);
  /// Force on B and its torque about A's grid origin; body coordinates of A.
  [[nodiscard]] Wrench force(const Pose& X_AB, double stiffness) const;

 private:
  struct Point {
    double x, y, z, nx, ny, nz;
  };
  std::vector<Point> points_;
  std::vector<Layer> layers_;
  Eigen::Vector3i cells_;
  Vector3d origin_;
  double voxel_size_;
};

inline PlainLoop::PlainLoop(const Voxmap& a, const Pointshell& b)
    : cells_(a.bricks * kBrickSide), origin_(a.origin), voxel_size_(a.voxel_size) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Vector3d p = b.reference + Vector3f(b.x[i], b.y[i], b.z[i]).cast<double>();
    points_.push_back({p.x(), p.y(), p.z(), b.nx[i], b.ny[i], b.nz[i]});
  }
  for (int z = 0; z < cells_.z(); ++z) {
    for (int y = 0; y < cells_.y(); ++y) {
      for (int x = 0; x < cells_.x(); ++x) layers_.push_back(a.layer({x, y, z}));
    }
  }
}

inline Wrench PlainLoop::force(const Pose& X_AB, double stiffness) const {
  const Matrix3d R = X_AB.rotation.toRotationMatrix();
  const Matrix3d G = R / voxel_size_;
  const Vector3d t = (X_AB.position - origin_) / voxel_size_;
  const auto nx = static_cast<unsigned>(cells_.x());
  const auto ny = static_cast<unsigned>(cells_.y());
  const auto nz = static_cast<unsigned>(cells_.z());
  Wrench w;
  for (const Point& p : points_) {
    const double gx = G(0, 0) * p.x + G(0, 1) * p.y + G(0, 2) * p.z + t.x();
    const double gy = G(1, 0) * p.x + G(1, 1) * p.y + G(1, 2) * p.z + t.y();
    const double gz = G(2, 0) * p.x + G(2, 1) * p.y + G(2, 2) * p.z + t.z();
    // Truncation is floor for what is inside the grid; its border of empty voxels hides what rounds up from below zero.
    const auto i = static_cast<unsigned>(static_cast<int>(gx));
    const auto j = static_cast<unsigned>(static_cast<int>(gy));
    const auto k = static_cast<unsigned>(static_cast<int>(gz));
    if (i >= nx || j >= ny || k >= nz) continue;
    const Layer layer = layers_[i + std::size_t{nx} * (j + std::size_t{ny} * k)];
    if (layer > 0) continue;
    const Vector3d n = R * Vector3d(p.nx, p.ny, p.nz);
    const Vector3d to_center(i + 0.5 - gx, j + 0.5 - gy, k + 0.5 - gz);
    const double depth = (to_center.dot(n) - layer) * voxel_size_;
    if (depth <= 0) continue;
    const Vector3d f = stiffness * depth * n;
    w.force += f;
    w.torque += voxel_size_ * Vector3d(gx, gy, gz).cross(f);
  }
  return w;
}

}  // namespace verisim::bench

// The image sensor's geometry: an ideal pinhole whose two focal lengths follow from two fields of view.
//
// u = 512 + fx X/Z, v = 384 + fy Y/Z with (X, Y, Z) in remote coordinates R. Dissertation section 2.8: 43 x 32 degrees,
// hence fx = 512 / tan(21.5 deg) = 1299.8 and fy = 384 / tan(16 deg) = 1339.2 (ORACLES section 2 "Pinhole sensor").
#pragma once

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/pose.hpp"
#include "engine/wii/channels.hpp"

namespace verisim::wii {

inline constexpr double kDegree = pinned::kPi / 180;

/// Fields of view, rad. Other sources give 42 x 31.5, 45 x 27 or 33 x 23 degrees.
struct FieldOfView {
  double horizontal = 43 * kDegree;
  double vertical = 32 * kDegree;
};

/// Is it one that a lens can have? What every door asks of a user's.
[[nodiscard]] inline bool is_field_of_view(const FieldOfView& fov) {
  return fov.horizontal > 0 && fov.horizontal < pinned::kPi && fov.vertical > 0 && fov.vertical < pinned::kPi;
}

struct Pinhole {
  double fx = 0;  ///< pixel
  double fy = 0;  ///< pixel

  /// @pre is_field_of_view(fov)
  explicit Pinhole(const FieldOfView& fov)
      : fx(kWidth / 2 / pinned::tan(fov.horizontal / 2)), fy(kHeight / 2 / pinned::tan(fov.vertical / 2)) {
    VERISIM_ASSERT(is_field_of_view(fov));
  }

  /// The direction (X/Z, Y/Z, 1) that ends in pixel (u, v).
  [[nodiscard]] Vector3d ray(double u, double v) const { return {(u - kWidth / 2) / fx, (v - kHeight / 2) / fy, 1}; }
  /// The pixel of a point. @pre p_R.z() > 0
  [[nodiscard]] Eigen::Vector2d project(const Vector3d& p_R) const {
    VERISIM_ASSERT(p_R.z() > 0);
    return {kWidth / 2 + fx * p_R.x() / p_R.z(), kHeight / 2 + fy * p_R.y() / p_R.z()};
  }
};

}  // namespace verisim::wii

// Every sort of analytic surface by its parametrization (engine/geometry/entity.hpp), written here once more, in a
// place of a seed: what tests hold distances, normals and charts against.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include "engine/geometry/analytic_surface.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::testing {

constexpr double kWholeTurn = 2 * std::numbers::pi;

/// The stretch u, v of a surface that is compared, and how deep around it no other part of the surface is nearer.
struct SurfaceSort {
  const char* name;
  Surface (*make)(const Pose& at, bool hole);
  Vector3d (*point)(double u, double v);  ///< in the surface's own axes
  std::array<double, 2> u, v;
  double depth;         ///< m
  double outwards = 1;  ///< -1 where by_u x by_v points to the inside of the round surface

  friend void PrintTo(const SurfaceSort& sort, std::ostream* out) { *out << sort.name; }
};

inline Vector3d axis_of(const Pose& at, int i) {
  return at.rotation.toRotationMatrix().col(i);
}
inline Vector3d ring_at(double u) {
  return {std::cos(u), std::sin(u), 0};
}

constexpr double kRadius = 0.03, kAngle = 0.4, kMajor = 0.05, kMinor = 0.01, kWide = 0.07;

template <int kMinorMillimetres>
Surface torus_at(const Pose& at, bool hole) {
  return Torus{at.position, axis_of(at, 2), axis_of(at, 0), kMajor, 0.001 * kMinorMillimetres, hole};
}
template <int kMinorMillimetres>
Vector3d torus_point(double u, double v) {
  constexpr double kTubeRadius = 0.001 * kMinorMillimetres;
  return (kMajor + kTubeRadius * std::cos(v)) * ring_at(u) + Vector3d(0, 0, kTubeRadius * std::sin(v));
}

inline const SurfaceSort kSurfaceSorts[] = {
    {"plane",
     [](const Pose& at, bool) -> Surface {
       return Plane{at.position, axis_of(at, 2), axis_of(at, 0)};
     },
     [](double u, double v) { return Vector3d(u, v, 0); },
     {-0.05, 0.05},
     {-0.05, 0.05},
     0.02},
    {"cylinder",
     [](const Pose& at, bool hole) -> Surface {
       return Cylinder{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, hole};
     },
     [](double u, double v) { return Vector3d(kRadius * ring_at(u) + Vector3d(0, 0, v)); },
     {0, kWholeTurn},
     {-0.05, 0.05},
     0.02},
    {"cone",
     [](const Pose& at, bool hole) -> Surface {
       return Cone{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, kAngle, hole};
     },
     [](double u, double v) { return Vector3d((kRadius + v * std::tan(kAngle)) * ring_at(u) + Vector3d(0, 0, v)); },
     {0, kWholeTurn},
     {-0.02, 0.04},
     0.01},
    {"sphere",
     [](const Pose& at, bool hole) -> Surface {
       return Sphere{at.position, axis_of(at, 2), axis_of(at, 0), kRadius, hole};
     },
     [](double u, double v) { return Vector3d(kRadius * (std::cos(v) * ring_at(u) + Vector3d(0, 0, std::sin(v)))); },
     {0, kWholeTurn},
     {-1.5, 1.5},
     0.02},
    {"torus", torus_at<10>, torus_point<10>, {0, kWholeTurn}, {0, kWholeTurn}, 0.008},
    // A tube wider than its ring meets itself at cos v = -5/7, 2.366 rad: outside, and inside beyond the axis.
    {"apple", torus_at<70>, torus_point<70>, {0, kWholeTurn}, {-2.1, 2.1}, 0.008},
    {"lemon", torus_at<70>, torus_point<70>, {0, kWholeTurn}, {2.6, 3.6}, 0.008, -1},
};

/// A sort in a random place, hole or not.
class PlacedSort {
 public:
  PlacedSort(const SurfaceSort& sort, std::uint64_t seed) : sort_(sort) {
    test::Inputs inputs(seed);
    at_ = inputs.pose(0.1);
    hole_ = seed % 2 == 1 && std::string(sort.name) != "plane";
    face_.surface = sort.make(at_, hole_);
    face_.u_range = sort.u;
    face_.v_range = sort.v;
  }

  [[nodiscard]] const Face& face() const { return face_; }
  [[nodiscard]] const Pose& at() const { return at_; }
  [[nodiscard]] AnalyticSurface surface() const { return *AnalyticSurface::from(face_); }
  [[nodiscard]] Vector3d on(double u, double v) const { return at_ * sort_.point(u, v); }
  /// Out of the material, from the parametrization.
  [[nodiscard]] Vector3d normal(double u, double v) const {
    constexpr double kStep = 1e-6;
    const Vector3d by_u = on(u + kStep, v) - on(u - kStep, v);
    const Vector3d by_v = on(u, v + kStep) - on(u, v - kStep);
    return by_u.cross(by_v).normalized() * (hole_ ? -1 : 1) * sort_.outwards;
  }

 private:
  const SurfaceSort& sort_;
  Pose at_;
  bool hole_ = false;
  Face face_;
};

}  // namespace verisim::testing

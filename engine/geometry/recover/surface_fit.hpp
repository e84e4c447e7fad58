// Surfaces by least squares through vertices.
//
// A tessellation's vertices lie on the surface that it stands for, its triangles do not: triangles give the first
// guess, vertices the result (Gauss-Newton with damping, on the distances).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

/// What a surface is fitted to, m.
struct Sample {
  std::vector<Vector3d> points;   ///< vertices, each once
  std::vector<Vector3d> centers;  ///< of the facets between them …
  std::vector<Vector3d> normals;  ///< … and their normals
};

/// The surface of this kind that is nearest to the points; none if they do not determine one. What stays many
/// tolerances away [m] is given up early. A torus of negative major radius is the part of a tube that has passed the
/// axis. @pre as many centers as normals; the tolerance is finite and above 0, here and below
[[nodiscard]] std::optional<SurfaceValue> fit(Kind kind, const Sample& sample, double tolerance,
                                              const RecoverThresholds& thresholds);
/// The same from a first guess.
[[nodiscard]] std::optional<SurfaceValue> refit(const SurfaceValue& guess, std::span<const Vector3d> points,
                                                double tolerance, const RecoverThresholds& thresholds);

/// The circle nearest to points of a plane, algebraically: center and radius.
[[nodiscard]] std::optional<Vector3d> circle_through(std::span<const Eigen::Vector2d> points);
/// The plane nearest to points. @pre there are some
[[nodiscard]] SurfaceValue plane_through(std::span<const Vector3d> points);

}  // namespace verisim::recover

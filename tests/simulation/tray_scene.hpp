// Boxes that fall into a tray, any way up, and how deep they overlap: by geometry from poses alone. Metres.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/random.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::tray {

constexpr double kSide = 0.03, kWall = 0.15;

/// A tray of the inner width `tray` with its floor at z = 0, and boxes above it that do not overlap.
inline Scene scene_of(int boxes, double tray, std::uint64_t seed, double voxel_size) {
  constexpr double kApart = 0.053, kThick = 0.02;  // the boxes' diagonal is 0.052
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = {0, 0, -9.81};
  const double outer = tray + 2 * kThick;
  const auto placed = [](std::shared_ptr<const Solid> of, double z) {
    return std::make_shared<Solid>(
        Solid{Solid::Kind::placed, {}, {std::move(of)}, {{0, 0, z}, Quaterniond::Identity()}});
  };
  const auto block = placed(scenes::solid(Solid::Kind::box, {outer, outer, kWall + kThick}), (kWall - kThick) / 2);
  const auto inside = placed(scenes::solid(Solid::Kind::box, {tray, tray, 2 * kWall}), kWall);
  scene.bodies.push_back(scenes::body_of("tray", scenes::difference(block, inside), voxel_size));
  scene.bodies[0].fixed = true;
  const BodyDescription box =
      scenes::body_of("box", *scenes::solid(Solid::Kind::box, {kSide, kSide, kSide}), voxel_size);
  const RandomStream random(seed, "tray");
  const int across = std::max(1, static_cast<int>((tray - kApart) / kApart) + 1);
  for (int i = 0; i < boxes; ++i) {
    BodyDescription& body = scene.bodies.emplace_back(box);
    body.name = "box" + std::to_string(i);
    body.density = 1000;
    const auto near = [&](int n) { return (n - 0.5 * (across - 1)) * kApart; };
    body.X_WB.position = {near(i % across), near(i / across % across), kSide + i / (across * across) * kApart};
    const auto draw = [&](int k) { return 2 * random.uniform(static_cast<std::uint64_t>(4 * i + k)) - 1; };
    body.X_WB.rotation = rotation_from_vector(3 * Vector3d(draw(0), draw(1), draw(2)));
  }
  return scene;
}

/// How far two boxes of kSide would have to be moved along the one of 15 directions in which that is least; 0: they are
/// apart.
inline double overlap(const Pose& a, const Pose& b) {
  const Matrix3d A = a.rotation.toRotationMatrix(), B = b.rotation.toRotationMatrix();
  const Vector3d apart = b.position - a.position;
  double least = 1;
  const auto look = [&](const Vector3d& n) {
    const double length = n.norm();
    if (length < 1e-6) return;
    const double reach = 0.5 * kSide * ((A.transpose() * n).lpNorm<1>() + (B.transpose() * n).lpNorm<1>());
    least = std::min(least, (reach - std::abs(apart.dot(n))) / length);
  };
  for (int i = 0; i < 3; ++i) {
    look(A.col(i));
    look(B.col(i));
    for (int j = 0; j < 3; ++j) look(A.col(i).cross(B.col(j)));
  }
  return std::max(0.0, least);
}

/// How far a box reaches through the tray's floor or walls; 0: not at all.
inline double overlap_with_tray(const Pose& box, double tray) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d p = box * (kSide * Vector3d((corner & 1) - 0.5, (corner >> 1 & 1) - 0.5, (corner >> 2) - 0.5));
    if (p.z() > kWall) continue;
    most = std::max({most, -p.z(), std::abs(p.x()) - tray / 2, std::abs(p.y()) - tray / 2});
  }
  return most;
}

/// Of all boxes with each other that overlap, and with the tray.
inline void add_overlaps(const Simulation& simulation, double tray, std::vector<double>& between,
                         std::vector<double>& with_tray) {
  for (std::size_t i = 1; i < simulation.body_count(); ++i) {
    const Pose a = simulation.body_pose(i);
    if (const double deep = overlap_with_tray(a, tray); deep > 0) with_tray.push_back(deep);
    for (std::size_t j = 1; j < i; ++j) {
      const Pose b = simulation.body_pose(j);
      if ((a.position - b.position).norm() > kSide * 1.7321) continue;
      if (const double deep = overlap(a, b); deep > 0) between.push_back(deep);
    }
  }
}

}  // namespace verisim::tray

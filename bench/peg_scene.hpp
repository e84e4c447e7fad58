// The pin and the block whose poses others were measured on (../shared/reference/peers/README.md): pin of radius 70 mm
// and length 400 mm in a block of 0.375 x 0.375 x 0.2 m with a hole of radius 75 mm. Origins in the middle of each,
// axis z.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/support/paths.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::bench {

inline constexpr double kPinRadius = 0.070, kPinHeight = 0.400, kHoleRadius = 0.075;
inline const Vector3d kBlockHalf(0.1875, 0.1875, 0.1);

inline TriangleMesh pin_mesh(int facets) {
  return shapes::mapped(shapes::cylinder(kPinRadius, kPinHeight, facets),
                        [](const Vector3d& p) { return Vector3d(p.x(), p.y(), p.z() - kPinHeight / 2); });
}

struct PegScene {
  VoxelBody block, pin;
};

inline PegScene make_peg_scene(double voxel_size) {
  constexpr int kFacets = 600;
  const VoxelizeOptions options{.voxel_size = voxel_size};
  return {voxelize("block", shapes::trial_block(kFacets), options), voxelize("pin", pin_mesh(kFacets), options)};
}

/// The recorded poses X_AB of the pin in the block, and the analytic depth of each [m]. Empty if the file is absent.
struct PegPoses {
  std::vector<Pose> X_AB;
  std::vector<double> depth;
};

inline PegPoses load_peg_poses() {
  PegPoses poses;
  std::ifstream file(paths::in_shared_reference("peers/peg_poses.csv"));
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    for (char& c : line) c = c == ',' ? ' ' : c;
    std::istringstream fields(line);
    double id, x, y, z, qw, qx, qy, qz, insertion, depth;
    fields >> id >> x >> y >> z >> qw >> qx >> qy >> qz >> insertion >> depth;
    poses.X_AB.push_back({{x, y, z}, Quaterniond(qw, qx, qy, qz).normalized()});
    poses.depth.push_back(depth);
  }
  return poses;
}

}  // namespace verisim::bench

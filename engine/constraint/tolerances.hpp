// Tolerances of recognition: how closely two entities must match in size to give a constraint. Recognition does not
// depend on the pose; alignment does (alignment.hpp).
#pragma once

namespace verisim {

struct Tolerances {
  /// Widest fit: (hole - pin) / hole. The dissertation's pin has 0.067; engine/geometry's mating_candidates uses the
  /// same bound.
  double clearance_relative_max = 0.15;
  /// A pin may be larger than its hole by this much [m]: rounding of model files, far below any press fit (H7/p6 at
  /// 3 mm: 1e-6). A press fit is no pair: to free its sliding would let it in without force.
  double interference_max = 1e-8;
  /// Difference of two cones' half angles [rad]: half a degree, one voxel of 4.5 mm over half a metre of flank.
  double half_angle_difference_max = 0.00873;
  /// Difference of two tori's core radii over the larger one.
  double core_relative_max = 0.02;
};

}  // namespace verisim

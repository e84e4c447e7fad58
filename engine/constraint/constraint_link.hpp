// The hybrid method `restore` between two bodies: looks up the constraints of each contact and restores its force.
//
// Source: dissertation sections 6.4.2 (stateful constraints: what depends on the pose is computed once per frame) and
// 8.2.2. One ConstraintLink per collision link. Body coordinates of A, in which contacts are given; forces act on B.
// Does not know voxels. No allocation after construction.
//
// Order of a frame:
//     link.begin_frame(X_AB);
//     RestoreResult r = link.restore_contacts(columns);      // or look_up_contacts, which leaves forces alone
//     ... link.engaged() ...                                 // the constraints of this frame (blend.hpp)
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/constraint/alignment.hpp"
#include "engine/constraint/memo.hpp"
#include "engine/constraint/restoration.hpp"

namespace verisim {

/// The contacts of one frame as columns of `size` rows. All arrays belong to the caller.
struct ContactColumns {                 //  unit  meaning
  std::uint32_t size = 0;               //
  const float* x = nullptr;             //  m     the point, coordinates A, relative to `origin`
  const float* y = nullptr;             //
  const float* z = nullptr;             //
  float* fx = nullptr;                  //  N     force on B, coordinates A
  float* fy = nullptr;                  //
  float* fz = nullptr;                  //
  const FeatureSetId* set_a = nullptr;  //  -     set of A's voxel, 0: none
  const FeatureSetId* set_b = nullptr;  //  -     set of B's point
  Vector3d origin = Vector3d::Zero();   //  m     of x, y, z in A (the voxmap's grid origin)
};

struct ConstraintOptions {
  AlignmentMeasure measure = AlignmentMeasure::by_type;
  AlignmentScales scales = {};
  Reduction reduction = Reduction::common_freedom;
  Tolerances tolerances = {};
  MemoLimits limits = {};
};

/// Result of one frame. `kind` and `alpha` are those of the contact with the largest alpha, of equal ones the first
/// (run file: `constraint`, `alignment`).
struct RestoreResult {
  ConstraintKind kind = ConstraintKind::none;
  double alpha = 0;
  std::uint32_t hits = 0;      ///< memoized look-ups
  std::uint32_t misses = 0;    ///< look-ups that needed recognition
  std::uint32_t restored = 0;  ///< contacts under at least one aligned constraint
};

/// A constraint under which at least one contact of this frame stands.
struct Engaged {
  const Constraint* constraint = nullptr;
  double alpha = 0;
  std::uint32_t contacts = 0;
};

class ConstraintLink {
 public:
  /// Both must outlive the link. @pre options.scales.voxel_size > 0
  ConstraintLink(const EntitySets& a, const EntitySets& b, const ConstraintOptions& options = {});

  /// Sets the pose of a new frame. If it is not finite, no constraint engages in this frame.
  /// @pre the rotation is unit, if finite
  void begin_frame(const Pose& X_AB);

  /// Looks up every contact and restores its force in place. About 5 ns per contact, and 100 ns per constraint.
  /// @pre no column is null, unless there are no contacts; the origin is finite
  RestoreResult restore_contacts(const ContactColumns& contacts);
  /// The same look-ups without a change of forces (fx, fy, fz may be null): for comparators and statistics.
  /// @pre the columns of sets are not null, unless there are no contacts
  RestoreResult look_up_contacts(const ContactColumns& contacts);

  /// The constraints of this frame's contacts, in the order of their first contacts. Valid until begin_frame.
  [[nodiscard]] std::span<const Engaged> engaged() const { return engaged_; }
  [[nodiscard]] const MemoCounts& counts() const { return memo_.counts(); }

 private:
  /// Pose-dependent state of one constraint. Valid if `stamp` is this frame's.
  struct InFrame {
    std::uint64_t stamp = 0;
    std::uint32_t engaged = 0;  ///< index in engaged_ plus one; 0: not engaged
    ActiveConstraint active;
  };
  /// The aligned constraints of one pair of feature sets in this frame: at most the three best aligned.
  struct ActiveSet {
    std::uint64_t stamp = 0;
    std::uint32_t count = 0;
    std::array<std::uint16_t, kActiveMax> constraint = {};
    std::array<double, kActiveMax> alpha = {};
    std::array<const ActiveConstraint*, kActiveMax> active = {};
  };

  template <bool restore_forces>
  RestoreResult walk(const ContactColumns& contacts);
  const ActiveSet& active_set(std::uint32_t candidates);
  void fill(ActiveSet& h, const Candidates& found);
  const ActiveConstraint& active(std::uint32_t constraint);
  static void restore_by(const ActiveSet& h, const ContactColumns& contacts, std::uint32_t begin, std::uint32_t end);
  void count_engaged(const ActiveSet& h, std::uint32_t contacts);

  ConstraintOptions options_;
  ConstraintMemo memo_;
  Pose X_AB_;
  bool pose_is_finite_ = false;
  std::uint64_t stamp_ = 0;
  std::vector<InFrame> in_frame_;       ///< by constraint
  std::vector<ActiveSet> active_sets_;  ///< by candidates
  std::vector<Engaged> engaged_;
};

}  // namespace verisim

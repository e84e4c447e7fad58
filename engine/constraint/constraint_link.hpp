// The hybrid method between two bodies: contacts with their set ids come in, their forces go out restored.
//
// Source: dissertation sections 6.4.2 (stateful constraints: what depends on the pose is found once a frame) and 8.2.2.
// One ConstraintLink per collision link. Coordinates: body coordinates of A (the body in whose coordinates the contacts
// are); forces act on B. Nothing here knows what a voxel is, and nothing allocates after construction.
//
// Order of a frame:
//     link.begin_frame(X_AB);
//     RestoreResult r = link.restore_contacts(columns);      // or look_up_contacts: the same without touching forces
//     ... link.engaged() ...                                 // constraints met in this frame (blend.hpp)
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

/// One frame's look-ups. The constraint is that of the contact with the largest alpha (run file: `constraint`,
/// `alignment`); of equal ones the first.
struct RestoreResult {
  ConstraintKind kind = ConstraintKind::none;
  double alpha = 0;
  std::uint32_t hits = 0;      ///< memoized look-ups
  std::uint32_t misses = 0;    ///< look-ups that had to be recognized
  std::uint32_t restored = 0;  ///< contacts under at least one aligned constraint
};

/// A constraint that at least one contact of this frame stands under.
struct Engaged {
  const Constraint* constraint = nullptr;
  double alpha = 0;
  std::uint32_t contacts = 0;
};

class ConstraintLink {
 public:
  /// Both must outlive the link. @pre options.scales.voxel_size > 0
  ConstraintLink(const EntitySets& a, const EntitySets& b, const ConstraintOptions& options = {});

  /// Forgets what depended on the last pose. A pose that is not finite engages nothing in this frame.
  /// @pre the rotation is unit, if finite
  void begin_frame(const Pose& X_AB);

  /// Looks every contact up and restores its force in place. About 5 ns a contact; per constraint met, 100 ns a frame.
  /// @pre no column is null, unless there are no contacts; the origin is finite
  RestoreResult restore_contacts(const ContactColumns& contacts);
  /// The same look-ups with forces left alone (fx, fy, fz may be null): for comparators and statistics.
  /// @pre the columns of sets are not null, unless there are no contacts
  RestoreResult look_up_contacts(const ContactColumns& contacts);

  /// What the contacts looked up in this frame stand under, in the order of first meeting. Valid until begin_frame.
  [[nodiscard]] std::span<const Engaged> engaged() const { return engaged_; }
  [[nodiscard]] const MemoCounts& counts() const { return memo_.counts(); }

 private:
  /// Pose-dependent state of one constraint; of this frame if the stamp is.
  struct InFrame {
    std::uint64_t stamp = 0;
    std::uint32_t engaged = 0;  ///< place in engaged_ plus one
    ActiveConstraint active;
  };
  /// What holds for one pair of sets in this frame.
  struct Holding {
    std::uint64_t stamp = 0;
    std::uint32_t count = 0;
    std::array<std::uint16_t, kHoldingMax> constraint = {};
    std::array<double, kHoldingMax> alpha = {};
    std::array<const ActiveConstraint*, kHoldingMax> active = {};
  };

  template <bool restore_forces>
  RestoreResult walk(const ContactColumns& contacts);
  const Holding& holding(std::uint32_t candidates);
  void fill(Holding& h, const Candidates& found);
  const ActiveConstraint& active(std::uint32_t constraint);
  static void restore_under(const Holding& h, const ContactColumns& contacts, std::uint32_t begin, std::uint32_t end);
  void count_engaged(const Holding& h, std::uint32_t contacts);

  ConstraintOptions options_;
  ConstraintMemo memo_;
  Pose X_AB_;
  bool pose_is_finite_ = false;
  std::uint64_t stamp_ = 0;
  std::vector<InFrame> in_frame_;  ///< by constraint
  std::vector<Holding> holdings_;  ///< by candidates
  std::vector<Engaged> engaged_;
};

}  // namespace verisim

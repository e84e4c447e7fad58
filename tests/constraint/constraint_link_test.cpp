// The hybrid method between two bodies, contact by contact.
#include "engine/constraint/constraint_link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/constraint/contacts.hpp"
#include "tests/constraint/parts.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::constraint_link_test {
namespace {

namespace block = test::block_set;
namespace pin = test::pin_set;
using test::Contacts;
using test::tolerance;

Pose at(double x, double y, double z) {
  return {{x, y, z}, Quaterniond::Identity()};
}

// Forces are in float: 10 N to 1e-6 N.
constexpr double kFloat = 2e-6;

// A pin inside its clearance slides and turns freely: what is left of any force is radial.
TEST(ConstraintLink, LetsAPinSlideAndTurn) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts;
  contacts.add({0.075, 0, 0.02}, {-3, 2, 5}, block::wall, pin::side);
  contacts.add({0, -0.075, 0.1}, {1, 4, 7}, block::rim, pin::side);
  link.begin_frame(at(0.003, 0, 0));
  const RestoreResult r = link.restore_contacts(contacts.columns());
  EXPECT_LE((contacts.force(0) - Vector3d(-3, 0, 0)).norm(), tolerance(kFloat));
  EXPECT_LE((contacts.force(1) - Vector3d(0, 4, 0)).norm(), tolerance(kFloat));
  EXPECT_EQ(r.kind, ConstraintKind::cylindrical);
  EXPECT_EQ(r.alpha, 1);
  EXPECT_EQ(r.misses, 2U);
  EXPECT_EQ(r.hits, 0U);
  EXPECT_EQ(r.restored, 2U);
}

// The constraints at a rim. A pin that is clear of the hole: the top alone. A pin that is a voxel deep in the hole,
// inside the clearance: the wall alone, though its edge still passes the rim. A collar that sits on the rim: top and
// wall.
TEST(ConstraintLink, KnowsTheActiveConstraintsAtARim) {
  const EntitySets a = test::block_with_hole();
  const EntitySets straight = test::pin();
  const EntitySets collared = test::collared_pin();
  const Vector3d push(-3, 2, 5);

  ConstraintLink link(a, straight);
  Contacts beside;
  beside.add({0.075, 0, 0.1}, push, block::rim, pin::edge);
  link.begin_frame(at(0.150, 0, 0.299));  // more than both radii and a voxel away, its lower end 1 mm deep in the top
  (void)link.restore_contacts(beside.columns());
  EXPECT_LE((beside.force(0) - Vector3d(0, 0, 5)).norm(), tolerance(kFloat));

  Contacts inside;
  inside.add({0.075, 0, 0.1}, push, block::rim, pin::edge);
  link.begin_frame(at(0.003, 0, 0.295));
  (void)link.restore_contacts(inside.columns());
  EXPECT_LE((inside.force(0) - Vector3d(-3, 0, 0)).norm(), tolerance(kFloat));

  ConstraintLink hanging(a, collared);
  Contacts seated;
  seated.add({0.075, 0, 0.1}, push, block::rim, pin::edge);
  hanging.begin_frame(at(0.003, 0, 0.099));
  (void)hanging.restore_contacts(seated.columns());
  EXPECT_LE((seated.force(0) - Vector3d(-3, 0, 5)).norm(), tolerance(kFloat));
}

// A pin that covers part of the hole and stands on its rim, by more than a tenth of a voxel: neither the force that
// holds it up nor the force that guides it in is changed. Also not in the voxels beside the rim, which do not know of
// the hole.
TEST(ConstraintLink, LeavesAPinThatStandsOnTheRimToTheVoxels) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  const Vector3d push(-3, 2, 5);
  for (const double voxel : {0.0045, 0.002}) {
    ConstraintLink link(a, b, {.scales = {.voxel_size = voxel}});
    for (const double offset : {0.0055, 0.006, 0.0075, 0.010, 0.020, 0.075, 0.144}) {
      for (const FeatureSetId set_a : {block::top, block::rim}) {
        for (const FeatureSetId set_b : {pin::end, pin::edge}) {
          Contacts contacts;
          contacts.add({0.075, 0, 0.1}, push, set_a, set_b);
          link.begin_frame(at(offset, 0, 0.300));
          (void)link.restore_contacts(contacts.columns());
          EXPECT_EQ(contacts.force(0), push) << offset << ", sets " << set_a << " and " << set_b;
        }
      }
    }
  }
}

// Same contacts, by the dissertation's rule: the rim's forces stay as they came.
TEST(ConstraintLink, ByTheDissertationsRuleLeavesRimsAlone) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b, {.reduction = Reduction::exactly_one});
  Contacts contacts;
  contacts.add({0.075, 0, 0.1}, {-3, 2, 5}, block::rim, pin::side);
  contacts.add({0.075, 0, 0.05}, {-3, 2, 5}, block::wall, pin::side);
  link.begin_frame(Pose());
  (void)link.restore_contacts(contacts.columns());
  EXPECT_EQ(contacts.force(0), Vector3d(-3, 2, 5));
  EXPECT_LE((contacts.force(1) - Vector3d(-3, 0, 0)).norm(), tolerance(kFloat));
}

TEST(ConstraintLink, LeavesTheVoxelAnswerWhereNothingIsKnown) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts;
  contacts.add({0.075, 0, 0}, {-3, 2, 5}, block::nothing, pin::side);
  contacts.add({0.075, 0, 0}, {-3, 2, 5}, block::wall, pin::end);
  contacts.add({0.075, 0, 0}, {-3, 2, 5}, 4711, pin::end);
  link.begin_frame(Pose());
  const RestoreResult r = link.restore_contacts(contacts.columns());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(contacts.force(i), Vector3d(-3, 2, 5));
  EXPECT_EQ(r.kind, ConstraintKind::none);
  EXPECT_EQ(r.restored, 0U);
}

TEST(ConstraintLink, LeavesForcesAloneInAPoseThatIsNotFinite) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts;
  contacts.add({0.075, 0, 0}, {-3, 2, 5}, block::wall, pin::side);
  link.begin_frame(at(std::numeric_limits<double>::quiet_NaN(), 0, 0));
  const RestoreResult r = link.restore_contacts(contacts.columns());
  EXPECT_EQ(contacts.force(0), Vector3d(-3, 2, 5));
  EXPECT_EQ(r.alpha, 0);
  link.begin_frame(Pose());  // and recovers
  EXPECT_EQ(link.restore_contacts(contacts.columns()).alpha, 1);
}

TEST(ConstraintLink, LooksUpWithoutTouchingForces) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts;
  contacts.add({0.075, 0, 0}, {-3, 2, 5}, block::wall, pin::side);
  contacts.add({0.074, 0, 0}, {-3, 2, 5}, block::wall, pin::side);
  link.begin_frame(Pose());
  ContactColumns columns = contacts.columns();
  columns.fx = columns.fy = columns.fz = nullptr;
  EXPECT_EQ(link.look_up_contacts(columns).kind, ConstraintKind::cylindrical);
  ASSERT_EQ(link.engaged().size(), 1U);
  EXPECT_EQ(link.engaged()[0].contacts, 2U);
  EXPECT_EQ(link.engaged()[0].alpha, 1);
  link.begin_frame(Pose());
  EXPECT_TRUE(link.engaged().empty());
}

/// A heap of contacts on all pairs of sets.
Contacts heap(std::uint64_t seed, int count) {
  test::Inputs in(seed);
  Contacts contacts;
  for (int i = 0; i < count; ++i) {
    const auto set_a = static_cast<FeatureSetId>(in.between(0, 3.999));
    const auto set_b = static_cast<FeatureSetId>(in.between(0, 3.999));
    contacts.add(in.vector(0.1), in.vector(10), set_a, set_b);
  }
  return contacts;
}

// Plain against fast: every contact by itself through recognition, alignment and restoration.
TEST(ConstraintLink, InABatchDoesWhatItDoesToEachContact) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  for (const std::uint64_t seed : test::seeds(50)) {
    SCOPED_TRACE(seed);
    Contacts all = heap(seed, 100);
    const Contacts before = all;
    const Pose X = test::Inputs(seed).pose(0.003);
    ConstraintLink link(a, b);
    link.begin_frame(X);
    (void)link.restore_contacts(all.columns());
    for (std::size_t i = 0; i < all.x.size(); ++i) {
      Contacts one;
      one.add(before.point(i), before.force(i), before.a[i], before.b[i]);
      ConstraintLink fresh(a, b);
      fresh.begin_frame(X);
      (void)fresh.restore_contacts(one.columns());
      EXPECT_LE((all.force(i) - one.force(0)).norm(), tolerance(kFloat));
      EXPECT_LE(all.force(i).norm(), before.force(i).norm() * (1 + tolerance(1e-6)));
    }
  }
}

// Section 6.5: hits and misses add up to collisions; a second frame misses nothing.
TEST(ConstraintLink, CountsEveryCollision) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts = heap(1, 500);
  link.begin_frame(Pose());
  const RestoreResult first = link.restore_contacts(contacts.columns());
  EXPECT_EQ(first.hits + first.misses, 500U);
  EXPECT_EQ(first.misses, 16U);
  link.begin_frame(at(0, 0, 0.01));
  const RestoreResult second = link.restore_contacts(contacts.columns());
  EXPECT_EQ(second.misses, 0U);
  EXPECT_EQ(second.hits, 500U);
  EXPECT_EQ(link.counts().hits + link.counts().misses(), 1000U);
}

TEST(ConstraintLink, AllocatesNothingAfterItIsMade) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  Contacts contacts = heap(2, 500);
  const std::uint64_t before = allocations;
  for (int frame = 0; frame < 10; ++frame) {
    link.begin_frame(at(0.001 * frame, 0, 0));
    (void)link.restore_contacts(contacts.columns());
  }
  EXPECT_EQ(allocations, before);
}

/// A contact at the rim while a tilted pin moves about: by how much its force changes from step to step.
class AtTheRim {
 public:
  explicit AtTheRim(FeatureSetId set_a) : set_a_(set_a) { before_ = force(); }

  /// Moves along one axis in steps of 5 um; the largest change of force over force and step [1/m].
  double slope_to(double target, double& coordinate) {
    constexpr double kStep = 5e-6;
    double steepest = 0;
    for (; coordinate > target; coordinate -= kStep) {
      const Vector3d now = force();
      steepest = std::max(steepest, (now - before_).norm() / (kForce.norm() * kStep));
      before_ = now;
    }
    return steepest;
  }
  double slope_along_x(double target) { return slope_to(target, X_.position.x()); }
  double slope_along_z(double target) { return slope_to(target, X_.position.z()); }
  [[nodiscard]] const Vector3d& last() const { return before_; }
  [[nodiscard]] double tilt() const { return kTilt.norm(); }

 private:
  Vector3d force() {
    Contacts contacts;
    contacts.add({0.075, 0, 0.1}, kForce, set_a_, pin::edge);
    link_.begin_frame(X_);
    (void)link_.restore_contacts(contacts.columns());
    return contacts.force(0);
  }

  inline static const Vector3d kForce{-3, 2, 5};
  inline static const Vector3d kTilt{0.002, 0.004, 0};
  EntitySets a_ = test::block_with_hole();
  EntitySets b_ = test::pin();
  ConstraintLink link_{a_, b_};
  FeatureSetId set_a_;
  Pose X_ = {{0.160, 0, 0.299}, rotation_from_vector(kTilt)};  // its end a millimetre below the rim
  Vector3d before_;
};

// No force jumps while a pin that is clear of its hole moves over it, goes in and reaches its axis. f' is affine in
// each alpha, and its slope there, f with one normal kept less f without, is no longer than f. So |df'| / |f| is at
// most the sum of all |d alpha|, plus the angle by which a kept normal turns. With the factors of alignment.hpp, each
// between 0 and 1, a product's slope is at most the sum of the slopes of its factors:
//   planar  (1 - tan^2 theta) clear_of_hole     beside: 1/s, while the axes are 145 to 149.5 mm apart
//   round   (1 - x/s) engagement               x/s: 1/s from the offset, within 9.5 mm; tan theta / s from the depth
//                                              engagement: 1/s from the depth
//           or, if larger, 1 - x / (s/10)      10/s from the offset; reached only before the hole
// Forces of 6 N are floats: each is off by less than 2^-22 N, and a step of 5 um takes two of them.
TEST(ConstraintLink, ChangesForcesContinuouslyAtTheRim) {
  constexpr double kSteepest = 1 / 0.0045;        // of clear_of_hole, x / s and engagement alike
  constexpr double kTurn = 1 / (0.075 - 0.0095);  // of a normal, by the arm from the axis
  constexpr double kRounding = 2 * 0x1p-22 / (6 * 5e-6);
  for (const FeatureSetId set_a : {block::wall, block::top, block::rim}) {
    SCOPED_TRACE(set_a);
    AtTheRim deep(set_a);
    const double planar_or_round = kSteepest;  // never both: 145 mm against 9.5
    EXPECT_LE(deep.slope_along_x(0.007), tolerance(planar_or_round + kTurn + kRounding));
    const double both_factors = kSteepest + std::tan(deep.tilt()) * kSteepest;
    EXPECT_LE(deep.slope_along_z(0.290), tolerance(both_factors + kTurn + kRounding));
    EXPECT_LE(deep.slope_along_x(0), tolerance(kSteepest + kTurn + kRounding));
    EXPECT_EQ(deep.last().z() == 0, set_a != block::top) << "within its clearance, 10 mm deep";

    AtTheRim before(set_a);
    EXPECT_LE(before.slope_along_x(0), tolerance(10 * kSteepest + kTurn + kRounding));
    EXPECT_EQ(before.last().z() == 0, set_a != block::top) << "within its clearance, a millimetre deep";
  }
}

}  // namespace
}  // namespace verisim::constraint_link_test

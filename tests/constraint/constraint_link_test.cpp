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

namespace verisim {
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

// The rim, all ways: a pin that stands wholly beside the hole is held by the top alone; one that is a voxel deep inside
// the clearance is not held by it, though its edge still passes the rim; a collar that sits on the rim is held by the
// top and by the wall at once.
TEST(ConstraintLink, KnowsWhatHoldsAtARim) {
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

// A pin that covers part of the hole and stands on its rim, by more than a tenth of a voxel: nothing of what holds it
// up is taken, and nothing of what guides it in, in the rim's voxels and in those beside them, which do not know of the
// hole.
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

// As a pin moves from wholly beside its hole to over it, tilts and goes in, no force jumps: 5 um change a force of 6.2
// N by at most what the slopes of 1 / 4.5 mm allow of two constraints, each with a product of two factors.
TEST(ConstraintLink, ChangesForcesContinuouslyAtTheRim) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  constexpr double kStep = 5e-6;
  Pose X = {{0.160, 0, 0.299}, rotation_from_vector({0.002, 0.004, 0})};
  for (const FeatureSetId set_a : {block::wall, block::top, block::rim}) {
    X.position = {0.160, 0, 0.299};
    Vector3d before;
    const auto look = [&](bool first) {
      Contacts contacts;
      contacts.add({0.075, 0, 0.1}, {-3, 2, 5}, set_a, pin::edge);
      link.begin_frame(X);
      (void)link.restore_contacts(contacts.columns());
      const double step = first ? 0 : (contacts.force(0) - before).norm();
      before = contacts.force(0);
      return step;
    };
    (void)look(true);
    const double most = tolerance(4 * 6.2 * kStep / 0.0045);
    for (; X.position.x() > 0.007; X.position.x() -= kStep) ASSERT_LE(look(false), most);
    for (; X.position.z() > 0.290; X.position.z() -= kStep) ASSERT_LE(look(false), most) << X.position.z();
    for (; X.position.x() > 0; X.position.x() -= kStep) ASSERT_LE(look(false), most) << X.position.x();
    EXPECT_EQ(before.z() == 0, set_a != block::top) << "within its clearance, 10 mm deep";
  }
}

}  // namespace
}  // namespace verisim

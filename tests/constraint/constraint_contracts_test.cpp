// The doors of engine/constraint: what alignment, restoration, the memo and the comparator do not take.
#include <gtest/gtest.h>

#include <limits>

#include "engine/constraint/blend.hpp"
#include "engine/constraint/recognition.hpp"
#include "engine/constraint/regression.hpp"
#include "engine/constraint/restore_batch.hpp"
#include "tests/constraint/contacts.hpp"
#include "tests/constraint/parts.hpp"
#include "tests/support/broken.hpp"

namespace verisim::constraint_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vector3d kUp = Vector3d::UnitZ();
const Pose kStretched{{0, 0, 0}, Quaterniond(2, 0, 0, 0)};

/// The block's hole and the pin's side.
Constraint pin_in_hole() {
  return recognize(test::block_with_hole().entity(0), test::pin().entity(0));
}

TEST(AlignmentDeathTest, JudgesAConstraintByAVoxel) {
  const Constraint c = pin_in_hole();
  const Misalignment m = misalignment(c, Pose());
  EXPECT_BROKEN(misalignment(Constraint(), Pose()), "constraint.kind != ConstraintKind::none");
  for (const double voxel_size : {0.0, -1.0, kNaN, kInfinity})
    EXPECT_BROKEN(alignment(AlignmentMeasure::by_type, c, m, {voxel_size, 10}), "is_positive(scales.voxel_size)");
  EXPECT_BROKEN(alignment(AlignmentMeasure::pavlik, c, m, {0.001, kNaN}), "is_not_negative(scales.steepness)");
}

TEST(AlignmentDeathTest, OnlyAPinStandsBesideAHole) {
  const Constraint c = pin_in_hole();
  const Misalignment m = misalignment(c, Pose());
  EXPECT_BROKEN(clear_of_hole(Constraint(), m, {}), "round.kind != ConstraintKind::none");
  Constraint planes = c;
  planes.pairing = Pairing::plane_plane;
  EXPECT_BROKEN(clear_of_hole(planes, m, {}), "round.pairing == Pairing::axis_axis");
  EXPECT_BROKEN(clear_of_hole(c, m, {0, 10}), "is_positive(scales.voxel_size)");
}

TEST(RestorationDeathTest, NeedsAPlaceADirectionAndAShare) {
  const Constraint c = pin_in_hole();
  EXPECT_BROKEN(activate(c, kStretched, 1), "is_placement(X_AB)");
  EXPECT_BROKEN(activate(c, {{0, kInfinity, 0}, Quaterniond::Identity()}, 1), "is_placement(X_AB)");
  for (const double alpha : {-0.1, 1.1, kNaN}) EXPECT_BROKEN(activate(c, Pose(), alpha), "is_fraction(alpha)");
  Constraint broken = c;
  broken.a.point.x() = kNaN;
  EXPECT_BROKEN(activate(broken, Pose(), 1), "is_finite(active.point)");
  broken = c;
  broken.a.direction *= 2;
  EXPECT_BROKEN(activate(broken, Pose(), 1), "c.field == NormalField::about_point || is_unit(active.direction)");
}

TEST(RestorationDeathTest, OfABatchNeedsItsColumns) {
  test::Contacts contacts;
  contacts.add({0, 0, 0}, {0, 0, 1}, 1, 1);
  const ContactColumns c = contacts.columns();
  const ActiveConstraint active = activate(pin_in_hole(), Pose(), 1);
  EXPECT_BROKEN(restore_batch({c.x, nullptr, c.z, c.fx, c.fy, c.fz, 1}, active),
                "batch.count == 0 || (batch.x != nullptr && batch.y != nullptr && batch.z != nullptr)");
  EXPECT_BROKEN(restore_batch({c.x, c.y, c.z, c.fx, c.fy, nullptr, 1}, active),
                "batch.count == 0 || (batch.fx != nullptr && batch.fy != nullptr && batch.fz != nullptr)");
  ActiveConstraint too_much = active;
  too_much.alpha = 1.5;
  EXPECT_BROKEN(restore_batch({c.x, c.y, c.z, c.fx, c.fy, c.fz, 1}, too_much), "is_fraction(active.alpha)");
  restore_batch({nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, 0}, active);
}

TEST(ReductionDeathTest, NeedsAnAlphaForEachConstraint) {
  const ActiveConstraint active = activate(pin_in_hole(), Pose(), 1);
  const std::array<const ActiveConstraint*, 2> holding = {&active, &active};
  const std::array<double, 1> alpha = {1};
  EXPECT_BROKEN(restore_common(holding, alpha, kUp, kUp), "active.size() == alpha.size()");
}

TEST(ConstraintLinkDeathTest, NeedsAVoxelSizeAPoseAndColumns) {
  const EntitySets block = test::block_with_hole();
  const EntitySets pin = test::pin();
  ConstraintOptions options;
  options.scales.voxel_size = 0;
  EXPECT_BROKEN(ConstraintLink(block, pin, options), "is_positive(options.scales.voxel_size)");
  ConstraintLink link(block, pin);
  EXPECT_BROKEN(link.begin_frame(kStretched), "!pose_is_finite_ || is_unit(X_AB.rotation)");
  link.begin_frame(Pose());
  test::Contacts contacts;
  contacts.add({0, 0, 0}, {0, 0, 1}, 1, 1);
  const auto without = [&](auto ContactColumns::*column) {
    ContactColumns c = contacts.columns();
    c.*column = nullptr;
    return c;
  };
  EXPECT_BROKEN(link.restore_contacts(without(&ContactColumns::y)),
                "c.size == 0 || (c.x != nullptr && c.y != nullptr && c.z != nullptr)");
  EXPECT_BROKEN(link.restore_contacts(without(&ContactColumns::fz)),
                "c.size == 0 || (c.fx != nullptr && c.fy != nullptr && c.fz != nullptr)");
  EXPECT_BROKEN(link.look_up_contacts(without(&ContactColumns::set_a)), "c.size == 0 || c.set_a != nullptr");
  EXPECT_BROKEN(link.look_up_contacts(without(&ContactColumns::set_b)), "c.size == 0 || c.set_b != nullptr");
  contacts.origin.x() = kNaN;
  EXPECT_BROKEN(link.restore_contacts(contacts.columns()), "is_finite(c.origin)");
}

TEST(MemoDeathTest, GivesOnlyWhatItHolds) {
  const EntitySets block = test::block_with_hole();
  const EntitySets pin = test::pin();
  const ConstraintMemo memo(block, pin, Reduction::common_freedom, {});
  EXPECT_BROKEN(memo.constraint(0), "number < constraints_known_");
  EXPECT_BROKEN(memo.gates_of(0), "number < constraints_known_");
  EXPECT_BROKEN(memo.candidates(static_cast<std::uint32_t>(memo.candidates_max())), "number < candidates_.size()");
  EXPECT_BROKEN(block.entity(3), "number < entities_.size()");
  const auto with = [&](double Tolerances::*member) {
    Tolerances tolerances;
    tolerances.*member = kNaN;
    return ConstraintMemo(block, pin, Reduction::common_freedom, tolerances);
  };
  EXPECT_BROKEN(with(&Tolerances::clearance_relative_max), "is_not_negative(tolerances.clearance_relative_max)");
  EXPECT_BROKEN(with(&Tolerances::interference_max), "is_not_negative(tolerances.interference_max)");
  EXPECT_BROKEN(with(&Tolerances::half_angle_difference_max), "is_not_negative(tolerances.half_angle_difference_max)");
  EXPECT_BROKEN(with(&Tolerances::core_relative_max), "is_not_negative(tolerances.core_relative_max)");
}

TEST(PairMapDeathTest, TakesEachPairOnceAndNoMoreThanItHasRoomFor) {
  PairMap map(2);
  map.insert(1, 1, 7);
  EXPECT_BROKEN(map.insert(1, 1, 8), "slot.value == kAbsent");
  EXPECT_BROKEN(map.insert(1, 2, PairMap::kAbsent), "value != kAbsent");
  map.insert(1, 2, 8);
  EXPECT_BROKEN(map.insert(1, 3, 9), "size_ < capacity_");
}

TEST(BlendDeathTest, SolvesWhatIsThereWithASpringThatPulls) {
  const Constraint c = pin_in_hole();
  const Vector3d o = Vector3d::Zero();
  const std::array<Engaged, 1> engaged = {{{&c, 1, 1}}};
  EXPECT_BROKEN(constraint_force(engaged, Pose(), o, {-1, 1, 1, 4}), "is_not_negative(parameters.stiffness)");
  EXPECT_BROKEN(constraint_force(engaged, Pose(), o, {1, kNaN, 1, 4}), "is_not_negative(parameters.angular_stiffness)");
  EXPECT_BROKEN(constraint_force(engaged, Pose(), o, {1, 1, 0, 4}), "is_positive(parameters.length)");
  EXPECT_BROKEN(constraint_force(engaged, kStretched, o, {}), "is_placement(X_AB)");
  EXPECT_BROKEN(constraint_force(engaged, Pose(), {0, kNaN, 0}, {}), "is_finite(center)");
  const std::array<Engaged, 1> none = {{{nullptr, 1, 1}}};
  EXPECT_BROKEN(constraint_force(none, Pose(), o, {}), "e.constraint != nullptr");
  const std::array<Engaged, 1> too_much = {{{&c, 1.5, 1}}};
  EXPECT_BROKEN(constraint_force(too_much, Pose(), o, {}), "is_fraction(e.alpha)");
  EXPECT_BROKEN(blended({}, {}, kNaN), "is_fraction(alpha)");
}

TEST(RegressionDeathTest, NeedsPairsOfFiniteNumbersThatDiffer) {
  const std::vector<double> x = {1, 2};
  const std::vector<double> three = {1, 2, 3};
  EXPECT_BROKEN(fit_line(x, three), "x.size() == y.size()");
  const std::vector<double> equal = {1, 1};
  EXPECT_BROKEN(fit_line(equal, x), "is_positive(xx)");
  const std::vector<double> infinite = {1, kInfinity};
  EXPECT_BROKEN(fit_line(x, infinite), "is_not_negative(yy)");
}

}  // namespace
}  // namespace verisim::constraint_contracts_test

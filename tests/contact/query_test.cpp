#include "engine/contact/query.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/contact/naive_voxels.hpp"
#include "tests/contact/query_plainly.hpp"

namespace verisim::query_test {
namespace {

constexpr double kVoxel = 0.005;

/// Lifts a restriction of the SIMD targets when a test ends, passed or not.
struct RestoreTargets {
  ~RestoreTargets() { use_simd_target(""); }
};

struct Pair {
  VoxelBody block, pin;
};

/// Pin of 30 mm in a hole of 35 mm; built once, since the naive voxelizer is slow.
const Pair& pin_and_block() {
  static const Pair pair = {naive::voxelize(naive::block_with_hole({0.08, 0.075, 0.05}, 0.035), kVoxel),
                            naive::voxelize(naive::cylinder(0.030, 0.2), kVoxel)};
  return pair;
}

Vector3d random_vector(const RandomStream& r, std::uint64_t c) {
  return {2 * r.uniform(c) - 1, 2 * r.uniform(c + 1) - 1, 2 * r.uniform(c + 2) - 1};
}

/// The kinds of pose in turn: in the hole, through the walls, just touching the top, deep inside, around the grid's
/// border, far away. Any orientation except in the hole, where the axes differ by a few degrees.
Pose random_pose(std::uint64_t seed) {
  const RandomStream r(seed, "pose");
  const Vector3d v = random_vector(r, 0);
  const Vector3d turn = random_vector(r, 3);
  const Quaterniond any = rotation_from_vector(4 * turn);
  switch (seed % 6) {
    case 0:
      return {{0.008 * v.x(), 0.008 * v.y(), 0.12 * v.z()}, rotation_from_vector(0.1 * turn)};
    case 1:
      return {{0.12 * v.x(), 0.12 * v.y(), 0.12 * v.z()}, any};
    case 2:
      return {{0.05 + 0.01 * v.x(), 0.01 * v.y(), 0.15 + kVoxel * v.z()}, Quaterniond::Identity()};
    case 3:
      return {{0.06, 0.055 + 0.01 * v.y(), 0.01 * v.z()}, any};
    case 4:
      return {{0.2 * v.x(), 0.16 + 0.05 * v.y(), 0.15 * v.z()}, any};
    default:
      return {1000 * v, any};
  }
}

std::vector<std::uint32_t> bits(const std::vector<float>& column, std::size_t size) {
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < size; ++i) result.push_back(std::bit_cast<std::uint32_t>(column[i]));
  return result;
}

void expect_same_bits(const ContactList& a, const ContactList& b) {
  ASSERT_EQ(a.size, b.size);
  for (const auto column : {&ContactList::point, &ContactList::slot}) {
    EXPECT_TRUE(std::equal((a.*column).begin(), (a.*column).begin() + a.size, (b.*column).begin()));
  }
  for (const auto column : {&ContactList::x, &ContactList::y, &ContactList::z, &ContactList::nx, &ContactList::ny,
                            &ContactList::nz, &ContactList::depth}) {
    EXPECT_EQ(bits(a.*column, a.size), bits(b.*column, b.size));
  }
}

/// How often poses touched, and how many points were culled.
struct Compared {
  std::uint64_t in_contact = 0;
  std::uint64_t culled = 0;
};

Compared compare_targets(const VoxelBody& a, const VoxelBody& b, std::uint64_t poses) {
  const RestoreTargets restore;
  ContactList fast(b.shell.size());
  ContactList plain(b.shell.size());
  Compared result;
  for (std::uint64_t seed = 0; seed < poses; ++seed) {
    SCOPED_TRACE(seed);
    const Pose X_AB = random_pose(seed);
    QueryCost plain_cost;
    test::query_plainly(a.voxmap, b.shell, X_AB, plain, plain_cost);
    result.in_contact += plain.size > 0 ? 1 : 0;
    std::uint64_t points = std::numeric_limits<std::uint64_t>::max();
    for (const std::string& target : simd_targets()) {
      SCOPED_TRACE(target);
      use_simd_target(target);
      QueryCost cost;
      query(a.voxmap, b.shell, X_AB, fast, cost);
      expect_same_bits(fast, plain);
      EXPECT_EQ(cost.candidates, plain_cost.candidates);
      EXPECT_EQ(cost.clusters, b.shell.clusters.size());
      EXPECT_TRUE(target == simd_targets().front() || points == cost.points) << "work differs between targets";
      points = cost.points;
    }
    result.culled += plain_cost.points - points;
  }
  return result;
}

// The plain loop culls nothing and uses no SIMD: equality shows both that no lane differs and that no contact is lost.
TEST(ContactQuery, EveryTargetFindsWhatThePlainLoopFinds) {
  const auto& [block, pin] = pin_and_block();
  const Compared result = compare_targets(block, pin, 600);
  EXPECT_GT(result.in_contact, 300U) << "most poses touch nothing: this test proves too little";
  EXPECT_GT(result.culled, 100000U) << "nothing is ever culled: this test proves too little";
}

// Clusters of the coarser body reach farther than one brick of the finer one, those of the finer cover less than one.
TEST(ContactQuery, EveryTargetAgreesForBodiesOfDifferentVoxelSizes) {
  const auto& [block, pin] = pin_and_block();
  const VoxelBody coarse_pin = naive::voxelize(naive::cylinder(0.030, 0.2), 3.1 * kVoxel);
  EXPECT_GT(compare_targets(block, coarse_pin, 300).in_contact, 100U);
  const VoxelBody coarse_block = naive::voxelize(naive::block_with_hole({0.08, 0.075, 0.05}, 0.035), 2.3 * kVoxel);
  EXPECT_GT(compare_targets(coarse_block, pin, 300).in_contact, 100U);
}

// Independent of every float and cluster: the definition of query.hpp in double. A coordinate is good to 1e-5 voxel, so
// only points within that of a voxel wall, and depths within that of zero, may be judged differently.
TEST(ContactQuery, FindsWhatTheDefinitionSaysInDoublePrecision) {
  constexpr double kTolerance = 1e-5;  // voxel
  const auto& [block, pin] = pin_and_block();
  ContactList list(pin.shell.size());
  QueryCost cost;
  std::uint64_t compared = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    const Pose X_AB = random_pose(seed);
    query(block.voxmap, pin.shell, X_AB, list, cost);
    std::uint32_t k = 0;
    for (std::uint32_t i = 0; i < pin.shell.size(); ++i) {
      const bool found = k < list.size && list.point[k] == i;
      const std::uint32_t row = found ? k++ : 0;
      const Vector3d p_A =
          X_AB * (pin.shell.reference + Vector3f(pin.shell.x[i], pin.shell.y[i], pin.shell.z[i]).cast<double>());
      const Vector3d g = (p_A - block.voxmap.origin) / kVoxel;
      const Vector3d cell = g.array().floor();
      const Vector3d rest = g - cell;
      if (rest.minCoeff() < kTolerance || rest.maxCoeff() > 1 - kTolerance) continue;
      const Layer layer = block.voxmap.layer_at(p_A);
      const Vector3d n = X_AB.rotation * Vector3f(pin.shell.nx[i], pin.shell.ny[i], pin.shell.nz[i]).cast<double>();
      const double depth = ((Vector3d::Constant(0.5) - rest).dot(n) - layer) * kVoxel;
      if (layer <= 0 && std::abs(depth) < kTolerance * kVoxel) continue;
      ASSERT_EQ(found, layer <= 0 && depth > 0) << "point " << i;
      if (!found) continue;
      ++compared;
      EXPECT_NEAR(list.depth[row], depth, kTolerance * kVoxel);
      EXPECT_NEAR(list.x[row], p_A.x() - block.voxmap.origin.x(), kTolerance * kVoxel);
      EXPECT_NEAR(list.y[row], p_A.y() - block.voxmap.origin.y(), kTolerance * kVoxel);
      EXPECT_NEAR(list.z[row], p_A.z() - block.voxmap.origin.z(), kTolerance * kVoxel);
      EXPECT_NEAR(list.nz[row], n.z(), 1e-6);
    }
    ASSERT_EQ(k, list.size) << "points out of order or twice";
  }
  EXPECT_GT(compared, 10000U);
}

// A plane of points at a known height over a box: the depth is the tangent plane's, by hand.
TEST(ContactQuery, GivesTheWorkedDepth) {
  const VoxelBody ground =
      naive::voxelize(naive::box({0.04, 0.04, 0.04}), 0.01);  // faces in voxel walls: layers 0 at both
  Pointshell one;
  one.x = one.y = {0.002F};
  one.z = {0.0F};
  one.nx = one.ny = {0.0F};
  one.nz = {1.0F};
  one.clusters = {{0, 1, {0.002F, 0.002F, 0.0F}, 0.0F}};
  ContactList list(1);
  QueryCost cost;
  // z = 0.043 lies in the voxel [0.04, 0.05], whose closed box the top face touches: layer 0, centre 0.045.
  query(ground.voxmap, one, {{0, 0, 0.043}, Quaterniond::Identity()}, list, cost);
  ASSERT_EQ(list.size, 1U);
  EXPECT_NEAR(list.depth[0], 0.002, 1e-8);
  // z = 0.047 is past that voxel's tangent plane.
  query(ground.voxmap, one, {{0, 0, 0.047}, Quaterniond::Identity()}, list, cost);
  EXPECT_EQ(list.size, 0U);
  // z = 0.023 lies in [0.02, 0.03], one step below the lower surface voxel [0.03, 0.04]: (0.025 - 0.023) + 1 x 0.01.
  query(ground.voxmap, one, {{0, 0, 0.023}, Quaterniond::Identity()}, list, cost);
  ASSERT_EQ(list.size, 1U);
  EXPECT_NEAR(list.depth[0], 0.012, 1e-8);
}

// A long part far from its own origin: the reference and the cluster centres carry the large numbers.
TEST(ContactQuery, KeepsItsPrecisionFarFromTheOrigin) {
  const auto& [block, pin] = pin_and_block();
  Pointshell moved = pin.shell;
  moved.reference = {123.4, -56.7, 89.1};
  const Quaterniond q = rotation_from_vector({0.02, -0.03, 0.5});
  const Pose X_AB = {Vector3d{0.004, 0.003, 0.02}, q};
  const Pose far = {X_AB.position - q * moved.reference, q};
  ContactList near_list(moved.size());
  ContactList far_list(moved.size());
  QueryCost cost;
  query(block.voxmap, pin.shell, X_AB, near_list, cost);
  query(block.voxmap, moved, far, far_list, cost);
  ASSERT_GT(near_list.size, 50U);
  ASSERT_EQ(far_list.size, near_list.size);
  for (std::uint32_t i = 0; i < near_list.size; ++i) {
    EXPECT_EQ(far_list.point[i], near_list.point[i]);
    EXPECT_NEAR(far_list.depth[i], near_list.depth[i], 1e-5 * kVoxel);
  }
}

TEST(ContactQuery, CullsAPinThatIsFarAwayAndKeepsOneDeepInside) {
  const auto& [block, pin] = pin_and_block();
  const VoxelBody small = naive::voxelize(naive::box({0.01, 0.01, 0.01}), kVoxel);
  const VoxelBody large = naive::voxelize(naive::box({0.1, 0.1, 0.1}), kVoxel);
  ContactList list(pin.shell.size());
  QueryCost cost;
  query(block.voxmap, pin.shell, {{0, 0, 0.4}, Quaterniond::Identity()}, list, cost);
  EXPECT_EQ(cost.points, 0U);
  EXPECT_EQ(list.size, 0U);
  query(large.voxmap, small.shell, {{0, 0, 0}, Quaterniond::Identity()}, list, cost);
  EXPECT_EQ(list.size, small.shell.size()) << "deep inside, every point is in contact";
}

TEST(ContactQuery, FindsNothingForAPoseThatIsNotFinite) {
  const auto& [block, pin] = pin_and_block();
  ContactList list(pin.shell.size());
  QueryCost cost;
  for (const double odd : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    query(block.voxmap, pin.shell, {{odd, 0, 0}, Quaterniond::Identity()}, list, cost);
    EXPECT_EQ(list.size, 0U);
    test::query_plainly(block.voxmap, pin.shell, {{0, -odd, 0}, Quaterniond::Identity()}, list, cost);
    EXPECT_EQ(list.size, 0U);
  }
}

// A list of exactly the shell's size is enough in the worst case, all points in contact, and nothing is ever moved.
TEST(ContactQuery, NeverGrowsTheListNorAllocates) {
  const auto& [block, pin] = pin_and_block();
  const VoxelBody small = naive::voxelize(naive::box({0.011, 0.011, 0.011}), kVoxel);
  const VoxelBody large = naive::voxelize(naive::box({0.1, 0.1, 0.1}), kVoxel);
  ContactList full(small.shell.size());
  ContactList list(pin.shell.size());
  QueryCost cost;
  query(block.voxmap, pin.shell, random_pose(0), list, cost);  // the first call chooses the target
  const auto before = allocations.load();
  query(large.voxmap, small.shell, Pose{}, full, cost);
  for (std::uint64_t seed = 0; seed < 60; ++seed) query(block.voxmap, pin.shell, random_pose(seed), list, cost);
  EXPECT_EQ(allocations.load(), before);
  EXPECT_EQ(full.size, full.capacity());
}

TEST(ContactQuery, HandlesAnEmptyShell) {
  ContactList list(0);
  QueryCost cost;
  query(pin_and_block().block.voxmap, Pointshell{}, Pose{}, list, cost);
  EXPECT_EQ(list.size, 0U);
}

TEST(SimdTargets, EndWithScalarAndRefuseAnUnknownName) {
  const RestoreTargets restore;
  EXPECT_EQ(simd_targets().back(), "scalar");
  try {
    use_simd_target("AVX9");
    FAIL() << "was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(e.what()).find("scalar"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace verisim::query_test

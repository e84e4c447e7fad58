// Voxels and exact bodies as bytes and back: what comes back is what was there, for every kind of face and edge, and
// bytes that end anywhere are refused.
#include "engine/exact/body_bytes.hpp"

#include <gtest/gtest.h>

#include "engine/voxel/association.hpp"
#include "engine/voxel/body_bytes.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/geometry/models.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::exact::test::body_bytes_test {
namespace {

using testing::make;
using testing::placed;
using verisim::test::Inputs;
using verisim::test::seeds;
using Kind = Solid::Kind;

constexpr double kVoxel = 0.004;

/// Two of all primitives, one turned, united or cut.
Solid drawn(std::uint64_t seed) {
  Inputs draw(seed);
  const auto primitive = [&] {
    const double a = draw.between(0.02, 0.05), b = draw.between(0.3, 0.8) * a, h = draw.between(0.03, 0.08);
    switch (static_cast<int>(draw.between(0, 6))) {
      case 0:
        return make(Kind::box, {a, b, h});
      case 1:
        return make(Kind::cylinder, {b, h});
      case 2:
        return make(Kind::cone, {a, b, h});
      case 3:
        return make(Kind::sphere, {b});
      case 4:
        return make(Kind::tube, {a, b, h});
      default:
        return make(Kind::torus, {a, 0.5 * b});
    }
  };
  const Solid first = primitive(), second = primitive();
  const Pose pose = draw.pose(0.01);
  return make(seed % 2 == 0 ? Kind::sum : Kind::difference, first, placed(second, pose.position, pose.rotation));
}

/// What any end of the bytes but the right one gives: each of some twenty.
template <typename Read>
void refuses_other_lengths(const std::string& bytes, const Read& read) {
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 20);
  for (std::size_t size = 0; size < bytes.size(); size += step)
    EXPECT_THROW((void)read(std::string_view(bytes).substr(0, size)), Error) << size << " of " << bytes.size();
  EXPECT_THROW((void)read(bytes + '\0'), Error);
}

TEST(BodyBytes, ComeBackAsTheyWere) {
  std::map<std::string, int> kinds;
  for (const std::uint64_t seed : seeds(10)) {
    SCOPED_TRACE(seed);
    Part part;
    try {
      part = load_solid(drawn(seed), {});
    } catch (const Error&) {  // one cuts the other away
      continue;
    }
    for (const Face& face : part.faces) ++kinds[kSurfaceNames[face.surface.index()]];
    for (const Edge& edge : part.edges) ++kinds[kCurveNames[edge.curve.index()]];
    VoxelBody voxels = voxelize(part.name, part.mesh, {.voxel_size = kVoxel});
    for (const bool with_entities : {false, true}) {
      if (with_entities) associate(part.name, part, {}, voxels);
      const std::string bytes = to_bytes(voxels);
      const VoxelBody back = voxel_body_from(bytes);
      EXPECT_EQ(to_bytes(back), bytes);
      EXPECT_EQ(back.shell.x, voxels.shell.x);
      EXPECT_EQ(back.voxmap.layers, voxels.voxmap.layers);
      EXPECT_EQ(back.voxmap.memory_bytes(), voxels.voxmap.memory_bytes());
      EXPECT_EQ(back.features.sets.size(), voxels.features.sets.size());
      refuses_other_lengths(bytes, voxel_body_from);
    }
    const ExactBody body({&part, 1}, {.spacing = kVoxel});
    const std::string bytes = to_bytes(body);
    const ExactBody back = exact_body_from(bytes);
    EXPECT_EQ(to_bytes(back), bytes);
    EXPECT_EQ(back.features.size(), body.features.size());
    EXPECT_EQ(back.sample_c, body.sample_c);
    EXPECT_EQ(back.face_tree.leaves, body.face_tree.leaves);
    EXPECT_EQ(back.precise_face_count, body.precise_face_count);
    // What was made of the same part again is the same to the byte: nothing uninitialised is written.
    EXPECT_EQ(to_bytes(ExactBody({&part, 1}, {.spacing = kVoxel})), bytes);
    refuses_other_lengths(bytes, exact_body_from);
  }
  for (const char* kind : {"plane", "cylinder", "cone", "sphere", "torus", "line", "circle", "ellipse"})
    EXPECT_GT(kinds[kind], 0) << kind;
  EXPECT_GT(kinds["other"], 0);
}

}  // namespace
}  // namespace verisim::exact::test::body_bytes_test

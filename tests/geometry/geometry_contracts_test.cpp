// The doors of engine/geometry: meshes that hang together. What a file can get wrong is refused where it is read.
#include <limits>

#include "engine/geometry/cad_client.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/geometry/mesh_joints.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/self_intersection.hpp"
#include "tests/geometry/models.hpp"
#include "tests/support/broken.hpp"

namespace verisim::geometry_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Part box() {
  Part part;
  part.mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  return part;
}
/// One triangle names a corner that is not there.
TriangleMesh torn() {
  TriangleMesh mesh = box().mesh;
  mesh.triangles.back()[1] = 8;
  return mesh;
}

TEST(Mesh, IsWholeIfItsCornersAreThereAndAllTrianglesOrNoneKnowTheirFace) {
  TriangleMesh mesh = box().mesh;
  EXPECT_TRUE(is_whole(mesh));
  EXPECT_FALSE(is_whole(torn()));
  mesh.face_of_triangle.assign(12, 0);
  EXPECT_TRUE(is_whole(mesh));
  mesh.face_of_triangle.pop_back();
  EXPECT_FALSE(is_whole(mesh));
}

TEST(MeshDeathTest, IsTakenWhole) {
  TriangleMesh mesh = torn();
  std::vector<std::string> notes;
  EXPECT_BROKEN(examine(mesh, false), "is_whole(mesh)");
  EXPECT_BROKEN(repair(mesh, notes), "is_whole(mesh)");
  EXPECT_BROKEN(find_self_intersections(mesh), "is_whole(mesh)");
  Part part;
  part.mesh = mesh;
  EXPECT_BROKEN(to_tables(part), "is_whole(part.mesh)");
  EXPECT_BROKEN(recover_brep(part), "is_whole(part.mesh)");
}

TEST(MeshDeathTest, IsTakenFinite) {
  Part part = box();
  part.mesh.vertices[3].z() = kNaN;
  EXPECT_BROKEN(find_self_intersections(part.mesh), "is_finite(v)");
  EXPECT_BROKEN(recover_brep(part), "is_finite(v)");
}

TEST(JointsDeathTest, AreSoughtAmongOpenSidesOfTheMeshAsItIs) {
  TriangleMesh mesh = box().mesh;
  mesh.triangles.pop_back();
  std::vector<Side> open = open_sides(mesh);
  ASSERT_FALSE(open.empty());
  EXPECT_BROKEN(join_near_corners(mesh, open, -1), "is_not_negative(tolerance)");
  EXPECT_BROKEN(cut_at_joints(mesh, open, kNaN), "is_not_negative(tolerance)");
  open[0].triangle = 11;
  EXPECT_BROKEN(cut_at_joints(mesh, open, 0), "side.triangle < mesh.triangles.size()");
  open[0].high = 8;
  EXPECT_BROKEN(join_near_corners(mesh, open, 0), "end < mesh.vertices.size()");
  open[0].high = open[0].low;
  mesh.vertices[open[0].low].x() = kNaN;
  EXPECT_BROKEN(join_near_corners(mesh, open, 0), "is_finite(mesh.vertices[end])");
}

TEST(RecoverDeathTest, NeedsAPartWithoutFacesAndBounds) {
  Part part = box();
  part.faces.resize(1);
  EXPECT_BROKEN(recover_brep(part), "!part.has_brep()");
  part = box();
  EXPECT_BROKEN(recover_brep(part, {.tolerance = -1}), "is_not_negative(options.tolerance)");
  EXPECT_BROKEN(recover_brep(part, {.round_step_max = 0}), "options.round_step_max > 0");
  EXPECT_BROKEN(recover_brep(part, {.round_step_max = 4}), "options.round_step_max < pinned::kPi");
}

TEST(PartsDeathTest, AreMergedIfThereAreAnyAndMatedWithinATolerance) {
  EXPECT_BROKEN(merged({}), "!parts.empty()");
  Part half_known = box();
  half_known.mesh.face_of_triangle.resize(3);
  EXPECT_BROKEN(
      merged({half_known}),
      "part.mesh.face_of_triangle.empty() || part.mesh.face_of_triangle.size() == part.mesh.triangles.size()");
  EXPECT_BROKEN(mating_candidates({}, kNaN), "is_not_negative(tolerance)");
}

TEST(CadDeathTest, IsToldWholeSolidsAndHowLongItMayTake) {
  Solid solid;
  solid.kind = Solid::Kind::placed;
  solid.children = {nullptr};
  EXPECT_BROKEN(tables_of(solid), "child != nullptr");
  EXPECT_BROKEN(ask_cad({}, "part.step", 0), "time_limit_s > 0");
}

}  // namespace
}  // namespace verisim::geometry_contracts_test

// The doors of engine/geometry: meshes that hang together. What a file can get wrong is refused where it is read.
#include <limits>

#include "engine/geometry/analytic_surface.hpp"
#include "engine/geometry/cad_client.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/geometry/mesh_joints.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/curve_fit.hpp"
#include "engine/geometry/recover/fit_ambiguity.hpp"
#include "engine/geometry/recover/regions.hpp"
#include "engine/geometry/recover/surface_fit.hpp"
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
  EXPECT_BROKEN(bounds_of(mesh), "is_whole(mesh)");
  EXPECT_BROKEN(mass_properties_of(mesh), "is_whole(mesh)");
  EXPECT_BROKEN(area_of(mesh), "is_whole(mesh)");
  EXPECT_BROKEN(recover::canonical(mesh), "is_whole(given)");
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
  EXPECT_BROKEN(recover::canonical(part.mesh), "is_finite(v)");
}

TEST(MeshDeathTest, HasComponentsByItsOwnSides) {
  TriangleMesh mesh = box().mesh;
  const std::vector<Side> sides = sorted_sides(mesh);
  mesh.triangles.pop_back();
  EXPECT_BROKEN(components_of(mesh, sides, true), "sides.size() <= 3 * mesh.triangles.size()");
  std::vector<Side> fewer = sides;
  std::erase_if(fewer, [](const Side& side) { return side.triangle < 3; });
  EXPECT_BROKEN(components_of(mesh, fewer, true), "side.triangle < mesh.triangles.size()");
}

TEST(SurfaceDeathTest, IsPutIntoAGridAndEndsInAnApexIfItHasOne) {
  const auto plane = AnalyticSurface::from(Surface(Plane{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}));
  ASSERT_TRUE(plane);
  EXPECT_BROKEN(plane->in_grid({0, 0, 0}, 0), "is_positive(scale)");
  EXPECT_BROKEN(plane->in_grid({0, kNaN, 0}, 1), "is_finite(origin)");
  EXPECT_BROKEN((Meridian{.kind = SurfaceKind::cone, .radius = 1}.apex()), "tangent != 0");
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

TEST(FitDeathTest, IsThroughPointsToATolerance) {
  using namespace recover;
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_BROKEN(plane_through({}), "!points.empty()");
  EXPECT_BROKEN(fit(Kind::sphere, {points, {}, {}}, 0, {}), "is_positive(tolerance)");
  EXPECT_BROKEN(fit(Kind::sphere, {points, points, {}}, 1e-6, {}), "sample.centers.size() == sample.normals.size()");
  EXPECT_BROKEN(refit({}, points, kNaN, {}), "is_positive(tolerance)");
  EXPECT_BROKEN(is_unambiguous({}, points, -1, {}), "is_positive(tolerance)");
  Edge edge;
  EXPECT_BROKEN(set_curve(edge, {}, 1e-6, {}), "points.size() >= 2");
  edge.polyline = points;
  EXPECT_BROKEN(set_curve(edge, {}, 0, {}), "is_positive(tolerance)");
  EXPECT_BROKEN(set_curve(edge, {nullptr}, 1e-6, {}), "surface != nullptr");
}

TEST(RegionsDeathTest, TakeFreeTrianglesOnce) {
  const recover::CanonicalMesh mesh = recover::canonical(box().mesh);
  recover::Regions regions(mesh, 1e-6, 0.5, {});
  EXPECT_BROKEN(recover::Regions(mesh, 0, 0.5, {}), "is_positive(tolerance)");
  EXPECT_BROKEN(recover::Regions(mesh, 1e-6, 0, {}), "cos_smooth < 1");
  EXPECT_BROKEN(regions.add_curved({}, {}), "!triangles.empty()");
  EXPECT_BROKEN(regions.assign(0, 0), "region < all.size()");
  regions.add_freeform({0, 1});
  EXPECT_BROKEN(regions.add_freeform({1}), "is_free(t)");
  EXPECT_BROKEN(regions.assign(0, 0), "is_free(triangle)");
  EXPECT_BROKEN(regions.merge(0, 0), "region != into");
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
  EXPECT_BROKEN(solid.text(), "solid.children[i] != nullptr");
  EXPECT_BROKEN(ask_cad({}, "part.step", 0), "time_limit_s > 0");
}

}  // namespace
}  // namespace verisim::geometry_contracts_test

// Every entity, held against the tessellation: vertices lie on their face's surface within its bounds, triangles look
// out of the material, polylines follow their curve.
#include "engine/geometry/entity.hpp"

#include "tests/geometry/models.hpp"
#include "tests/geometry/parametrization.hpp"

namespace verisim::entity_test {
namespace {

using testing::make;
using Kind = Solid::Kind;

/// What is built here is exact to the rounding of coordinates; files sew their edges with tolerances of their own, the
/// worst of the recorded ones with 6 millionths of its size.
constexpr double kBuiltSlack = 1e-9;  // m
double sewn_slack(const Part& part) {
  return 1e-5 * bounds_of(part.mesh).size().norm();
}

void expect_vertices_on_surfaces(const Part& part, double slack) {
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const Face& face = part.faces.at(part.mesh.face_of_triangle.at(t));
    for (const std::uint32_t corner : part.mesh.triangles[t]) {
      const auto on = testing::project(face.surface, part.mesh.vertices[corner]);
      if (!on) continue;
      ASSERT_LE(std::abs(on->distance), slack) << kSurfaceNames[face.surface.index()] << ", triangle " << t;
    }
  }
}

/// The side that the triangle looks to is the material's outside. Slivers whose corners' rounding turns their normal
/// are left out: the volume has none of them.
void expect_triangles_look_outward(const Part& part) {
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = part.mesh.triangles[t];
    const auto& v = part.mesh.vertices;
    const Vector3d normal = (v[j] - v[i]).cross(v[k] - v[i]);
    const auto on = testing::project(part.faces[part.mesh.face_of_triangle[t]].surface, (v[i] + v[j] + v[k]) / 3);
    const double longest =
        std::max({(v[j] - v[i]).squaredNorm(), (v[k] - v[j]).squaredNorm(), (v[i] - v[k]).squaredNorm()});
    if (!on || normal.norm() < 0.05 * longest) continue;
    ASSERT_GT(normal.normalized().dot(on->outward), 0.3) << "triangle " << t;
  }
}

/// u and v of the triangles' corners are inside the trimmed bounds. On the axis u means nothing.
void expect_bounds_hold_the_triangles(const Part& part) {
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const Face& face = part.faces[part.mesh.face_of_triangle[t]];
    for (const std::uint32_t corner : part.mesh.triangles[t]) {
      const auto on = testing::project(face.surface, part.mesh.vertices[corner]);
      if (!on) continue;
      const double slack = 1e-5;
      const std::string which = std::string(kSurfaceNames[face.surface.index()]) + ", triangle " + std::to_string(t);
      const bool flat = std::holds_alternative<Plane>(face.surface);
      const bool round_v = std::holds_alternative<Sphere>(face.surface) || std::holds_alternative<Torus>(face.surface);
      const auto inside = [&](double x, const auto& range) { return x >= range[0] - slack && x <= range[1] + slack; };
      const bool u_inside = flat ? inside(on->u, face.u_range) : testing::angle_within(on->u, face.u_range, slack);
      const bool v_inside = round_v ? testing::angle_within(on->v, face.v_range, slack) : inside(on->v, face.v_range);
      ASSERT_TRUE(u_inside || on->on_axis) << which << " u " << on->u;
      ASSERT_TRUE(v_inside) << which << " v " << on->v;
    }
  }
}

void expect_polylines_follow_curves(const Part& part, double slack) {
  for (const Edge& edge : part.edges) {
    ASSERT_GE(edge.polyline.size(), 2U);
    ASSERT_GE(edge.faces.size(), 1U);
    ASSERT_LE(edge.faces.size(), 2U);
    const auto first = testing::point_at(edge.curve, edge.t_range[0]);
    const auto last = testing::point_at(edge.curve, edge.t_range[1]);
    if (!first) continue;
    EXPECT_LE((edge.polyline.front() - *first).norm(), slack) << kCurveNames[edge.curve.index()];
    EXPECT_LE((edge.polyline.back() - *last).norm(), slack) << kCurveNames[edge.curve.index()];
  }
}

/// Faces and edges name each other.
void expect_adjacency_is_mutual(const Part& part) {
  for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
    for (const std::uint32_t e : part.faces[f].edges) {
      const auto& back = part.edges.at(e).faces;
      EXPECT_NE(std::find(back.begin(), back.end(), f), back.end()) << "face " << f << ", edge " << e;
    }
  }
}

void expect_sound(const Part& part, double slack) {
  EXPECT_TRUE(part.watertight) << (part.notes.empty() ? "" : part.notes.front());
  EXPECT_TRUE(part.exact);
  expect_vertices_on_surfaces(part, slack);
  expect_triangles_look_outward(part);
  expect_bounds_hold_the_triangles(part);
  expect_polylines_follow_curves(part, slack);
  expect_adjacency_is_mutual(part);
}

const Quaterniond kTilt = rotation_from_vector({0.3, -0.5, 0.8});

struct NamedSolid {
  const char* name;
  Solid solid;
};

std::vector<NamedSolid> solids() {
  const Solid block = make(Kind::box, {0.2, 0.16, 0.1});
  const Solid cut_cone = testing::placed(make(Kind::cone, {0.05, 0.02, 0.12}), {0.01, 0.02, 0.03}, kTilt);
  return {
      {"Box", make(Kind::box, {0.1, 0.2, 0.3})},
      {"Cylinder", make(Kind::cylinder, {0.05, 0.4})},
      {"ConeNarrowing", make(Kind::cone, {0.05, 0.02, 0.1})},
      {"ConeWidening", make(Kind::cone, {0.02, 0.05, 0.1})},
      {"ConeWithTip", make(Kind::cone, {0.05, 0, 0.1})},
      {"ConeThatIsACylinder", make(Kind::cone, {0.05, 0.05, 0.1})},
      {"Sphere", make(Kind::sphere, {0.05})},
      {"Tube", make(Kind::tube, {0.05, 0.03, 0.2})},
      {"Torus", make(Kind::torus, {0.05, 0.02})},
      {"TiltedCylinder", testing::placed(make(Kind::cylinder, {0.05, 0.4}), {1, 2, 3}, kTilt)},
      {"ConicalHole", make(Kind::difference, block, cut_cone)},
      {"SphericalHollow",
       make(Kind::difference, block, testing::placed(make(Kind::sphere, {0.04}), {0.05, 0.02, 0.05}))},
      {"VoidInside", make(Kind::difference, block, make(Kind::sphere, {0.04}))},
      {"CrossedBores",
       make(Kind::difference, make(Kind::difference, block, make(Kind::cylinder, {0.03, 0.2})),
            testing::placed(make(Kind::cylinder, {0.02, 0.4}), {0, 0, 0}, rotation_from_vector({1.5, 0, 0})))},
      {"HalfCylinder", make(Kind::intersection, make(Kind::cylinder, {0.05, 0.1}),
                            testing::placed(make(Kind::box, {0.2, 0.2, 0.2}), {0.1, 0, 0}, kTilt))},
  };
}

class EverySolid : public ::testing::TestWithParam<NamedSolid> {};

TEST_P(EverySolid, HasEntitiesThatAgreeWithItsTriangles) {
  expect_sound(load_solid(GetParam().solid, {}), kBuiltSlack);
}

INSTANTIATE_TEST_SUITE_P(Primitives, EverySolid, ::testing::ValuesIn(solids()),
                         [](const auto& p) { return p.param.name; });

class EveryFile : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryFile, HasEntitiesThatAgreeWithItsTriangles) {
  if (!testing::models_are_here()) GTEST_SKIP() << "the shared models are not here: " << testing::model_path("");
  // Coarse: entities do not depend on the tessellation, and a sphere has a ninth of the triangles.
  for (const Part& part : testing::load(testing::model_path(GetParam()), {.angular_deflection = 0.3})) {
    SCOPED_TRACE(part.name);
    expect_sound(part, sewn_slack(part));
  }
}

INSTANTIATE_TEST_SUITE_P(RecordedModels, EveryFile,
                         ::testing::Values("freecad_cc0/axis.stp", "freecad_cc0/bearing_20x37x9.stp",
                                           "freecad_cc0/crank_arm.stp", "freecad_cc0/crank_base.stp",
                                           "freecad_cc0/crank_disk.stp", "freecad_cc0/engine_bushing.stp",
                                           "freecad_cc0/engine_conrod.stp", "freecad_cc0/engine_conrod_cap.stp",
                                           "freecad_cc0/engine_cylinder.stp", "freecad_cc0/engine_piston.stp",
                                           "occt/Axis_of_bearing.stp", "occt/mal_vis.brep", "occt/mal_tige.stp",
                                           "occt/mal_ecrou.brep", "occt/screw.step"),
                         [](const auto& p) {
                           std::string name = std::filesystem::path(p.param).filename().string();
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

// The kernel measures a cone's v along its slant, entity.hpp along the axis: a frustum from 50 to 20 mm over 100 mm.
TEST(Cone, HasVAlongItsAxisTowardsGrowingRadius) {
  const Part part = load_solid(make(Kind::cone, {0.05, 0.02, 0.1}), {});
  ASSERT_EQ(testing::face_counts(part).at("cone"), 1);
  for (const Face& face : part.faces) {
    const auto* cone = std::get_if<Cone>(&face.surface);
    if (cone == nullptr) continue;
    EXPECT_NEAR(cone->direction.z(), -1, 1e-12);  // it narrows with z
    EXPECT_NEAR(std::tan(cone->half_angle), 0.3, 1e-11);
    EXPECT_NEAR(face.v_range[1] - face.v_range[0], 0.1, 1e-10);
    EXPECT_NEAR(cone->radius + face.v_range[0] * std::tan(cone->half_angle), 0.02, 1e-10);
    EXPECT_NEAR(cone->radius + face.v_range[1] * std::tan(cone->half_angle), 0.05, 1e-10);
    EXPECT_FALSE(cone->hole);
  }
}

TEST(HoleFlag, TellsABoreFromAPin) {
  const Part tube = load_solid(make(Kind::tube, {0.05, 0.03, 0.2}), {});
  std::map<double, bool> hole_of_radius;
  for (const Face& face : tube.faces) {
    if (const auto* cylinder = std::get_if<Cylinder>(&face.surface)) hole_of_radius[cylinder->radius] = cylinder->hole;
  }
  ASSERT_EQ(hole_of_radius.size(), 2U);
  EXPECT_TRUE(hole_of_radius.begin()->second);
  EXPECT_FALSE(hole_of_radius.rbegin()->second);
}

}  // namespace
}  // namespace verisim::entity_test

#include "engine/geometry/solid.hpp"

#include <limits>

#include "tests/geometry/models.hpp"

namespace verisim::solid_test {
namespace {

using testing::error_of;
using testing::make;
using testing::placed;
using Kind = Solid::Kind;

constexpr double kPi = 3.14159265358979323846;

const Cylinder* cylinder_of(const Part& part, bool hole) {
  for (const Face& face : part.faces) {
    const auto* cylinder = std::get_if<Cylinder>(&face.surface);
    if (cylinder != nullptr && cylinder->hole == hole) return cylinder;
  }
  return nullptr;
}

struct ClosedForm {
  const char* name;
  Solid solid;
  double volume;
  double area;
};

std::vector<ClosedForm> closed_forms() {
  const double slant = std::hypot(0.1, 0.03);
  return {
      {"Box", make(Kind::box, {0.1, 0.2, 0.3}), 0.006, 2 * (0.02 + 0.03 + 0.06)},
      {"Cylinder", make(Kind::cylinder, {0.05, 0.4}), kPi * 0.0025 * 0.4, 2 * kPi * 0.05 * 0.45},
      {"Cone", make(Kind::cone, {0.05, 0.02, 0.1}), kPi * 0.1 / 3 * (0.0025 + 0.001 + 0.0004),
       kPi * (0.07 * slant + 0.0025 + 0.0004)},
      {"Sphere", make(Kind::sphere, {0.05}), 4.0 / 3 * kPi * 0.000125, 4 * kPi * 0.0025},
      {"Tube", make(Kind::tube, {0.05, 0.03, 0.2}), kPi * 0.0016 * 0.2, 2 * kPi * (0.08 * 0.2 + 0.0016)},
      {"Torus", make(Kind::torus, {0.05, 0.02}), 2 * kPi * kPi * 0.05 * 0.0004, 4 * kPi * kPi * 0.05 * 0.02},
  };
}

class EveryPrimitive : public ::testing::TestWithParam<ClosedForm> {};

// Numbers are rounded to 40 bits (2^-40 = 9e-13 relative); the kernel's integration adds a few more units.
TEST_P(EveryPrimitive, HasTheVolumeAndAreaOfItsClosedForm) {
  const Part part = load_solid(GetParam().solid, {});
  EXPECT_NEAR(part.mass.volume, GetParam().volume, 1e-11 * GetParam().volume);
  EXPECT_NEAR(part.area, GetParam().area, 1e-11 * GetParam().area);
  EXPECT_LE(part.mass.centroid.head<2>().norm(), 0x1p-30);
}

// Chords lie inside pins and outside holes, at most a deflection and an angle of 0.1 rad off: 1 - sin(0.1)/0.1 = 0.2 %.
TEST_P(EveryPrimitive, IsTessellatedToWithinHalfAPercentOfItsVolume) {
  const Part part = load_solid(GetParam().solid, {});
  EXPECT_TRUE(part.watertight);
  EXPECT_NEAR(mass_properties_of(part.mesh).volume, part.mass.volume, 0.005 * part.mass.volume);
  EXPECT_NEAR(area_of(part.mesh), part.area, 0.005 * part.area);
}

INSTANTIATE_TEST_SUITE_P(Primitives, EveryPrimitive, ::testing::ValuesIn(closed_forms()),
                         [](const auto& p) { return p.param.name; });

// A cylinder about its axis: V R^2 / 2, across: V (3 R^2 + h^2) / 12.
TEST(LoadSolid, GivesTheInertiaOfTheClosedForm) {
  const Part part = load_solid(make(Kind::cylinder, {0.05, 0.4}), {});
  const double v = kPi * 0.0025 * 0.4;
  EXPECT_NEAR(part.mass.inertia(2, 2), v * 0.0025 / 2, 1e-11 * v);
  EXPECT_NEAR(part.mass.inertia(0, 0), v * (3 * 0.0025 + 0.16) / 12, 1e-11 * v);
  EXPECT_NEAR(part.mass.inertia(0, 1), 0, 1e-13 * v);
}

// The dissertation's block: 200 mm with a bore. Six planes, one hole, and the two rims among 12 + 2 + 1 edges (a seam).
TEST(LoadSolid, CutsABoreIntoABlockExactly) {
  const Part part =
      load_solid(make(Kind::difference, make(Kind::box, {0.2, 0.2, 0.2}), make(Kind::cylinder, {0.05, 0.4})), {});
  EXPECT_EQ(testing::face_counts(part), (std::map<std::string, int>{{"plane", 6}, {"cylinder", 1}}));
  ASSERT_NE(cylinder_of(part, true), nullptr);
  EXPECT_NEAR(cylinder_of(part, true)->radius, 0.05, 1e-13);
  EXPECT_NEAR(part.mass.volume, 0.008 - kPi * 0.0025 * 0.2, 1e-11 * 0.008);
  int circles = 0;
  for (const Edge& edge : part.edges) {
    if (const auto* circle = std::get_if<Circle>(&edge.curve)) {
      ++circles;
      EXPECT_NEAR(circle->radius, 0.05, 1e-13);
      EXPECT_NEAR(edge.length, 0.1 * kPi, 1e-11);
      EXPECT_EQ(edge.faces.size(), 2U);
    }
  }
  EXPECT_EQ(circles, 2);
  EXPECT_EQ(part.edges.size(), 15U);
}

// Two boxes side by side are one box: the walls between them go, the faces that continue each other become one.
TEST(LoadSolid, UnitesFacesThatContinueEachOther) {
  const Solid half = make(Kind::box, {0.1, 0.1, 0.1});
  const Part part = load_solid(make(Kind::sum, half, placed(half, {0.1, 0, 0})), {});
  EXPECT_EQ(part.faces.size(), 6U);
  EXPECT_EQ(part.edges.size(), 12U);
  EXPECT_NEAR(part.mass.volume, 0.002, 1e-14);
}

TEST(LoadSolid, KeepsBothHalvesOfABlockCutInTwo) {
  const Part part =
      load_solid(make(Kind::difference, make(Kind::box, {0.3, 0.1, 0.1}), make(Kind::box, {0.1, 0.2, 0.2})), {});
  EXPECT_EQ(part.faces.size(), 12U);
  EXPECT_TRUE(part.watertight);
  EXPECT_NEAR(part.mass.volume, 0.002, 1e-14);
}

TEST(LoadSolid, GivesTheSameBitsTwice) {
  const Solid solid = make(Kind::difference, make(Kind::box, {0.2, 0.2, 0.2}), make(Kind::cylinder, {0.05, 0.4}));
  const std::vector<NamedArray> a = to_tables(load_solid(solid, {}));
  const std::vector<NamedArray> b = to_tables(load_solid(solid, {}));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].bytes, b[i].bytes) << a[i].name;
}

TEST(LoadSolid, TessellatesToTheDeflectionAskedFor) {
  const Solid ball = make(Kind::sphere, {0.05});
  const Part coarse = load_solid(ball, {.deflection = 1e-3, .angular_deflection = 1});
  const Part fine = load_solid(ball, {.deflection = 1e-5, .angular_deflection = 1});
  EXPECT_GT(fine.mesh.triangles.size(), 10 * coarse.mesh.triangles.size());
  for (const auto& [i, j, k] : fine.mesh.triangles) {
    const Vector3d middle = (fine.mesh.vertices[i] + fine.mesh.vertices[j] + fine.mesh.vertices[k]) / 3;
    EXPECT_GT(middle.norm(), 0.05 - 2e-5);
  }
}

TEST(LoadSolid, RefusesWhatLeavesNothing) {
  const Solid box = make(Kind::box, {0.1, 0.1, 0.1});
  const std::string error = error_of(ErrorKind::input, [&] {
    static_cast<void>(load_solid(make(Kind::difference, box, make(Kind::box, {0.2, 0.2, 0.2})), {}));
  });
  EXPECT_NE(error.find("nothing is left"), std::string::npos) << error;
}

TEST(Check, RefusesSizesThatAreNoLengths) {
  for (const double bad :
       {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(check(make(Kind::box, {0.1, bad, 0.1})), Error) << bad;
    EXPECT_THROW(check(make(Kind::sphere, {bad})), Error) << bad;
    EXPECT_THROW(check(make(Kind::cone, {0.1, 0.1, bad})), Error) << bad;
  }
  EXPECT_EQ(error_of(ErrorKind::input,
                     [] {
                       check(make(Kind::cylinder, {0.1, -2}));
                     }),
            "Solid.cylinder: height is -2 m; give a finite length above 0");
}

TEST(Check, RefusesSizesThatDoNotFitEachOther) {
  EXPECT_THROW(check(make(Kind::tube, {0.1, 0.1, 1})), Error);
  EXPECT_THROW(check(make(Kind::torus, {0.1, 0.1})), Error);
  EXPECT_THROW(check(make(Kind::cone, {0, 0, 1})), Error);
  EXPECT_THROW(check(make(Kind::box, {0.1, 0.1})), Error);
  EXPECT_NO_THROW(check(make(Kind::cone, {0.1, 0, 1})));
}

TEST(Check, RefusesMissingChildrenAndPlacementsThatAreNone) {
  EXPECT_THROW(check(make(Kind::sum, {})), Error);
  EXPECT_THROW(check(Solid{Kind::placed, {}, {nullptr}, {}}), Error);
  const Solid box = make(Kind::box, {1, 1, 1});
  EXPECT_THROW(check(placed(box, {0, 0, std::numeric_limits<double>::quiet_NaN()})), Error);
  EXPECT_THROW(check(placed(box, {0, 0, 0}, Quaterniond(2, 0, 0, 0))), Error);
}

// s = s + s, forty times over: one line of Lua for 2^40 boxes.
TEST(Check, RefusesASolidOfAMillionPieces) {
  auto solid = std::make_shared<const Solid>(make(Kind::box, {1, 1, 1}));
  for (int i = 0; i < 40; ++i) solid = std::make_shared<const Solid>(Solid{Kind::sum, {}, {solid, solid}, {}});
  EXPECT_THROW(check(*solid), Error);
}

TEST(Text, IsEqualForEqualSolidsAndDiffersForOthers) {
  const Solid a = placed(make(Kind::cylinder, {0.05, 0.4}), {0, -0.0, 1}, Quaterniond(0.6, 0, 0, 0.8));
  const Solid same = placed(make(Kind::cylinder, {0.05, 0.4}), {-0.0, 0, 1}, Quaterniond(-0.6, 0, 0, -0.8));
  const Solid other = placed(make(Kind::cylinder, {0.05, 0.4 * (1 + 0x1p-52)}), {0, 0, 1}, Quaterniond(0.6, 0, 0, 0.8));
  EXPECT_EQ(a.text(), "placed(0,0,1;0,0,0.8,0.6;cylinder(0.05,0.4))");
  EXPECT_EQ(a.text(), same.text());
  EXPECT_NE(a.text(), other.text());
}

}  // namespace
}  // namespace verisim::solid_test

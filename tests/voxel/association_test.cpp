// The association's laws on small parts: order and identity of sets, threads, bad input, entities declared by hand.
// That sets hold the right entities is association_kernel_test.cpp's.
#include "engine/voxel/association.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/voxel/slot_sets.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/geometry/models.hpp"
#include "tests/support/refusal.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::association_test {
namespace {

using testing::make;
using testing::placed;
using Kind = Solid::Kind;

Part drilled_block() {
  return load_solid(make(Kind::difference, make(Kind::box, {0.06, 0.05, 0.03}), make(Kind::cylinder, {0.01, 0.1})), {});
}

VoxelBody associated(const Part& part, double voxel_size, const AssociateOptions& options = {}) {
  VoxelBody body = voxelize(part.name, part.mesh, {.voxel_size = voxel_size});
  associate(part.name, part, options, body);
  return body;
}

Vector3d center(const VoxelBody& body, std::uint32_t voxel) {
  const Pointshell& shell = body.shell;
  return shell.reference + Vector3d(shell.x[voxel], shell.y[voxel], shell.z[voxel]);
}

std::vector<EntityNumber> set_of(const VoxelBody& body, std::uint32_t voxel) {
  const std::span<const EntityNumber> set = body.features.sets[body.shell.features[voxel]];
  return {set.begin(), set.end()};
}

TEST(Association, NumbersSetsInTheOrderOfTheirFirstVoxels) {
  const VoxelBody body = associated(drilled_block(), 0.002);
  FeatureSetId largest = 0;
  for (const FeatureSetId id : body.shell.features) {
    EXPECT_LE(id, largest + 1);
    largest = std::max(largest, id);
  }
  EXPECT_EQ(largest + 1U, body.features.sets.size());
  for (std::size_t id = 1; id < body.features.sets.size(); ++id) {
    for (std::size_t other = 0; other < id; ++other) {
      EXPECT_FALSE(std::ranges::equal(body.features.sets[static_cast<FeatureSetId>(id)],
                                      body.features.sets[static_cast<FeatureSetId>(other)]));
    }
  }
}

TEST(Association, IsTheSameForAnyNumberOfThreads) {
  const Part part = drilled_block();
  const VoxelBody one = associated(part, 0.0007);
  for (const unsigned threads : {2U, 5U}) {
    const VoxelBody many = associated(part, 0.0007, {.threads = threads});
    EXPECT_EQ(many.shell.features, one.shell.features);
    EXPECT_EQ(many.features.sets.size(), one.features.sets.size());
  }
}

TEST(Association, OfAVoxelIsFoundByItsSlotAndByItsPoint) {
  const VoxelBody body = associated(drilled_block(), 0.002);
  std::uint32_t found = 0;
  for (std::uint32_t slot = 0; slot < body.voxmap.layers.size(); ++slot) {
    const std::int64_t number = surface_number_of_slot(body.voxmap, slot);
    if (number < 0) {
      if (body.voxmap.layers[slot] > 0) {
        ASSERT_EQ(feature_at(body, slot), 0);
      }
      continue;
    }
    ASSERT_EQ(number, found++);
    ASSERT_EQ(feature_at(body, slot), body.shell.features[static_cast<std::size_t>(number)]);
    ASSERT_EQ(feature_of_point(body.shell, static_cast<std::uint32_t>(number)), feature_at(body, slot));
  }
  EXPECT_EQ(found, body.voxmap.surface_count);
}

/// The set of a voxel by its cell, without bricks.
FeatureSetId set_of_cell(const VoxelBody& body, const Eigen::Vector3i& c) {
  const Voxmap& map = body.voxmap;
  const Eigen::Vector3i b = c / kBrickSide;
  const auto brick = static_cast<std::size_t>((b.z() * map.bricks.y() + b.y()) * map.bricks.x() + b.x());
  const auto cell = static_cast<std::uint32_t>(c.x() % 8 + 8 * (c.y() % 8) + 64 * (c.z() % 8));
  return feature_at(body, map.brick_block[brick] * kBrickCells + cell);
}

/// By the plain definition in slot_sets.hpp: the sets of the neighbours one layer nearer to the surface, by distance.
FeatureSetId plainly_inherited(const VoxelBody& body, const Eigen::Vector3i& cell) {
  std::array<std::vector<FeatureSetId>, 4> by_distance;
  std::vector<FeatureSetId> all;
  for (int away = 1; away <= 3; ++away)
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const Eigen::Vector3i there = cell + Eigen::Vector3i(x, y, z);
          if (x * x + y * y + z * z != away || body.voxmap.layer(there) != body.voxmap.layer(cell) + 1) continue;
          by_distance[static_cast<std::size_t>(away)].push_back(set_of_cell(body, there));
          all.push_back(set_of_cell(body, there));
        }
  for (const std::vector<FeatureSetId>& nearest : by_distance) {
    if (nearest.empty()) continue;
    if (std::ranges::count(nearest, nearest.front()) == std::ssize(nearest)) return nearest.front();
    return *std::ranges::max_element(all, {}, [&](FeatureSetId id) { return body.features.sets[id].size(); });
  }
  return 0;
}

TEST(Association, BehindTheSurfaceIsThatOfTheSurfaceInFront) {
  const VoxelBody body = associated(drilled_block(), 0.0013, {.threads = 3});
  const Voxmap& map = body.voxmap;
  std::array<std::size_t, kInheritedLayers + 1> checked{};
  for (int z = 0; z < 8 * map.bricks.z(); ++z)
    for (int y = 0; y < 8 * map.bricks.y(); ++y)
      for (int x = 0; x < 8 * map.bricks.x(); ++x) {
        const Eigen::Vector3i cell(x, y, z);
        const Layer layer = map.layer(cell);
        if (layer < -kInheritedLayers) {
          ASSERT_EQ(set_of_cell(body, cell), 0);
        }
        if (layer > 0 || layer < -kInheritedLayers) continue;
        const FeatureSetId expected = layer < 0
                                          ? plainly_inherited(body, cell)
                                          : body.shell.features[static_cast<std::size_t>(map.surface_number(cell))];
        ASSERT_EQ(set_of_cell(body, cell), expected) << cell.transpose();
        ASSERT_NE(expected, 0);
        ++checked[static_cast<std::size_t>(-layer)];
      }
  for (const std::size_t cells : checked) EXPECT_GT(cells, 0U);
}

TEST(Association, RefusesMoreSetsThanAllowedAndNamesThePart) {
  const Part part = drilled_block();
  VoxelBody body = voxelize("bracket", part.mesh, {.voxel_size = 0.002});
  test::expect_refused([&] { return associate("bracket", part, {.most_sets = 20}, body); },
                       "'bracket': more than 20 different sets");
}

TEST(Association, OfAPartThatIsThereTwiceHoldsBothOfEveryFace) {
  const Part once = drilled_block();
  Part twice = once;
  const auto faces = static_cast<std::uint32_t>(once.faces.size()),
             edges = static_cast<std::uint32_t>(once.edges.size());
  twice.faces.insert(twice.faces.end(), once.faces.begin(), once.faces.end());
  twice.edges.insert(twice.edges.end(), once.edges.begin(), once.edges.end());
  testing::append(twice.mesh, once.mesh);
  for (const std::uint32_t face : once.mesh.face_of_triangle) twice.mesh.face_of_triangle.push_back(face + faces);
  for (std::size_t i = faces; i < twice.faces.size(); ++i) {
    for (std::uint32_t& edge : twice.faces[i].edges) edge += edges;
  }
  for (std::size_t i = edges; i < twice.edges.size(); ++i) {
    for (std::uint32_t& face : twice.edges[i].faces) face += faces;
  }
  const VoxelBody single = associated(once, 0.002), both = associated(twice, 0.002);
  ASSERT_EQ(single.voxmap.surface_count, both.voxmap.surface_count);
  for (std::uint32_t i = 0; i < single.voxmap.surface_count; ++i) {
    std::vector<EntityNumber> wanted;
    for (const EntityNumber e : set_of(single, i)) {
      const EntityNumber in_both = e < faces ? e : e + faces;
      wanted.push_back(in_both);
      wanted.push_back(in_both + (e < faces ? faces : edges));
    }
    std::ranges::sort(wanted);
    ASSERT_EQ(set_of(both, i), wanted) << "voxel " << i;
  }
}

/// Every triangle a face of no known kind, with its sides as edges: thousands of faces.
Part freeform(const TriangleMesh& mesh) {
  Part part;
  part.name = "freeform";
  part.mesh = mesh;
  part.mesh.face_of_triangle.clear();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    part.mesh.face_of_triangle.push_back(t);
    part.faces.push_back({.surface = OtherSurface{}, .edges = {}});
  }
  return part;
}

TEST(Association, OfThousandsOfFreeformFacesFollowsTheirTriangles) {
  TriangleMesh mesh = load_solid(make(Kind::sphere, {0.02}), {.deflection = 0.00001}).mesh;
  ASSERT_GT(mesh.triangles.size(), 2000U);
  const Part part = freeform(mesh);
  const VoxelBody body = associated(part, 0.001);
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; i += 37) {
    std::vector<EntityNumber> wanted;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      if (triangle_touches_box(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], center(body, i), 0.0005)) {
        wanted.push_back(t);
      }
    }
    ASSERT_EQ(set_of(body, i), wanted) << "voxel " << i;
  }
}

TEST(Association, PassesByEntitiesThatTouchNoVoxelOrAreNothing) {
  Part part = drilled_block();
  const VoxelBody before = associated(part, 0.002);
  const auto faces = static_cast<EntityNumber>(part.faces.size());
  Edge far;
  far.curve = Line{{5, 5, 5}, Vector3d::UnitX()};
  far.t_range = {0, 1};
  Edge empty;
  empty.curve = OtherCurve{};
  part.edges.push_back(far);
  part.edges.push_back(empty);
  part.faces.push_back({.surface = Sphere{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), 0, false}, .edges = {}});
  const VoxelBody after = associated(part, 0.002);
  for (std::uint32_t i = 0; i < before.voxmap.surface_count; ++i) {
    std::vector<EntityNumber> wanted = set_of(before, i);
    for (EntityNumber& e : wanted) e += e >= faces ? 1 : 0;  // one more face stands before the edges
    ASSERT_EQ(set_of(after, i), wanted);
  }
}

TEST(Association, GivesAVoxelThatOnlyTrianglesTouchTheirFace) {
  const Part part = load_solid(make(Kind::sphere, {0.02}), {.deflection = 0.001, .angular_deflection = 0.5});
  VoxelBody body = voxelize("ball", part.mesh, {.voxel_size = 0.0005});
  const AssociationReport report = associate("ball", part, {}, body);
  EXPECT_GT(report.stand_ins, 1000U) << "a tessellation far coarser than its voxels";
  EXPECT_EQ(report.without, 0U);
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) ASSERT_EQ(set_of(body, i).front(), 0U);
}

// --- by hand --------------------------------------------------------------------------------------------------------

Face cylinder_face(double radius) {
  return {.surface = Cylinder{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), radius, false}, .edges = {}};
}

/// As the published demonstration does: voxels within one and a half of the radius get the cylinder.
DeclaredFeatures near_cylinder(const VoxelBody& body, double radius) {
  DeclaredFeatures declared;
  const DeclaredFeatures::Entity entity = cylinder_face(radius);
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    const Vector3d p = center(body, i);
    if (std::abs(std::hypot(p.x(), p.y()) - radius) > 1.5 * body.voxmap.voxel_size) continue;
    declared.assign(body, i, declared.add("block", {&entity, 1}));
  }
  return declared;
}

TEST(DeclaredFeatures, MakeTheFirstAddedSetNumberOne) {
  Part part = drilled_block();
  part.faces.clear();
  part.edges.clear();
  part.mesh.face_of_triangle.clear();
  VoxelBody body = voxelize("block", part.mesh, {.voxel_size = 0.002});
  const DeclaredFeatures declared = near_cylinder(body, 0.01);
  EXPECT_EQ(declared.size(), 1U) << "equal sets are one set";
  EXPECT_EQ(declared.entities_in(1), 1U);
  associate("block", part, {.declared = &declared}, body);
  std::size_t with = 0;
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    const Vector3d p = center(body, i);
    const bool near = std::abs(std::hypot(p.x(), p.y()) - 0.01) <= 1.5 * 0.002;
    ASSERT_EQ(body.shell.features[i], near ? 1 : 0);
    with += near ? 1 : 0;
  }
  EXPECT_GT(with, 100U);
  const auto& cylinder = std::get<Cylinder>(body.features.face(0).surface);
  EXPECT_TRUE(cylinder.hole) << "the material is outside";
  EXPECT_NEAR(body.features.face(0).v_range[0], -0.015, 0.0021);
  EXPECT_NEAR(body.features.face(0).v_range[1], 0.015, 0.0021);
}

// Known to a voxel without its rims, exactly with them.
TEST(DeclaredFeatures, EndACylinderAtItsRims) {
  const Part part = drilled_block();
  const VoxelBody body = voxelize("block", part.mesh, {.voxel_size = 0.002});
  const Vector3d z = Vector3d::UnitZ();
  DeclaredFeatures declared;
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    const Vector3d p = center(body, i);
    if (std::abs(std::hypot(p.x(), p.y()) - 0.01) > 0.002) continue;
    std::vector<DeclaredFeatures::Entity> set = {cylinder_face(0.01)};
    Edge rim;
    rim.curve = Circle{(p.z() < 0 ? -0.015 : 0.015) * z, z, Vector3d::UnitX(), 0.01};
    Edge wider = rim;
    std::get<Circle>(wider.curve).radius = 0.02;
    if (std::abs(std::abs(p.z()) - 0.015) <= 0.001) set.insert(set.end(), {wider, rim});
    declared.assign(body, i, declared.add("block", set));
  }
  EXPECT_NEAR(declared.faces()[0].v_range[0], -0.015, 1e-12);
  EXPECT_NEAR(declared.faces()[0].v_range[1], 0.015, 1e-12);
}

TEST(DeclaredFeatures, ReplaceThePartsOwnInTheirVoxelsAndExtendItsFaces) {
  const Part part = drilled_block();
  const VoxelBody own = associated(part, 0.002);
  VoxelBody body = voxelize("block", part.mesh, {.voxel_size = 0.002});
  const DeclaredFeatures declared = near_cylinder(body, 0.01);
  associate("block", part, {.declared = &declared}, body);
  ASSERT_EQ(body.features.faces.size(), part.faces.size() + 1);
  const auto added = static_cast<EntityNumber>(part.faces.size());
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    std::vector<EntityNumber> wanted = set_of(own, i);
    for (EntityNumber& e : wanted) e += e >= added ? 1 : 0;
    if (declared.of_voxel()[i] != 0) wanted = {added};
    ASSERT_EQ(set_of(body, i), wanted);
  }
}

TEST(DeclaredFeatures, TellsEqualEntitiesFromOthersByTheirNumbers) {
  DeclaredFeatures declared;
  const DeclaredFeatures::Entity a = cylinder_face(0.01), b = cylinder_face(0.02);
  const std::array<DeclaredFeatures::Entity, 2> both = {a, b}, reversed = {b, a};
  EXPECT_EQ(declared.add("part", {&a, 1}), 1);
  EXPECT_EQ(declared.add("part", both), 2);
  EXPECT_EQ(declared.add("part", reversed), 2);
  EXPECT_EQ(declared.add("part", {&b, 1}), 3);
  EXPECT_EQ(declared.add("part", {}), 0);
  EXPECT_EQ(declared.faces().size(), 2U);
  EXPECT_EQ(declared.entities_in(2), 2U);
}

constexpr double kRing = 0.012, kTube = 0.004;  // m

/// Half of the tube's profile or all of it, from one angle to the other.
std::vector<std::array<double, 2>> tube_profile(double from, double to) {
  constexpr int kSteps = 32;
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = from + (to - from) * i / kSteps;
    profile.push_back({kRing + kTube * std::cos(angle), kTube * std::sin(angle)});
  }
  return profile;
}

/// Gives the voxels that the torus passes through the torus.
DeclaredFeatures near_torus(const VoxelBody& body) {
  DeclaredFeatures declared;
  const Face face = {.surface = Torus{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), kRing, kTube, false},
                     .edges = {}};
  const DeclaredFeatures::Entity entity = face;
  for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
    const Vector3d p = center(body, i);
    const double from_tube = std::hypot(std::hypot(p.x(), p.y()) - kRing, p.z()) - kTube;
    if (std::abs(from_tube) > 0.5 * body.voxmap.voxel_size) continue;
    declared.assign(body, i, declared.add("ring", {&entity, 1}));
  }
  return declared;
}

// The groove of a bearing's inner ring has the material outside of the tube that its balls fill, a hoop has it inside.
TEST(DeclaredFeatures, TakeATorusGrooveForAHoleAndAHoopForNone) {
  const auto torus_of = [](const std::vector<std::array<double, 2>>& profile) {
    const VoxelBody body = voxelize("ring", shapes::turned(profile, 96), {.voxel_size = 0.001});
    const DeclaredFeatures declared = near_torus(body);
    EXPECT_EQ(declared.faces().size(), 1U);
    return std::get<Torus>(declared.faces().front().surface);
  };
  constexpr double kPi = std::numbers::pi;
  EXPECT_FALSE(torus_of(tube_profile(0, 2 * kPi)).hole);
  std::vector<std::array<double, 2>> grooved = {{0.006, -0.008}, {kRing, -0.008}};
  for (const auto& p : tube_profile(1.5 * kPi, 0.5 * kPi)) grooved.push_back(p);
  for (const auto& p : {std::array{kRing, kTube}, {kRing, 0.008}, {0.006, 0.008}}) grooved.push_back(p);
  EXPECT_TRUE(torus_of(grooved).hole);
}

const Vector3d kO = Vector3d::Zero(), kX = Vector3d::UnitX(), kZ = Vector3d::UnitZ();

// What is wrong with one number of each kind is entity_check_test's; here: it is asked, and what only declaring
// forbids.
TEST(DeclaredFeatures, RefuseEntitiesThatAreNone) {
  DeclaredFeatures declared;
  const auto refused = [&](const DeclaredFeatures::Entity& entity, const char* why) {
    test::expect_refused([&] { return declared.add("pin", {&entity, 1}); }, why);
  };
  const auto face = [](const Surface& surface) { return Face{.surface = surface, .edges = {}}; };
  refused(face(Cylinder{kO, kZ, kX, 0, false}),
          "'pin': a declared cylinder has a radius of 0 m but it must be above 0");
  refused(face(Cone{kO, kZ, kX, -0.01, 0.5, false}),
          "'pin': a declared cone has a radius of -0.01 m but it must be 0 or more");
  refused(face(Plane{kO, 2 * kZ, kX}), "'pin': a declared plane has a normal of length 2");
  refused(face(Torus{kO, kZ, kX, 0.02, 0.0201, false}),
          "'pin': a declared torus has a minor radius of 0.0201 m but it must not be above the major one, 0.02 m");
  refused(face(OtherSurface{}), "'pin': a declared other has no equation");
  Edge edge;
  edge.curve = Circle{kO, kZ, kX, 0};
  refused(edge, "'pin': a declared circle has a radius of 0 m");
  edge.curve = OtherCurve{};
  refused(edge, "no equation");
  EXPECT_EQ(declared.size(), 0U);
  EXPECT_TRUE(declared.faces().empty());
}

}  // namespace
}  // namespace verisim::association_test

// The association against the CAD kernel, voxel by voxel: an entity is in a voxel's set exactly if the kernel's own
// distance between the voxel's box and the entity is zero. The kernel takes milliseconds a distance, so a sample of the
// voxels is asked; VERISIM_LONG_TESTS=1 asks fifty times as many.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>

#include "engine/voxel/association.hpp"
#include "engine/voxel/overlap.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/geometry/models.hpp"
#include "tests/length.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/voxel/kernel_shapes.hpp"

namespace verisim::association_kernel_test {
namespace {

using testing::make;
using testing::placed;
using Kind = Solid::Kind;

struct Case {
  const char* name;
  test::KernelPart (*part)();
  double voxel_size;  ///< m
};

test::KernelPart from_file(const char* name, int index = 0) {
  return test::kernel_part_of_file(testing::model_path(name), index);
}

/// A rotation that lays nothing along the grid.
Quaterniond askew() {
  return Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
}

test::KernelPart trial_block() {
  return test::kernel_part_of(
      make(Kind::difference, make(Kind::box, {0.375, 0.375, 0.2}), make(Kind::cylinder, {0.075, 0.3})));
}
test::KernelPart trial_pin() {
  return test::kernel_part_of(make(Kind::cylinder, {0.07, 0.2}));
}
test::KernelPart tilted_block() {
  const Solid drilled = make(Kind::difference, make(Kind::box, {0.06, 0.05, 0.03}),
                             placed(make(Kind::cylinder, {0.01, 0.1}), {0.01, 0, 0}));
  return test::kernel_part_of(placed(drilled, {0.001, 0.002, 0.003}, askew()));
}
test::KernelPart cone() {
  return test::kernel_part_of(placed(make(Kind::cone, {0.03, 0.01, 0.05}), {0, 0, 0}, askew()));
}
test::KernelPart pointed_cone() {
  return test::kernel_part_of(make(Kind::cone, {0.03, 0, 0.05}));
}
test::KernelPart sphere() {
  return test::kernel_part_of(make(Kind::sphere, {0.03}));
}
test::KernelPart bitten_sphere() {
  const Solid ball = make(Kind::difference, make(Kind::sphere, {0.03}),
                          placed(make(Kind::box, {0.05, 0.05, 0.05}), {0.03, 0.02, 0.03}));
  return test::kernel_part_of(placed(ball, {0, 0, 0}, askew()));
}
test::KernelPart tube() {
  return test::kernel_part_of(placed(make(Kind::tube, {0.03, 0.024, 0.05}), {0, 0, 0}, askew()));
}
/// A pin that leaves a tilted plate through its side: an ellipse, and a curve of no kind.
test::KernelPart tilted_cut() {
  const Quaterniond tilt(Eigen::AngleAxisd(0.4, Vector3d::UnitX()));
  const Solid cut = make(Kind::difference, make(Kind::cylinder, {0.02, 0.08}),
                         placed(make(Kind::box, {0.1, 0.1, 0.05}), {0, 0, 0.05}, tilt));
  const Solid crossed = make(Kind::difference, cut,
                             placed(make(Kind::cylinder, {0.008, 0.1}), {0, 0, -0.02},
                                    Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()))));
  return test::kernel_part_of(crossed);
}
/// Holes hardly wider than a voxel, with walls thinner than one.
test::KernelPart fine_comb() {
  Solid comb = make(Kind::box, {0.02, 0.012, 0.006});
  for (int i = 0; i < 3; ++i) {
    comb = make(Kind::difference, comb, placed(make(Kind::cylinder, {0.0011, 0.02}), {0.0013 * i, 0.0021, 0.0004}));
  }
  return test::kernel_part_of(comb);
}

const std::vector<Case> kSolids = {{"TrialBlock", trial_block, 0.0045},     {"TrialPin", trial_pin, 0.0045},
                                   {"TiltedBlock", tilted_block, 0.0013},   {"Cone", cone, 0.0017},
                                   {"PointedCone", pointed_cone, 0.0017},   {"Sphere", sphere, 0.0017},
                                   {"BittenSphere", bitten_sphere, 0.0017}, {"Tube", tube, 0.0017},
                                   {"TiltedCut", tilted_cut, 0.0013},       {"FineComb", fine_comb, 0.001}};

const std::vector<Case> kFiles = {
    {"Screw", [] { return from_file("occt/screw.step"); }, 0.0006},
    {"Vis", [] { return from_file("occt/mal_vis.stp"); }, 0.0015},
    {"BearingBall", [] { return from_file("freecad_cc0/bearing_20x37x9.stp", 0); }, 0.0005},
    {"BearingRing", [] { return from_file("freecad_cc0/bearing_20x37x9.stp", 14); }, 0.0005},
    {"BearingOtherRing", [] { return from_file("freecad_cc0/bearing_20x37x9.stp", 15); }, 0.0005},
    {"Axis", [] { return from_file("freecad_cc0/axis.stp"); }, 0.0021},
    {"Conrod", [] { return from_file("freecad_cc0/engine_conrod.stp"); }, 0.0023},
    {"Piston", [] { return from_file("freecad_cc0/engine_piston.stp"); }, 0.0031},
    {"Bushing", [] { return from_file("freecad_cc0/engine_bushing.stp"); }, 0.0006},
    {"AxisOfBearing", [] { return from_file("occt/Axis_of_bearing.stp", 0); }, 0.0015},
};

bool is_by_triangles(const Part& part, EntityNumber entity) {
  if (entity < part.faces.size()) return std::holds_alternative<OtherSurface>(part.faces[entity].surface);
  return std::holds_alternative<OtherCurve>(part.edges[entity - part.faces.size()].curve);
}

constexpr double kKernelZero = 1e-11;  // m: the kernel finds up to 1e-13 where things meet

struct Compared {
  std::size_t distances = 0, equal = 0, undecided = 0, stand_ins = 0;
};

/// Asks the kernel about every entity and one voxel.
void compare(const test::KernelPart& model, const VoxelBody& body, const Eigen::Vector3i& cell, Compared& compared) {
  const auto number = static_cast<std::size_t>(body.voxmap.surface_number(cell));
  const std::span<const EntityNumber> set = body.features.sets[body.shell.features[number]];
  const Vector3d center = body.voxmap.center_of(cell);
  const double size = body.voxmap.voxel_size, deflection = bounds_of(model.part.mesh).size().norm() / 2000;
  std::vector<EntityNumber> passing;
  bool undecided = false;
  for (EntityNumber e = 0; e < model.entities.size(); ++e) {
    const double distance = test::kernel_distance(model, e, center, 0.5 * size);
    if (std::isfinite(distance)) ++compared.distances;
    if (distance < kKernelZero) passing.push_back(e);
    const double doubt = is_by_triangles(model.part, e) ? 1.1 * deflection : kTouchTolerance * size;
    undecided |= distance >= kKernelZero && distance < doubt;
    // Nothing that the kernel finds farther than a tessellated entity may be off has a place in the set.
    if (std::ranges::find(set, e) != set.end()) {
      EXPECT_LE(distance, 2 * deflection) << "entity " << e;
    }
  }
  for (const EntityNumber e : passing) undecided |= is_by_triangles(model.part, e);
  if (std::ranges::equal(set, passing)) {
    ++compared.equal;
  } else if (undecided) {
    ++compared.undecided;
  } else if (passing.empty()) {
    ++compared.stand_ins;  // only triangles pass; the sets' faces were found near above
  } else {
    ADD_FAILURE() << "voxel " << cell.transpose() << " holds "
                  << ::testing::PrintToString(std::vector(set.begin(), set.end())) << " but the kernel finds "
                  << ::testing::PrintToString(passing);
  }
}

class Association : public ::testing::TestWithParam<Case> {
 protected:
  static void compare_with_kernel(const Case& c) {
    const test::KernelPart model = c.part();
    VoxelBody body = voxelize(c.name, model.part.mesh, {.voxel_size = c.voxel_size});
    const AssociationReport report = associate(c.name, model.part, {}, body);
    EXPECT_EQ(report.loose_faces, 0U);
    EXPECT_EQ(report.without, 0U);
    std::vector<Eigen::Vector3i> plain, mixed;  // voxels of one face, of several entities
    for (std::uint32_t i = 0; i < body.voxmap.surface_count; ++i) {
      const Vector3d p =
          Vector3f(body.shell.x[i], body.shell.y[i], body.shell.z[i]).cast<double>() + body.shell.reference;
      (body.features.sets[body.shell.features[i]].size() == 1 ? plain : mixed).push_back(body.voxmap.cell_of(p));
    }
    const std::size_t wanted = test::by_length<std::size_t>(8, 25, 2000);
    Compared compared;
    test::Inputs inputs(7);
    for (const std::vector<Eigen::Vector3i>* cells : {&plain, &mixed}) {
      for (std::size_t i = 0; i < wanted && !cells->empty(); ++i) {
        const auto at = static_cast<std::size_t>(inputs.between(0, static_cast<double>(cells->size())));
        compare(model, body, (*cells)[at], compared);
      }
    }
    std::cout << c.name << ": " << body.voxmap.surface_count << " voxels, " << body.features.sets.size() - 1
              << " sets, " << report.stand_ins << " stand-ins; kernel asked for " << compared.distances
              << " distances: " << compared.equal << " voxels equal, " << compared.undecided << " undecided, "
              << compared.stand_ins << " stand-ins\n";
    // Where surfaces touch a box within rounding, and where triangles bulge into a voxel that no surface enters.
    const std::size_t voxels = compared.equal + compared.undecided + compared.stand_ins;
    EXPECT_LE(compared.undecided, voxels / 1000);
    EXPECT_LE(compared.stand_ins, voxels / 100);
  }
};

TEST_P(Association, HoldsWhatTheKernelFindsInTheVoxel) {
  compare_with_kernel(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Solids, Association, ::testing::ValuesIn(kSolids),
                         [](const auto& tested) { return std::string(tested.param.name); });

class AssociationOfFile : public Association {};

TEST_P(AssociationOfFile, HoldsWhatTheKernelFindsInTheVoxel) {
  if (!testing::models_are_here()) GTEST_SKIP() << "the shared models are not here: " << testing::model_path("");
  compare_with_kernel(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, AssociationOfFile, ::testing::ValuesIn(kFiles),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace verisim::association_kernel_test

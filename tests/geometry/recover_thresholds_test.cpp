// How much what is recovered hangs on the heuristic numbers of recover.hpp: each is halved and doubled, alone, and the
// parts that recover_test knows are recovered again, with tessellations fine and coarse.
#include <cmath>

#include "engine/geometry/recover.hpp"
#include "tests/geometry/models.hpp"
#include "tests/geometry/recovered.hpp"

namespace verisim::recover_thresholds_test {
namespace {

using testing::make;
using testing::placed;
using Kind = Solid::Kind;
using Counts = std::map<std::string, int>;

struct Known {
  const char* name;
  Part part;  ///< triangles alone
  Counts faces;
};

/// The dissertation's block and pin, a cone, a ball, a ring and a cut pin; the block also coarse.
const std::vector<Known>& known_parts() {
  static const std::vector<Known> all = [] {
    const Solid block =
        make(Kind::difference, make(Kind::box, {0.375, 0.375, 0.2}), make(Kind::cylinder, {0.075, 0.3}));
    const Solid cut = make(Kind::difference, make(Kind::cylinder, {0.02, 0.08}),
                           placed(make(Kind::box, {0.2, 0.2, 0.04}), {0, 0, 0.045},
                                  Quaterniond(Eigen::AngleAxisd(0.4, Vector3d::UnitX()))));
    const auto bare = [](const Solid& solid, const LoadOptions& load = {.angular_deflection = 0.25}) {
      return testing::bare(load_solid(solid, load));
    };
    Part ring;
    ring.mesh = testing::ring_mesh(0.05, 0.01, 36, 16);
    return std::vector<Known>{
        {"block", bare(block), {{"plane", 6}, {"cylinder", 1}}},
        {"coarse block",
         bare(block, {.deflection = 0.005, .angular_deflection = 0.5}),
         {{"plane", 6}, {"cylinder", 1}}},
        {"pin", bare(make(Kind::cylinder, {0.07, 0.4})), {{"plane", 2}, {"cylinder", 1}}},
        {"cone", bare(make(Kind::cone, {0.02, 0.05, 0.06})), {{"plane", 2}, {"cone", 1}}},
        {"ball", bare(make(Kind::sphere, {0.03})), {{"sphere", 1}}},
        {"cut pin", bare(cut), {{"plane", 2}, {"cylinder", 1}}},
        {"ring", testing::bare(ring), {{"torus", 1}}},
    };
  }();
  return all;
}

struct Number {
  const char* name;
  double RecoverThresholds::*member;
};
class RecoverThreshold : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(HalfAndDouble, RecoverThreshold,
                         ::testing::Values(Number{"longer_step", &RecoverThresholds::longer_step},
                                           Number{"tight_fit", &RecoverThresholds::tight_fit},
                                           Number{"sagitta_min", &RecoverThresholds::sagitta_min},
                                           Number{"equal_step", &RecoverThresholds::equal_step},
                                           Number{"nearly_tangent", &RecoverThresholds::nearly_tangent},
                                           Number{"parameter_area_min", &RecoverThresholds::parameter_area_min},
                                           Number{"sharp_edge_slack", &RecoverThresholds::sharp_edge_slack},
                                           Number{"larger_by", &RecoverThresholds::larger_by},
                                           Number{"narrower", &RecoverThresholds::narrower},
                                           Number{"mostly_sharp", &RecoverThresholds::mostly_sharp},
                                           Number{"mostly_smooth", &RecoverThresholds::mostly_smooth}),
                         [](const auto& number) { return std::string(number.param.name); });

/// Half or double; of numbers just above 1 what they are above it; a share is squared, or its root is taken.
double scaled(double usual, double factor) {
  if (usual > 1 && usual < 2) return 1 + factor * (usual - 1);
  if (usual >= 0.5 && usual < 1) return factor < 1 ? usual * usual : std::sqrt(usual);
  return factor * usual;
}

TEST_P(RecoverThreshold, LeavesTheSameFacesFoundIfHalvedOrDoubled) {
  for (const double factor : {0.5, 2.0}) {
    RecoverOptions options;
    double& number = options.thresholds.*GetParam().member;
    number = scaled(number, factor);
    SCOPED_TRACE(number);
    for (const Known& known : known_parts()) {
      Part part = known.part;
      recover_brep(part, options);
      EXPECT_EQ(testing::face_counts(part), known.faces) << known.name;
    }
  }
}

// The tolerance is what decides: given as double or half of single precision's own, the same is found.
TEST(RecoverTolerance, MayBeHalfOrTwiceOfWhatIsUsual) {
  for (const Known& known : known_parts()) {
    SCOPED_TRACE(known.name);
    const double usual = 3e-7 * bounds_of(known.part.mesh).size().norm();
    for (const double factor : {0.5, 2.0}) {
      Part part = known.part;
      recover_brep(part, {.tolerance = factor * usual});
      EXPECT_EQ(testing::face_counts(part), known.faces) << factor;
    }
  }
}

// 31.5 degrees. Facets of the coarse block's hole meet at 15 degrees: half of it is enough, a quarter takes them for
// edges.
TEST(RecoverStep, DecidesWhatARoundSurfaceMayBeMadeOf) {
  const auto round_faces = [](const Part& bare, double factor) {
    RecoverOptions options;
    options.round_step_max *= factor;
    Part part = bare;
    recover_brep(part, options);
    return testing::face_counts(part)["cylinder"];
  };
  const Part& fine = known_parts()[0].part;
  const Part& coarse = known_parts()[1].part;
  EXPECT_EQ(round_faces(fine, 0.5), 1);
  EXPECT_EQ(round_faces(fine, 2), 1);
  EXPECT_EQ(round_faces(coarse, 0.5), 1);
  EXPECT_EQ(round_faces(coarse, 0.25), 0);
  EXPECT_EQ(round_faces(coarse, 2), 1);
}

}  // namespace
}  // namespace verisim::recover_thresholds_test

// How much what is recovered hangs on the heuristic numbers of recover.hpp: each is halved and doubled, alone, and the
// parts that recover_test knows are recovered again, with tessellations fine and coarse.
#include <cmath>

#include "engine/geometry/recover.hpp"
#include "tests/geometry/models.hpp"
#include "tests/geometry/recovered.hpp"
#include "tests/length.hpp"

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

/// The dissertation's block and pin, a cone, a ball, a ring, a cut pin and a free form; the block also coarse.
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
    Part slab;
    slab.mesh = testing::wavy_slab();
    Part ring;
    ring.mesh = testing::ring_mesh(0.05, 0.01, 36, 16);
    std::vector<Known> parts{
        {"block", bare(block), {{"plane", 6}, {"cylinder", 1}}},
        {"coarse block",
         bare(block, {.deflection = 0.005, .angular_deflection = 0.5}),
         {{"plane", 6}, {"cylinder", 1}}},
        {"pin", bare(make(Kind::cylinder, {0.07, 0.4})), {{"plane", 2}, {"cylinder", 1}}},
        {"cone", bare(make(Kind::cone, {0.02, 0.05, 0.06})), {{"plane", 2}, {"cone", 1}}},
        {"ball", bare(make(Kind::sphere, {0.03})), {{"sphere", 1}}},
        {"cut pin", bare(cut), {{"plane", 2}, {"cylinder", 1}}},
        {"ring", testing::bare(ring), {{"torus", 1}}},
        {"wavy slab", testing::bare(slab), {{"plane", 1}, {"other", 1}}},
    };
    if (test::kSanitized) parts.erase(parts.begin() + 2, parts.end());
    return parts;
  }();
  return all;
}

/// Half or double; of numbers just above 1 what they are above it; a share is squared, or its root is taken.
double scaled(double usual, double factor) {
  if (usual > 1 && usual < 2) return 1 + factor * (usual - 1);
  if (usual >= 0.5 && usual < 1) return factor < 1 ? usual * usual : std::sqrt(usual);
  return factor * usual;
}
std::size_t scaled(std::size_t usual, double factor) {
  return static_cast<std::size_t>(std::ceil(factor * static_cast<double>(usual)));
}

struct Number {
  const char* name;
  void (*scale)(RecoverThresholds&, double factor);
};
template <auto kMember>
void scale(RecoverThresholds& thresholds, double factor) {
  thresholds.*kMember = scaled(thresholds.*kMember, factor);
}
template <auto kMember>
void scale_all(RecoverThresholds& thresholds, double factor) {
  for (std::size_t& n : thresholds.*kMember) n = scaled(n, factor);
}
using T = RecoverThresholds;
const Number kNumbers[] = {
    {"longer_step", scale<&T::longer_step>},
    {"tight_fit", scale<&T::tight_fit>},
    {"sagitta_min", scale<&T::sagitta_min>},
    {"equal_step", scale<&T::equal_step>},
    {"nearly_tangent", scale<&T::nearly_tangent>},
    {"parameter_area_min", scale<&T::parameter_area_min>},
    {"sharp_edge_slack", scale<&T::sharp_edge_slack>},
    {"larger_by", scale<&T::larger_by>},
    {"narrower", scale<&T::narrower>},
    {"mostly_sharp", scale<&T::mostly_sharp>},
    {"mostly_smooth", scale<&T::mostly_smooth>},
    {"description_gain", scale<&T::description_gain>},
    {"same_normal", scale<&T::same_normal>},
    {"sliver", scale<&T::sliver>},
    {"noise", scale<&T::noise>},
    {"fillet_span", scale<&T::fillet_span>},
    {"side_parallel", scale<&T::side_parallel>},
    {"strip_steps", scale<&T::strip_steps>},
    {"retry_steps", scale<&T::retry_steps>},
    {"failed_steps", scale<&T::failed_steps>},
    {"few_facets", scale<&T::few_facets>},
    {"points_of_a_fit", scale<&T::points_of_a_fit>},
    {"near_fit", scale<&T::near_fit>},
    {"fine_fit", scale<&T::fine_fit>},
    {"fast", scale<&T::fast>},
    {"settled", scale<&T::settled>},
    {"narrowest_cone", scale<&T::narrowest_cone>},
    {"widest_cone", scale<&T::widest_cone>},
    {"largest_radius", scale<&T::largest_radius>},
    {"patch_triangles_max", scale<&T::patch_triangles_max>},
    {"cluster_min", scale<&T::cluster_min>},
    {"triangles_each_max", scale<&T::triangles_each_max>},
    {"curve_slack", scale<&T::curve_slack>},
    {"not_parallel", scale<&T::not_parallel>},
    {"section_cosine_min", scale<&T::section_cosine_min>},
    {"ring_sizes", scale_all<&T::ring_sizes>},
    // What is no number of its own: one place or one point more or fewer, not twice as many.
    {"places_min", [](T& t, double factor) { t.places_min += factor < 1 ? -1 : 1; }},
    {"points_min",
     [](T& t, double factor) {
       for (std::size_t& n : t.points_min) n += factor < 1 ? -1 : 1;
     }},
};
class RecoverThreshold : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(HalfAndDouble, RecoverThreshold, ::testing::ValuesIn(kNumbers),
                         [](const auto& number) { return std::string(number.param.name); });

Counts edge_counts(const Part& part) {
  Counts counts;
  for (const Edge& edge : part.edges) ++counts[kCurveNames[edge.curve.index()]];
  return counts;
}

TEST_P(RecoverThreshold, LeavesTheSameFacesAndEdgesFoundIfHalvedOrDoubled) {
  static const std::vector<Counts> usual_edges = [] {
    std::vector<Counts> edges;
    for (const Known& known : known_parts()) {
      Part part = known.part;
      recover_brep(part);
      edges.push_back(edge_counts(part));
    }
    return edges;
  }();
  for (const double factor : {0.5, 2.0}) {
    SCOPED_TRACE(factor);
    RecoverOptions options;
    GetParam().scale(options.thresholds, factor);
    for (std::size_t i = 0; i < known_parts().size(); ++i) {
      const Known& known = known_parts()[i];
      Part part = known.part;
      recover_brep(part, options);
      // The one that speaks: of a free form more is taken for planes if little of their border has to be sharp.
      const bool finds_more_planes = GetParam().name == std::string("mostly_sharp") && factor < 1;
      if (finds_more_planes && known.faces.contains("other")) {
        EXPECT_EQ(testing::face_counts(part), (Counts{{"plane", 3}, {"other", 1}})) << known.name;
        continue;
      }
      EXPECT_EQ(testing::face_counts(part), known.faces) << known.name;
      EXPECT_EQ(edge_counts(part), usual_edges[i]) << known.name;
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

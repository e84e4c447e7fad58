// Whether a point of a surface is within a face is answered twice: by exact::Trim's raster, for contacts, and by
// FaceTrim's crossings, for voxels (engine/exact/trim.hpp says why). Here both are asked the same points, and the
// face's own triangles judge between them.
//
// Wherever the raster says inside or outside, all three must agree. What it calls border is not compared: there it
// names edges instead of deciding.
#include <gtest/gtest.h>

#include <iostream>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/voxel/prepared_faces.hpp"
#include "tests/exact/peg.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/geometry/models.hpp"
#include "tests/length.hpp"
#include "tests/support/paths.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::exact::test::trim_agreement_test {
namespace {

using Kind = Solid::Kind;

/// What came of the points of one part.
struct Tally {
  std::size_t inside = 0, outside = 0, border = 0;    ///< as the raster says
  std::size_t disagreements = 0;                      ///< of FaceTrim with the raster where that is not on the border
  std::size_t raster_wrong = 0, crossings_wrong = 0;  ///< by the triangles, where the raster is not on the border
  std::size_t no_answers = 0;                         ///< of FaceTrim, likewise
  std::size_t by_triangles = 0;  ///< faces that have an equation, but of which FaceTrim knows no point
  std::string first;             ///< where the first of them was

  [[nodiscard]] std::size_t decided() const { return inside + outside; }
  void add(const Tally& other) {
    inside += other.inside, outside += other.outside, border += other.border;
    disagreements += other.disagreements, raster_wrong += other.raster_wrong, crossings_wrong += other.crossings_wrong;
    no_answers += other.no_answers, by_triangles += other.by_triangles;
    if (first.empty()) first = other.first;
  }
};

std::ostream& operator<<(std::ostream& out, const Tally& t) {
  const auto all = static_cast<double>(std::max<std::size_t>(t.decided() + t.border, 1));
  return out << t.inside << " inside, " << t.outside << " outside, border "
             << std::round(1000 * static_cast<double>(t.border) / all) / 10 << " %; " << t.disagreements
             << " disagreements, " << t.no_answers << " without an answer, wrong by the triangles: raster "
             << t.raster_wrong << ", crossings " << t.crossings_wrong << "; " << t.by_triangles
             << " faces without crossings";
}

/// The point (u, v) of a surface by entity.hpp; nothing where the surface has passed its axis.
std::optional<Vector3d> point_of(const Surface& surface, const AnalyticSurface& s, double u, double v) {
  const Vector3d ring = pinned::cos(u) * s.x_axis() + pinned::sin(u) * s.y_axis();
  const auto turned = [&](double rho, double h) -> std::optional<Vector3d> {
    if (!(rho > 0)) return std::nullopt;
    return s.point() + rho * ring + h * s.axis();
  };
  const Meridian& m = s.meridian();
  switch (s.kind()) {
    case SurfaceKind::plane:
      return s.point() + u * std::get<Plane>(surface).x_axis +
             v * std::get<Plane>(surface).normal.cross(std::get<Plane>(surface).x_axis);
    case SurfaceKind::cylinder:
      return turned(m.radius, v);
    case SurfaceKind::cone:
      return turned(m.radius + v * m.tangent, v);
    case SurfaceKind::sphere:
    case SurfaceKind::torus:
      break;
  }
  return turned(m.ring + m.radius * pinned::cos(v), m.radius * pinned::sin(v));
}

/// Does the line through p along the surface's normal meet one of the face's triangles near p?
bool is_over_triangles(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const AnalyticSurface& s,
                       const Vector3d& p) {
  const Vector3d n = s.at(p).normal;
  // Far enough for the widest facets, nearer than the other side.
  const double bend = s.curvature_bound(p, 0);
  const double far = bend > 0 ? 0.5 / bend : 1e-6;
  return std::ranges::any_of(triangles, [&](std::uint32_t t) {
    const auto& v = mesh.triangles[t];
    const Vector3d a = mesh.vertices[v[0]] - p, b = mesh.vertices[v[1]] - p, c = mesh.vertices[v[2]] - p;
    const double weights[] = {n.dot(b.cross(c)), n.dot(c.cross(a)), n.dot(a.cross(b))};
    const double sum = weights[0] + weights[1] + weights[2];
    if (sum == 0) return false;
    for (const double w : weights)
      if (w / sum < -1e-9) return false;
    return std::abs((weights[0] * a + weights[1] * b + weights[2] * c).dot(n) / sum) <= far;
  });
}

/// Points of every face with an equation, drawn over its own stretch of the chart and a tenth beyond it.
Tally compare(const Part& part, const BodyOptions& options, int points_per_face, std::uint64_t seed) {
  const double spacing = options.spacing;
  const ExactBody body(std::span(&part, 1), options);
  Voxmap map;
  map.voxel_size = spacing;
  map.origin = bounds_of(part.mesh).min - Vector3d::Constant(8 * spacing);
  const GridMesh grid_mesh = in_grid_coordinates(part.mesh, map);
  const std::vector<PreparedFace> prepared = prepare_faces(part, grid_mesh, map);
  std::vector<std::vector<std::uint32_t>> triangles(part.faces.size());
  for (std::uint32_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const std::uint32_t face = part.mesh.face_of_triangle[t];
    if (face != kNoFace) triangles[face].push_back(t);
  }
  Draw draw(seed);
  Tally tally;
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const Face& face = part.faces[f];
    if (!body.faces[f].trim) continue;
    const AnalyticSurface& surface = *body.faces[f].surface;
    if (prepared[f].trim == nullptr) ++tally.by_triangles;
    for (int i = 0; i < points_per_face; ++i) {
      const auto drawn = [&](const std::array<double, 2>& range) {
        return range[0] + (range[1] - range[0]) * draw.between(-0.1, 1.1);
      };
      const double u = drawn(face.u_range);
      double v = drawn(face.v_range);
      if (surface.kind() == SurfaceKind::sphere) v = std::clamp(v, -0.5 * pinned::kPi, 0.5 * pinned::kPi);
      const std::optional<Vector3d> p = point_of(face.surface, surface, u, v);
      if (!p) continue;
      const Trim::Where where = body.faces[f].trim->find(surface, *p).where;
      if (where == Trim::Where::border) {
        ++tally.border;
        continue;
      }
      const bool inside = where == Trim::Where::inside;
      ++(inside ? tally.inside : tally.outside);
      const bool truth = is_over_triangles(part.mesh, triangles[f], surface, *p);
      std::optional<bool> crossings = truth;
      if (prepared[f].trim != nullptr) {
        const GridSurface& grid = *prepared[f].surface;
        crossings = prepared[f].trim->contains(grid.to_local((*p - map.origin) / map.voxel_size));
      }
      tally.no_answers += crossings ? 0 : 1;
      tally.disagreements += crossings.value_or(inside) != inside ? 1 : 0;
      tally.raster_wrong += inside != truth ? 1 : 0;
      tally.crossings_wrong += crossings.value_or(truth) != truth ? 1 : 0;
      if (tally.first.empty() && (crossings != std::optional(inside) || inside != truth)) {
        tally.first = fmt::format("{} face {} ({}) at u = {}, v = {}: raster {}, crossings {}, triangles {}", part.name,
                                  f, kSurfaceNames[face.surface.index()], u, v, inside,
                                  crossings ? (*crossings ? "true" : "false") : "none", truth);
      }
    }
  }
  return tally;
}

/// At three sizes of cells: coarse as voxels of small scenes are, usual, and as fine as the raster gets.
Tally compare_at_all_sizes(const Part& part, int points_per_face, BodyOptions options = {}) {
  Tally tally;
  const double extent = bounds_of(part.mesh).size().norm();
  std::uint64_t seed = 1;
  for (const double cells : {20.0, 60.0, 200.0}) {
    options.spacing = extent / cells;
    tally.add(compare(part, options, points_per_face, seed++));
  }
  return tally;
}

void expect_agreement(const std::string& name, const Tally& tally) {
  std::cout << name << ": " << tally << "\n";
  ::testing::Test::RecordProperty(
      "border_permille",
      static_cast<int>(1000 * static_cast<double>(tally.border) / static_cast<double>(tally.decided() + tally.border)));
  EXPECT_EQ(tally.disagreements, 0U) << tally.first;
  EXPECT_EQ(tally.no_answers, 0U) << tally.first;
  EXPECT_EQ(tally.raster_wrong, 0U) << tally.first;
  EXPECT_EQ(tally.crossings_wrong, 0U) << tally.first;
}

struct Shape {
  const char* name;
  Part (*make)();
};

Part solid(const Solid& s) {
  return load_solid(s, {});
}
Solid moved(const Solid& s, const Vector3d& by, const Quaterniond& turn = Quaterniond::Identity()) {
  return placed(s, {by, turn});
}
Quaterniond turned_about_x(double angle) {
  return rotation_from_vector({angle, 0, 0});
}
Solid minus(const Solid& a, const Solid& b) {
  return combine(Kind::difference, a, b);
}

const Shape kShapes[] = {
    {"block", [] { return solid(block_solid()); }},
    {"chamferedBlock", [] { return solid(block_solid(0.01)); }},
    {"pin", [] { return solid(pin_solid(1e-4)); }},
    {"holesAndSlot",  // round holes, one of them near the border, and a groove across
     [] {
       Solid s = make(Kind::box, {0.2, 0.12, 0.02});
       for (const double x : {-0.07, -0.01, 0.05})
         s = minus(s, moved(make(Kind::cylinder, {0.012, 0.05}), {x, 0.03, 0}));
       s = minus(s, moved(make(Kind::cylinder, {0.008, 0.05}), {0.09, -0.05, 0}));
       s = minus(s, moved(make(Kind::box, {0.3, 0.01, 0.01}), {0, -0.02, 0.008}));
       return solid(
           minus(s, moved(make(Kind::cylinder, {0.004, 0.3}), {0, 0.01, 0.01}, turned_about_x(0.5 * pinned::kPi))));
     }},
    {"grooveAlongAShaft",  // a keyway, and a groove around it
     [] {
       const Solid shaft =
           minus(make(Kind::cylinder, {0.02, 0.1}), moved(make(Kind::box, {0.008, 0.02, 0.04}), {0, 0.02, 0.03}));
       return solid(minus(shaft, moved(make(Kind::tube, {0.03, 0.017, 0.01}), {0, 0, -0.02})));
     }},
    {"slantedCut",  // an ellipse
     [] {
       return solid(minus(make(Kind::cylinder, {0.02, 0.08}),
                          moved(make(Kind::box, {0.2, 0.2, 0.04}), {0, 0, 0.045}, turned_about_x(0.4))));
     }},
    {"crossDrilled",  // curves without an equation
     [] {
       return solid(minus(make(Kind::cylinder, {0.03, 0.1}),
                          moved(make(Kind::cylinder, {0.012, 0.1}), {0, 0, 0.01}, turned_about_x(0.5 * pinned::kPi))));
     }},
    {"frustum",
     [] {
       return solid(make(Kind::cone, {0.02, 0.05, 0.06}));
     }},
    {"apex",
     [] {
       return solid(make(Kind::cone, {0.03, 0, 0.06}));
     }},
    {"countersink",
     [] {
       const Solid plate = minus(make(Kind::box, {0.06, 0.06, 0.02}), make(Kind::cylinder, {0.006, 0.05}));
       return solid(minus(plate, moved(make(Kind::cone, {0.006, 0.016, 0.01}), {0, 0, 0.0051})));
     }},
    {"notchedCone",
     [] {
       return solid(
           minus(make(Kind::cone, {0.04, 0.02, 0.06}), moved(make(Kind::box, {0.02, 0.1, 0.02}), {0, 0, 0.005})));
     }},
    {"ball", [] { return solid(make(Kind::sphere, {0.03})); }},
    {"drilledBall",
     [] {
       return solid(minus(make(Kind::sphere, {0.03}), make(Kind::cylinder, {0.01, 0.1})));
     }},
    {"quarterOfABall",
     [] {
       return solid(combine(Kind::intersection, make(Kind::sphere, {0.03}),
                            moved(make(Kind::box, {0.1, 0.1, 0.1}), {0.05, 0.05, 0.0})));
     }},
    {"tube",
     [] {
       return solid(make(Kind::tube, {0.03, 0.02, 0.05}));
     }},
    {"window",
     [] {
       return solid(
           minus(make(Kind::tube, {0.03, 0.02, 0.05}), moved(make(Kind::box, {0.1, 0.015, 0.02}), {0.05, 0, 0})));
     }},
    {"pinThroughPlate",
     [] {
       return solid(combine(Kind::sum, make(Kind::box, {0.1, 0.1, 0.01}), make(Kind::cylinder, {0.02, 0.06})));
     }},
};

// Borders hide what is near them; the rest of the chart must still be most of it, or nothing was compared.
class TrimAgreement : public ::testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Solids, TrimAgreement, ::testing::ValuesIn(kShapes),
                         [](const auto& shape) { return std::string(shape.param.name); });

TEST_P(TrimAgreement, RasterAndCrossingsAnswerAlikeAwayFromBorders) {
  const Tally tally = compare_at_all_sizes(GetParam().make(), 200);
  EXPECT_GT(3 * tally.decided(), tally.border);
  EXPECT_GT(tally.inside, 0U);
  EXPECT_EQ(tally.by_triangles, 0U);
  expect_agreement(GetParam().name, tally);
}

Part recovered(TriangleMesh mesh) {
  Part part;
  part.name = "recovered";
  part.mesh = std::move(mesh);
  recover_brep(part);
  return part;
}
/// A piece of a circle in the half plane, `from` to `to` [rad].
void add_arc(std::vector<std::array<double, 2>>& profile, double rho, double z, double radius, double from, double to) {
  for (int i = 0; i <= 12; ++i) {
    const double angle = from + (to - from) * i / 12;
    profile.push_back({rho + radius * pinned::cos(angle), z + radius * pinned::sin(angle)});
  }
}
template <typename SurfaceOf>
bool has(const Part& part) {
  return std::ranges::any_of(part.faces, [](const Face& f) { return std::holds_alternative<SurfaceOf>(f.surface); });
}

// No solid has a torus: a hoop, and a bearing's inner ring with the groove of its balls, from their triangles.
TEST(TrimAgreementOfTori, RasterAndCrossingsAnswerAlikeAwayFromBorders) {
  std::vector<std::array<double, 2>> hoop;
  add_arc(hoop, 0.05, 0, 0.01, 0, 2 * pinned::kPi * 23 / 24);
  std::vector<std::array<double, 2>> ring = {{0.02, -0.01}, {0.03, -0.01}};
  add_arc(ring, 0.032, 0, 0.006, -1.9106, -4.3726);
  ring.push_back({0.03, 0.01});
  ring.push_back({0.02, 0.01});
  for (const auto& profile : {hoop, ring}) {
    for (const int facets : {12, 48}) {
      const Part part = recovered(shapes::turned(profile, facets));
      EXPECT_TRUE(has<Torus>(part)) << facets;
      const Tally tally = compare_at_all_sizes(part, 400);
      EXPECT_GT(tally.inside, 500U);
      EXPECT_TRUE(facets == 12 || tally.by_triangles == 0) << "of wide facets the finest voxels ask the triangles";
      expect_agreement(fmt::format("torus of {} facets", facets), tally);
    }
  }
}

// The pole of a recovered ball is where its fit has put it: no corner of a triangle is there, nor need one be near.
TEST(TrimAgreementOfRecoveredBalls, RasterAndCrossingsAnswerAlikeUpToThePoles) {
  for (const double step : verisim::test::some_of({0.1, 0.45})) {
    for (const double size : {0.003, 0.03}) {
      const LoadOptions load{.deflection = size, .angular_deflection = step};
      const Solid cut = minus(make(Kind::sphere, {size}),
                              moved(make(Kind::box, {4 * size, 4 * size, size}), {0, 0, size}, turned_about_x(0.7)));
      for (const Solid& shape : {make(Kind::sphere, {size}), cut}) {
        Part drawn = load_solid(moved(shape, {0.01, 0.02, 0.03}, turned_about_x(1)), load);
        drawn.mesh.face_of_triangle.clear();
        const Part part = recovered(drawn.mesh);
        EXPECT_TRUE(has<Sphere>(part)) << step;
        expect_agreement(fmt::format("ball in steps of {} rad", step), compare_at_all_sizes(part, 400));
      }
    }
  }
}

// How fine the raster is says how much of a chart is border, never which side of it a place is on.
TEST(TrimAgreementThresholds, ChangeOnlyTheShareOfBorders) {
  const Solid cut = minus(make(Kind::sphere, {0.03}), moved(make(Kind::cylinder, {0.01, 0.1}), {0.012, 0, 0}));
  const Part parts[] = {solid(cut),
                        solid(minus(make(Kind::cone, {0.04, 0.02, 0.06}), make(Kind::box, {0.02, 0.1, 0.02})))};
  struct Varied {
    const char* name;
    BodyOptions options;
  };
  const BodyOptions usual;
  const Varied all[] = {{"usual", {}},
                        {"cells_max halved", {.cells_max = usual.cells_max / 2}},
                        {"cells_max doubled", {.cells_max = usual.cells_max * 2}},
                        {"near_pole halved", {.near_pole = usual.near_pole / 2}},
                        {"near_pole, twice as near", {.near_pole = 1 - (1 - usual.near_pole) / 2}}};
  std::map<std::string, std::size_t> border;
  for (const Varied& varied : all) {
    Tally tally;
    for (const Part& part : parts)
      tally.add(compare_at_all_sizes(part, verisim::test::by_length(60, 300, 300), varied.options));
    expect_agreement(varied.name, tally);
    border[varied.name] = tally.border;
  }
  EXPECT_GT(border["cells_max halved"], border["usual"]);
  EXPECT_LT(border["cells_max doubled"], border["usual"]);
  EXPECT_GE(border["near_pole halved"], border["usual"]);
  EXPECT_LE(border["near_pole, twice as near"], border["usual"]);
}

TEST(TrimAgreementOfModels, RasterAndCrossingsAnswerAlikeOnTheShippedOnes) {
  for (const char* file :
       verisim::test::some_of({"bearing.step", "peg_in_hole.step", "shaft_loose.step", "shaft_m6.step"})) {
    Tally tally;
    for (const Part& part : testing::load(paths::in_sources("scenarios/models/") + file))
      tally.add(compare_at_all_sizes(part, verisim::test::by_length(30, 100, 100)));
    EXPECT_GT(tally.inside, 0U);
    EXPECT_EQ(tally.by_triangles, 0U);
    expect_agreement(file, tally);
  }
}

// Drawn by others: fillets, torus grooves, seams in odd places.
TEST(TrimAgreementOfModels, RasterAndCrossingsAnswerAlikeOnTheSharedOnes) {
  if (!testing::models_are_here())
    GTEST_SKIP() << "the shared models are not here, so the two trims were not compared on them: "
                 << testing::model_path("");
  for (const char* file : verisim::test::some_of(
           {"freecad_cc0/axis.stp", "freecad_cc0/bearing_20x37x9.stp", "freecad_cc0/engine_bushing.stp",
            "freecad_cc0/engine_conrod.stp", "freecad_cc0/engine_piston.stp", "occt/mal_vis.stp", "occt/screw.step"})) {
    Tally tally;
    for (const Part& part : testing::load(testing::model_path(file))) tally.add(compare_at_all_sizes(part, 40));
    EXPECT_GT(tally.inside, 0U);
    expect_agreement(file, tally);
  }
}

}  // namespace
}  // namespace verisim::exact::test::trim_agreement_test

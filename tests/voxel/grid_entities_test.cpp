// Surfaces, curves and bounds against boxes: closed forms against dense points, for entities and boxes at random.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/voxel/trim.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::grid_entities_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct Axes {
  explicit Axes(test::Inputs& inputs) : point(inputs.vector(3)) {
    const Matrix3d m = inputs.rotation().toRotationMatrix();
    x = m.col(0), z = m.col(2);
  }
  Vector3d point, x, z;
};

Face face_on(const Surface& surface, double v_low = 0, double v_high = 0) {
  Face face;
  face.surface = surface;
  face.v_range = {v_low, v_high};
  return face;
}

/// One surface of each kind, some hardly larger than a box, some tori that meet themselves.
Face random_face(test::Inputs& inputs, int kind) {
  const Axes f(inputs);
  const double r = inputs.between(0.2, 4);
  switch (kind) {
    case 0:
      return face_on(Plane{f.point, f.z, f.x});
    case 1:
      return face_on(Cylinder{f.point, f.z, f.x, r, false});
    case 2:
      return face_on(Cone{f.point, f.z, f.x, inputs.between(0, 2), inputs.between(0.05, 1.5), false});
    case 3:
      return face_on(Sphere{f.point, f.z, f.x, r, false});
    case 4:
      return face_on(Torus{f.point, f.z, f.x, 2 + r, inputs.between(0.2, 1.9), false});
    case 5:
      return face_on(Torus{f.point, f.z, f.x, 1, 3, false}, -0.1, 0.1);
    default:
      return face_on(Torus{f.point, f.z, f.x, 1, 3, false}, 3, 3.2);
  }
}

/// Is the function zero in the box? Asked at n^3 points: a sign change is proof; without one, nearly all values stay
/// away from zero by less than a step's length only where the answer is a matter of that length.
struct Dense {
  bool changes_sign = false;
  double nearest = 1e9;
};

Dense ask_densely(const GridSurface& surface, const GridBox& box, int n) {
  Dense dense;
  bool below = false, above = false;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3d unit(i % n, i / n % n, i / (n * n));
    const Vector3d p = box.center + box.half * (2.0 / (n - 1) * unit - Vector3d::Ones());
    const double value = surface.value(surface.to_local(p));
    below |= value <= 0;
    above |= value >= 0;
    dense.nearest = std::min(dense.nearest, std::abs(value));
  }
  dense.changes_sign = below && above;
  return dense;
}

TEST(GridSurface, TouchesABoxExactlyWhereItsFunctionVanishesInIt) {
  constexpr int kPoints = 13;
  test::Inputs inputs(11);
  int touched = 0, apart = 0;
  for (int i = 0; i < 4200; ++i) {
    const GridSurface surface = *GridSurface::from(random_face(inputs, i % 7), Vector3d::Zero(), 1);
    const GridBox box{inputs.vector(4), 0.5};
    const Dense dense = ask_densely(surface, box, kPoints);
    const bool touches = surface.touches(box);
    if (dense.changes_sign) {
      ASSERT_TRUE(touches) << "case " << i;
    } else if (touches) {
      ASSERT_LT(dense.nearest, std::sqrt(3.0) / 2 * 2 * box.half / (kPoints - 1)) << "case " << i;
    }
    ++(touches ? touched : apart);
  }
  EXPECT_GT(touched, 400);
  EXPECT_GT(apart, 400);
}

TEST(GridSurface, FindsASurfaceThatReachesIntoTheBoxByAMillionth) {
  const Vector3d center(0.5, 0.5, 0.5);
  for (const double inside : {1e-6, -1e-6}) {
    const auto touches = [&](const Face& face) {
      return GridSurface::from(face, Vector3d::Zero(), 1)->touches({center, 0.5});
    };
    const double reach = 3 + inside;  // from x = -3 to the wall x = 0
    const Vector3d middle(-3, 0.5, 0.5), z = Vector3d::UnitZ(), x = Vector3d::UnitX();
    EXPECT_EQ(touches(face_on(Sphere{middle, z, x, reach, false})), inside > 0);
    EXPECT_EQ(touches(face_on(Cylinder{middle, z, x, reach, false})), inside > 0);
    EXPECT_EQ(touches(face_on(Torus{middle, z, x, 2, reach - 2, false})), inside > 0);
    EXPECT_EQ(touches(face_on(Plane{{inside, 0, 0}, -x, z})), inside > 0);
    const double slope = std::tan(0.3);
    EXPECT_EQ(touches(face_on(Cone{{-3, 0.5, 0}, z, x, reach - slope, 0.3, false})), inside > 0) << "at the box's top";
  }
}

TEST(GridSurface, GivesPointsOfItselfInTheBoxWheneverItTouches) {
  test::Inputs inputs(12);
  for (int i = 0; i < 4200; ++i) {
    const GridSurface surface = *GridSurface::from(random_face(inputs, i % 7), Vector3d::Zero(), 1);
    const GridBox box{inputs.vector(4), 0.5};
    std::vector<Vector3d> probes;
    surface.add_probes(box, probes);
    const bool touches = surface.touches(box);
    ASSERT_EQ(probes.empty(), !touches) << "case " << i;
    for (const Vector3d& probe : probes) {
      EXPECT_LT(std::abs(surface.value(probe)), 1e-6) << "case " << i;
      const Vector3d p = surface.origin() + surface.axes().transpose() * probe;
      EXPECT_LT((p - box.center).cwiseAbs().maxCoeff(), box.half + 1e-6);
    }
  }
}

// Coordinates of the grid, whatever its scale: where the surface was, the grid's surface is.
TEST(GridSurface, IsTheSurfaceOfItsFaceScaledAndMoved) {
  test::Inputs inputs(14);
  for (int i = 0; i < 700; ++i) {
    const Face face = random_face(inputs, i % 7);
    const Vector3d origin = inputs.vector(5), p = inputs.vector(4);
    const double scale = inputs.between(0.1, 300);
    const AnalyticSurface surface = *AnalyticSurface::from(face);
    const GridSurface grid = *GridSurface::from(face, origin, scale);
    const Vector3d there = scale * (p - origin);
    EXPECT_NEAR(grid.value(grid.to_local(there)), scale * surface.at(p).distance, 1e-9 * scale) << "case " << i;
    EXPECT_LT((grid.foot(there) - scale * (surface.foot(p) - origin)).norm(), 1e-6 * scale) << "case " << i;
    EXPECT_LT((grid.to_grid(grid.to_local(there)) - there).norm(), 1e-9 * scale) << "case " << i;
  }
}

TEST(GridSurface, IsNothingForAFaceWithoutEquation) {
  const Vector3d z = Vector3d::UnitZ(), x = Vector3d::UnitX();
  for (const Surface& broken :
       {Surface(Sphere{{0, 0, 0}, z, x, 0, false}), Surface(Cylinder{{0, 0, 0}, z, x, -1, false}),
        Surface(Sphere{{0, NAN, 0}, z, x, 1, false}), Surface(Cone{{0, 0, 0}, z, x, 1, 0, false}),
        Surface(OtherSurface{})}) {
    EXPECT_FALSE(GridSurface::from(face_on(broken), Vector3d::Zero(), 1));
  }
}

Edge edge_on(const Curve& curve, double from, double to) {
  Edge edge;
  edge.curve = curve;
  edge.t_range = {from, to};
  return edge;
}

Edge random_edge(test::Inputs& inputs, int kind) {
  const Axes f(inputs);
  const double from = inputs.between(-3, 3), span = inputs.between(0.01, kTurn);
  if (kind == 0) return edge_on(Line{f.point, f.z}, from, from + span);
  if (kind == 1) return edge_on(Circle{f.point, f.z, f.x, inputs.between(0.1, 4)}, from, from + span);
  return edge_on(Ellipse{f.point, f.z, f.x, inputs.between(2, 4), inputs.between(0.1, 2)}, from, from + span);
}

Vector3d point_at(const Edge& edge, double t) {
  if (const auto* line = std::get_if<Line>(&edge.curve)) return line->point + t * line->direction;
  if (const auto* c = std::get_if<Circle>(&edge.curve)) {
    return c->center + c->radius * (std::cos(t) * c->x_axis + std::sin(t) * c->normal.cross(c->x_axis));
  }
  const auto& e = std::get<Ellipse>(edge.curve);
  return e.center + e.major_radius * std::cos(t) * e.x_axis + e.minor_radius * std::sin(t) * e.normal.cross(e.x_axis);
}

GridCurve placed(const Edge& edge) {
  return {edge, Matrix3d::Identity(), Vector3d::Zero(), 1};
}

TEST(GridCurve, PassesThroughABoxExactlyIfOneOfItsPointsIsInIt) {
  constexpr int kPoints = 4000;
  test::Inputs inputs(13);
  int passed = 0;
  for (int i = 0; i < 3000; ++i) {
    const Edge edge = random_edge(inputs, i % 3);
    const GridBox box{inputs.vector(3), 0.5};
    double nearest = 1e9;
    for (int k = 0; k <= kPoints; ++k) {
      const double t = edge.t_range[0] + (edge.t_range[1] - edge.t_range[0]) * k / kPoints;
      nearest = std::min(nearest, (point_at(edge, t) - box.center).cwiseAbs().maxCoeff());
    }
    const bool passes = placed(edge).passes(box);
    passed += passes ? 1 : 0;
    if (nearest < box.half || nearest > box.half + 0.01) {
      EXPECT_EQ(passes, nearest < box.half) << "case " << i;
    }
  }
  EXPECT_GT(passed, 50);
}

TEST(GridCurve, OfLengthOrRadiusZeroIsAPoint) {
  const Vector3d p(0.2, 0.3, 0.4), z = Vector3d::UnitZ(), x = Vector3d::UnitX();
  Edge polyline;
  polyline.curve = OtherCurve{};
  polyline.polyline = {p};
  for (const Edge& edge : {edge_on(Line{p, z}, 0, 0), edge_on(Circle{p, z, x, 0}, 0, kTurn), polyline}) {
    EXPECT_TRUE(placed(edge).passes({{0, 0, 0}, 0.5}));
    EXPECT_FALSE(placed(edge).passes({{1, 0, 0}, 0.5}));
  }
  Edge nothing;
  nothing.curve = OtherCurve{};
  EXPECT_FALSE(placed(nothing).passes({{10, 10, 10}, 0.5}));
}

/// A square with a round hole and a square one, on a plane; point by point against the definition.
TEST(FaceTrim, KnowsAPlateWithHoles) {
  const GridSurface plane =
      *GridSurface::from(face_on(Plane{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX()}), Vector3d::Zero(), 1);
  std::vector<GridCurve> bounds;
  const auto add_square = [&](double cx, double cy, double half) {
    const Vector3d c(cx, cy, 0), x = Vector3d::UnitX(), y = Vector3d::UnitY();
    for (const double side : {-half, half}) {
      bounds.push_back(placed(edge_on(Line{c + side * y, x}, -half, half)));
      bounds.push_back(placed(edge_on(Line{c + side * x, y}, -half, half)));
    }
  };
  add_square(0, 0, 10);
  add_square(5, 5, 2);
  bounds.push_back(placed(edge_on(Circle{{-4, 1, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), 3}, 0, kTurn)));
  const FaceTrim trim(plane, bounds, {{0, -7.3, 0}, {8.4, -1, 0}, {-8, 8, 0}}, 1e-8);
  ASSERT_FALSE(trim.is_loose());
  for (int i = 0; i < 81 * 81; ++i) {
    const Vector3d p(0.3 * (i % 81) - 12, 0.3 * (i / 81) - 12, 0);
    const double in_square = std::max(std::abs(p.x() - 5), std::abs(p.y() - 5)) - 2;
    const double in_circle = std::hypot(p.x() + 4, p.y() - 1) - 3;
    const double in_plate = 10 - std::max(std::abs(p.x()), std::abs(p.y()));
    const double margin = std::min({in_square, in_circle, in_plate});
    if (std::abs(margin) < 1e-6) continue;
    EXPECT_EQ(trim.contains(p), std::optional<bool>(margin > 0)) << p.transpose();
  }
}

/// A window cut out of a cylinder, from angle 1 to 2 and height -1 to 3: the wall is the rest between -5 and 5.
TEST(FaceTrim, KnowsATubeWithAWindow) {
  const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
  const GridSurface tube = *GridSurface::from(face_on(Cylinder{{0, 0, 0}, z, x, 4, false}), Vector3d::Zero(), 1);
  const auto at = [](double u, double v) { return Vector3d(4 * std::cos(u), 4 * std::sin(u), v); };
  std::vector<GridCurve> bounds;
  for (const double v : {-5.0, 5.0}) bounds.push_back(placed(edge_on(Circle{{0, 0, v}, z, x, 4}, 0, kTurn)));
  for (const double v : {-1.0, 3.0}) bounds.push_back(placed(edge_on(Circle{{0, 0, v}, z, x, 4}, 1, 2)));
  for (const double u : {1.0, 2.0}) bounds.push_back(placed(edge_on(Line{at(u, 0), z}, -1, 3)));
  const FaceTrim trim(tube, bounds, {at(4.1, 0.7), at(0.3, -4), at(1.5, 4.2)}, 1e-8);
  ASSERT_FALSE(trim.is_loose());
  for (int i = 0; i < 60 * 61; ++i) {
    const double u = 0.1 + kTurn * (i % 60) / 60, v = 0.2 * (i / 60) - 6;
    if (std::abs(std::abs(v) - 5) < 1e-6 || std::abs(v + 1) < 1e-6 || std::abs(v - 3) < 1e-6) continue;
    const bool in_window = u > 1 && u < 2 && v > -1 && v < 3;
    EXPECT_EQ(trim.contains(at(u, v)), std::optional<bool>(std::abs(v) < 5 && !in_window)) << u << " " << v;
  }
}

TEST(FaceTrim, IsLooseIfItsKnownPointsContradictItsBounds) {
  const GridSurface plane =
      *GridSurface::from(face_on(Plane{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX()}), Vector3d::Zero(), 1);
  const std::vector<GridCurve> bounds = {
      placed(edge_on(Circle{{0, 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX(), 3}, 0, kTurn))};
  EXPECT_FALSE(FaceTrim(plane, bounds, {{1, 0.2, 0}, {-1, 1, 0}}, 1e-8).is_loose());
  EXPECT_TRUE(FaceTrim(plane, bounds, {{1, 0.2, 0}, {-5, 1, 0}}, 1e-8).is_loose());
  EXPECT_TRUE(FaceTrim(plane, bounds, {}, 1e-8).is_loose());
}

}  // namespace
}  // namespace verisim::grid_entities_test

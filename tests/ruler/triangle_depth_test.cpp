// The ruler against CGAL: the same solids as triangles, random placements, and points spread densely over one of them.
// CGAL says of each point whether it is inside the other and how far from its surface.
#include "engine/ruler/triangle_depth.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <memory>

#include "engine/geometry/loader.hpp"
#include "engine/ruler/solid_depth.hpp"
#include "tests/length.hpp"
#include "tests/ruler/drop_scenes.hpp"
#include "tests/ruler/shapes.hpp"

namespace verisim::triangle_depth_test {
namespace {

using drops::operator+;
using drops::operator-;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

std::shared_ptr<const Solid> primitive(Solid::Kind kind, std::vector<double> sizes) {
  return std::make_shared<Solid>(Solid{.kind = kind, .sizes = std::move(sizes), .children = {}, .placement = {}});
}

struct Judge {
  explicit Judge(const TriangleMesh& triangles) {
    std::vector<Mesh::Vertex_index> index;
    for (const Vector3d& p : triangles.vertices) index.push_back(mesh.add_vertex({p.x(), p.y(), p.z()}));
    for (const auto& [a, b, c] : triangles.triangles) mesh.add_face(index[a], index[b], index[c]);
    tree.insert(faces(mesh).first, faces(mesh).second, mesh);
    tree.build();
    tree.accelerate_distance_queries();
    inside = std::make_unique<CGAL::Side_of_triangle_mesh<Mesh, Kernel>>(mesh);
  }
  double depth(const Vector3d& x) const {
    const Kernel::Point_3 p(x.x(), x.y(), x.z());
    return (*inside)(p) == CGAL::ON_BOUNDED_SIDE ? std::sqrt(tree.squared_distance(p)) : 0;
  }
  Mesh mesh;
  Tree tree;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<Mesh, Kernel>> inside;
};

/// The deepest of points no more than `spacing` apart on a's triangles.
double densely(const TriangleMesh& a, const Pose& X_BA, const Judge& b, double spacing) {
  double deepest = 0;
  for (const auto& [i, j, k] : a.triangles) {
    const Vector3d p = X_BA * a.vertices[i], u = X_BA * a.vertices[j] - p, v = X_BA * a.vertices[k] - p;
    const int n = 1 + static_cast<int>(std::max({u.norm(), v.norm(), (u - v).norm()}) / spacing);
    for (int s = 0; s <= n; ++s)
      for (int t = 0; s + t <= n; ++t) deepest = std::max(deepest, b.depth(p + (u * s + v * t) / n));
  }
  return deepest;
}

// A point of a triangle is at most `spacing` from a sampled one, and depths change by at most 1 m per m. The solids'
// surfaces are off from their triangles by the height of an arc over its chord, which is measured at the triangles'
// middles.
TEST(TriangleDepth, AndSolidDepthAgreeWithDenselySampledTriangles) {
  const std::vector<std::shared_ptr<const Solid>> solids = {
      primitive(Solid::Kind::box, {0.02, 0.03, 0.01}), primitive(Solid::Kind::cylinder, {0.01, 0.03}),
      primitive(Solid::Kind::sphere, {0.012}), primitive(Solid::Kind::cone, {0.004, 0.012, 0.02}),
      primitive(Solid::Kind::tube, {0.015, 0.01, 0.02}), primitive(Solid::Kind::torus, {0.011, 0.004}),
      // Holes as deep as their blocks are high, primitives that touch or cross, round ones and prisms.
      drops::box(0.03, 0.03, 0.012) - drops::cylinder(0.008, 0.012),
      drops::box(0.03, 0.03, 0.012) - drops::prism(6, 0.008, 0.02),
      drops::cylinder(0.008, 0.02) + drops::moved(drops::box(0.006, 0.004, 0.02), {0.008, 0, 0}),
      drops::box(0.03, 0.03, 0.012) - drops::moved(drops::torus(0.009, 0.004), {0, 0, 0.006}),
      drops::box(0.03, 0.03, 0.015) - drops::moved(drops::cone(0.002, 0.012, 0.015), {0, 0, 0.005})};
  std::vector<Part> parts;
  std::vector<std::unique_ptr<Judge>> judges;
  for (const auto& solid : solids) {
    parts.push_back(load_solid(*solid, {}));
    judges.push_back(std::make_unique<Judge>(parts.back().mesh));
  }
  constexpr double kSpacing = 5e-4, kChord = 4e-4;
  const ruler::Accuracy accuracy{.absolute = 1e-5, .relative = 0.01, .pieces_max = 4000};
  const RandomStream random(1, "against CGAL");
  std::uint64_t deep = 0;
  const auto count = std::uint64_t{test::is_long() ? 484U : 44U};
  for (std::uint64_t i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const std::size_t a = i % solids.size(), b = (i / solids.size() + 2 * i) % solids.size();
    const Pose X_BA = ruler::test::random_pose(random, 100 * i, 0.015);
    const double sampled = densely(parts[a].mesh, X_BA, *judges[b], kSpacing);
    const ruler::Triangles first(parts[a].mesh.vertices, parts[a].mesh.triangles);
    const ruler::Triangles second(parts[b].mesh.vertices, parts[b].mesh.triangles);
    const ruler::Depth triangles = ruler::depth_in(first, X_BA, second, accuracy);
    EXPECT_LE(triangles.depth, sampled + kSpacing);
    EXPECT_GE(triangles.depth + triangles.bound, sampled - 1e-12);
    const ruler::Depth exact =
        ruler::depth_in(ruler::Csg(solids[a]->text()).placed(X_BA), ruler::Csg(solids[b]->text()), accuracy);
    EXPECT_LE(exact.depth, sampled + kSpacing + kChord);
    EXPECT_GE(exact.depth + exact.bound, sampled - kChord);
    deep += sampled > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(deep, 3 * count / 10) << "hardly any of the placements overlapped";
}

}  // namespace
}  // namespace verisim::triangle_depth_test

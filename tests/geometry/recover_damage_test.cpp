// Recovery of meshes that are damaged, open, tangled or random: it ends, gives every triangle a face, and does not
// depend on the order of triangles.
#include <gtest/gtest.h>

#include "engine/geometry/recover.hpp"
#include "tests/geometry/models.hpp"
#include "tests/geometry/parametrization.hpp"
#include "tests/geometry/recovered.hpp"
#include "tests/length.hpp"
#include "tests/support/meshes.hpp"

namespace verisim::recover_damage_test {
namespace {

class Damage {
 public:
  explicit Damage(std::uint64_t seed) : random_(seed, "damage") {}

  /// Some of the defects that files have, drawn by the seed.
  void to(TriangleMesh& mesh) {
    for (int i = 0; i < 12; ++i) {
      const std::uint32_t t = below(mesh.triangles.size()), v = below(mesh.vertices.size());
      switch (below(6)) {
        case 0:  // a triangle without area, on two vertices
          mesh.triangles.push_back({mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][1]});
          break;
        case 1:  // the same triangle again, turned over
          mesh.triangles.push_back({mesh.triangles[t][0], mesh.triangles[t][2], mesh.triangles[t][1]});
          break;
        case 2:  // one along an edge that has two
          mesh.triangles.push_back({mesh.triangles[t][0], mesh.triangles[t][1], v});
          break;
        case 3:  // a hole
          mesh.triangles[t] = mesh.triangles.back();
          mesh.triangles.pop_back();
          break;
        case 4:  // a vertex in two copies
          mesh.vertices.push_back(mesh.vertices[mesh.triangles[t][0]]);
          mesh.triangles[t][0] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
          break;
        default:  // a vertex beside its place
          mesh.vertices[v] += Vector3d(offset(), offset(), offset());
      }
    }
  }

  /// Triangles on random vertices: no surface at all.
  TriangleMesh soup() {
    TriangleMesh mesh;
    for (int i = 0; i < 30; ++i) mesh.vertices.emplace_back(20 * offset(), 20 * offset(), 20 * offset());
    for (int i = 0; i < 80; ++i) mesh.triangles.push_back({below(30), below(30), below(30)});
    return mesh;
  }

 private:
  std::uint32_t below(std::size_t n) {
    return static_cast<std::uint32_t>(random_.uniform(drawn_++) * static_cast<double>(n));
  }
  double offset() { return 0.001 * (random_.uniform(drawn_++) - 0.5); }

  RandomStream random_;
  std::uint64_t drawn_ = 0;
};

/// Every triangle with three different corners has a face, and its vertices are on it.
void expect_faces_everywhere(const Part& part, double tolerance) {
  ASSERT_EQ(part.mesh.face_of_triangle.size(), part.mesh.triangles.size());
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = part.mesh.triangles[t];
    const std::vector<Vector3d>& p = part.mesh.vertices;
    const std::uint32_t number = part.mesh.face_of_triangle[t];
    if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) {
      EXPECT_EQ(number, kNoFace);
      continue;
    }
    ASSERT_LT(number, part.faces.size());
    const double slack = std::holds_alternative<Torus>(part.faces[number].surface) ? 30 : 1;
    for (const std::uint32_t v : part.mesh.triangles[t]) {
      const auto on = testing::project(part.faces[number].surface, p[v]);
      if (on) {
        EXPECT_LE(std::abs(on->distance), slack * tolerance) << kSurfaceNames[part.faces[number].surface.index()];
      }
    }
  }
}

void expect_the_same_in_any_order(const TriangleMesh& mesh, std::uint64_t seed) {
  constexpr double kTolerance = 1e-8;
  Part part, other;
  part.mesh = mesh;
  other.mesh = testing::shuffled(mesh, seed);
  recover_brep(part, {.tolerance = kTolerance});
  recover_brep(other, {.tolerance = kTolerance});
  EXPECT_EQ(testing::bytes_of(part), testing::bytes_of(other));
  expect_faces_everywhere(part, kTolerance);
}

TEST(RecoverDamaged, GivesEveryTriangleAFaceInAnyOrder) {
  TriangleMesh bulky = testing::box_mesh({0, 0, 0}, {0.03, 0.02, 0.01});
  for (int i = 0; i < 3; ++i) bulky = test::subdivide(bulky);
  const TriangleMesh ring = testing::ring_mesh(0.02, 0.006, 32, 20);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Damage damage(seed);
    for (TriangleMesh mesh : {bulky, ring}) {
      damage.to(mesh);
      expect_the_same_in_any_order(mesh, seed);
    }
    expect_the_same_in_any_order(damage.soup(), seed);
  }
}

TEST(RecoverDamaged, LosesNoMoreOfARingThanTheDamagedFacets) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Part part;
    part.mesh = testing::ring_mesh(0.02, 0.006, 48, 32);
    const double whole = area_of(part.mesh);
    Damage(seed).to(part.mesh);
    recover_brep(part, {.tolerance = 1e-8});
    double ring = 0;
    for (const Face& face : part.faces) {
      if (const auto* torus = std::get_if<Torus>(&face.surface)) {
        EXPECT_NEAR(torus->minor_radius, 0.006, 1e-8);
        ring += face.area;
      }
    }
    EXPECT_GT(ring, 0.9 * whole);
  }
}

/// A sheet z = f(x, y) over a square of 0.1 m.
template <typename Height>
TriangleMesh sheet(std::uint32_t side, Height height) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= side; ++i) {
    for (std::uint32_t j = 0; j <= side; ++j) {
      const double x = 0.1 * i / side - 0.05, y = 0.1 * j / side - 0.05;
      mesh.vertices.emplace_back(x, y, height(x, y));
      if (i == side || j == side) continue;
      const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
    }
  }
  return mesh;
}

// A saddle, a paraboloid, an egg tray, a saddle of third degree: none has a plane, cylinder, cone, sphere or torus in
// it.
TEST(RecoverDamaged, CallsFreeFormsOther) {
  const std::vector<TriangleMesh> forms = test::some_of({
      sheet(20, [](double x, double y) { return 6 * (x * x - y * y); }),
      sheet(20, [](double x, double y) { return 5 * x * x + 3 * y * y; }),
      sheet(20, [](double x, double y) { return 0.004 * std::sin(70 * x) * std::cos(60 * y); }),
      sheet(20, [](double x, double y) { return 40 * (x * x * x - 3 * x * y * y); }),
  });
  for (std::size_t i = 0; i < forms.size(); ++i) {
    Part part;
    part.mesh = forms[i];
    recover_brep(part);
    double other = 0;
    for (const Face& face : part.faces) {
      if (std::holds_alternative<OtherSurface>(face.surface)) other += face.area;
    }
    EXPECT_GT(other, 0.99 * area_of(part.mesh)) << "form " << i << ": " << part.notes.at(0);
  }
}

}  // namespace
}  // namespace verisim::recover_damage_test

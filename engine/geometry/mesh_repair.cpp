// repair(): each step changes one thing and notes it. All steps keep face_of_triangle consistent with the triangles.
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/mesh.hpp"
#include "engine/geometry/mesh_edges.hpp"
#include "engine/geometry/mesh_joints.hpp"

namespace verisim {
namespace {

struct HashPoint {
  std::size_t operator()(const std::array<double, 3>& p) const { return hash_bytes(p.data(), sizeof p, 0); }
};

std::string counted(std::size_t n, const char* what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

/// Merges equal vertices and drops vertices without a triangle. New numbers follow first use.
void weld(TriangleMesh& mesh) {
  std::vector<Vector3d> vertices;
  std::unordered_map<std::array<double, 3>, std::uint32_t, HashPoint> known;  // looked up only, never walked
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      const Vector3d p = mesh.vertices[corner] + Vector3d::Zero();  // -0 + 0 = +0: they are equal, their bits are not
      const auto [entry, is_new] =
          known.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(vertices.size()));
      if (is_new) vertices.push_back(p);
      corner = entry->second;
    }
  }
  mesh.vertices = std::move(vertices);
}

std::size_t drop_triangles(TriangleMesh& mesh, const std::vector<bool>& drop) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (drop[t]) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    if (!mesh.face_of_triangle.empty()) mesh.face_of_triangle[kept] = mesh.face_of_triangle[t];
    ++kept;
  }
  const std::size_t dropped = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  if (!mesh.face_of_triangle.empty()) mesh.face_of_triangle.resize(kept);
  return dropped;
}

std::size_t drop_repeated_corners(TriangleMesh& mesh) {
  std::vector<bool> drop(mesh.triangles.size());
  for (std::size_t t = 0; t < drop.size(); ++t) {
    const auto [i, j, k] = mesh.triangles[t];
    drop[t] = i == j || j == k || k == i;
  }
  return drop_triangles(mesh, drop);
}

/// Keeps the first of several triangles on the same three corners.
std::size_t drop_duplicates(TriangleMesh& mesh) {
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> sorted;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    sorted.emplace_back(mesh.triangles[t], t);
    std::sort(sorted.back().first.begin(), sorted.back().first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> drop(mesh.triangles.size());
  for (std::size_t i = 1; i < sorted.size(); ++i) drop[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  return drop_triangles(mesh, drop);
}

/// Drops flat triangles that join no neighbours: an edge of theirs is open or has more than two triangles. Another flat
/// triangle must stay, because without it the mesh would be open along its long side.
std::size_t drop_flat_triangles(TriangleMesh& mesh) {
  std::vector<bool> flat(mesh.triangles.size());
  for (std::size_t t = 0; t < flat.size(); ++t) flat[t] = is_degenerate(mesh, mesh.triangles[t]);
  std::vector<bool> drop(mesh.triangles.size());
  const std::vector<Side> sides = sorted_sides(mesh);
  for_each_edge(sides, [&](std::span<const Side> edge) {
    if (edge.size() == 2) return;
    for (const Side& side : edge) drop[side.triangle] = drop[side.triangle] || flat[side.triangle];
  });
  return drop_triangles(mesh, drop);
}

void flip(TriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
}

struct Neighbour {
  std::uint32_t triangle;
  bool same_way;  ///< both run the same way along the common edge: one of them has the wrong orientation
};

std::vector<std::vector<Neighbour>> neighbours_of(const TriangleMesh& mesh) {
  std::vector<std::vector<Neighbour>> neighbours(mesh.triangles.size());
  const std::vector<Side> sides = sorted_sides(mesh);
  for_each_edge(sides, [&](std::span<const Side> edge) {
    if (edge.size() != 2) return;
    const bool same_way = edge[0].forward == edge[1].forward;
    neighbours[edge[0].triangle].push_back({edge[1].triangle, same_way});
    neighbours[edge[1].triangle].push_back({edge[0].triangle, same_way});
  });
  return neighbours;
}

/// Makes neighbours across manifold edges run consistently; in each component the minority is turned.
std::size_t orient_consistently(TriangleMesh& mesh) {
  const std::vector<std::vector<Neighbour>> neighbours = neighbours_of(mesh);
  std::vector<bool> visited(mesh.triangles.size());
  std::vector<bool> against_first(mesh.triangles.size());
  std::size_t turned = 0;
  for (std::uint32_t first = 0; first < mesh.triangles.size(); ++first) {
    if (visited[first]) continue;
    visited[first] = true;
    std::vector<std::uint32_t> component = {first};
    for (std::size_t i = 0; i < component.size(); ++i) {
      const std::uint32_t t = component[i];
      for (const Neighbour& next : neighbours[t]) {
        if (visited[next.triangle]) continue;
        visited[next.triangle] = true;
        against_first[next.triangle] = against_first[t] != next.same_way;
        component.push_back(next.triangle);
      }
    }
    const auto against = static_cast<std::size_t>(
        std::count_if(component.begin(), component.end(), [&](std::uint32_t t) { return against_first[t]; }));
    const bool first_is_wrong = 2 * against > component.size();
    for (const std::uint32_t t : component) {
      if (against_first[t] != first_is_wrong) flip(mesh, t);
    }
    turned += first_is_wrong ? component.size() - against : against;
  }
  return turned;
}

/// One closed component: a shell around material or around a void.
struct Shell {
  TriangleMesh mesh;                     ///< its triangles alone, each with its own corners
  std::vector<std::uint32_t> triangles;  ///< their numbers in the whole mesh
  Bounds bounds;
  double volume = 0;
};

std::vector<Shell> shells_of(const TriangleMesh& mesh) {
  const Components components = components_of(mesh, sorted_sides(mesh), false);
  std::vector<Shell> shells(components.count);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Shell& shell = shells[components.of_triangle[t]];
    const auto first = static_cast<std::uint32_t>(shell.mesh.vertices.size());
    for (const std::uint32_t corner : mesh.triangles[t]) shell.mesh.vertices.push_back(mesh.vertices[corner]);
    shell.mesh.triangles.push_back({first, first + 1, first + 2});
    shell.triangles.push_back(t);
  }
  for (Shell& shell : shells) {
    shell.bounds = bounds_of(shell.mesh);
    shell.volume = mass_properties_of(shell.mesh).volume;
  }
  return shells;
}

/// How often the shell winds around p: ±1 inside, 0 outside (van Oosterom and Strackee 1983).
double winding_number(const TriangleMesh& shell, const Vector3d& p) {
  double angle = 0;
  for (const auto& [i, j, k] : shell.triangles) {
    const Vector3d a = shell.vertices[i] - p;
    const Vector3d b = shell.vertices[j] - p;
    const Vector3d c = shell.vertices[k] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2 * pinned::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * pinned::kPi);
}

/// True if `outer` surrounds `inner`, tested with eight corners spread over `inner`. Shells that overlap have some
/// outside and are not nested.
bool surrounds(const Shell& outer, const Shell& inner) {
  if ((outer.bounds.min.array() > inner.bounds.min.array()).any()) return false;
  if ((outer.bounds.max.array() < inner.bounds.max.array()).any()) return false;
  const std::size_t n = inner.mesh.triangles.size();
  const std::size_t step = std::max<std::size_t>(1, n / 8);
  for (std::size_t t = 0; t < n; t += step) {
    const Vector3d& corner = inner.mesh.vertices[inner.mesh.triangles[t][0]];
    if (std::abs(winding_number(outer.mesh, corner)) < 0.5) return false;
  }
  return true;
}

/// Shells at even depth bound material, those at odd depth a void. Returns how many shells were turned round.
std::size_t orient_outward(TriangleMesh& mesh) {
  const std::vector<Shell> shells = shells_of(mesh);
  std::size_t turned = 0;
  for (const Shell& shell : shells) {
    const auto depth = std::count_if(shells.begin(), shells.end(),
                                     [&](const Shell& other) { return &other != &shell && surrounds(other, shell); });
    const bool is_void = depth % 2 == 1;
    if (shell.volume == 0 || (shell.volume < 0) == is_void) continue;
    for (const std::uint32_t t : shell.triangles) flip(mesh, t);
    ++turned;
  }
  return turned;
}

struct Dropped {
  std::size_t repeated = 0, duplicate = 0, flat = 0;
};

void drop_useless_triangles(TriangleMesh& mesh, Dropped& dropped) {
  dropped.repeated += drop_repeated_corners(mesh);
  dropped.duplicate += drop_duplicates(mesh);
  dropped.flat += drop_flat_triangles(mesh);
}

void note_dropped(const Dropped& dropped, std::vector<std::string>& notes) {
  if (dropped.repeated > 0) notes.push_back(counted(dropped.repeated, "triangle") + " with two equal corners dropped");
  if (dropped.duplicate > 0) notes.push_back(counted(dropped.duplicate, "duplicate triangle") + " dropped");
  if (dropped.flat > 0) notes.push_back(counted(dropped.flat, "triangle") + " of zero area dropped");
}

/// Wide enough for single precision on a part within ten diagonals of the origin, and far below any clearance that can
/// be simulated.
constexpr double kJointTolerance = 1e-6;  // of the mesh's diagonal

/// A side is cut once, a triangle once for each of its sides; further rounds are for corners that come within the
/// tolerance later.
constexpr unsigned kMaxRounds = 16;

/// Closes seams until nothing changes. Triangles and vertices that become useless are dropped without a note of their
/// own.
void close_joints(TriangleMesh& mesh, std::vector<std::string>& notes) {
  std::vector<Side> open = open_sides(mesh);
  const std::size_t before = open.size();
  const double tolerance = kJointTolerance * bounds_of(mesh).size().norm();
  std::size_t joined = 0;
  std::size_t cut = 0;
  Dropped dropped;
  for (unsigned round = 0; round < kMaxRounds && !open.empty(); ++round) {
    const std::size_t joined_now = join_near_corners(mesh, open, tolerance);
    // Joined corners have new numbers: sides must be found again before cutting.
    const std::size_t cut_now = joined_now > 0 ? 0 : cut_at_joints(mesh, open, tolerance);
    if (joined_now + cut_now == 0) break;
    joined += joined_now;
    cut += cut_now;
    drop_useless_triangles(mesh, dropped);
    open = open_sides(mesh);
  }
  if (joined + cut == 0) return;
  notes.push_back(
      fmt::format("{} closed within {:.2g} m (1e-6 of the diagonal), {} left: {} joined, {} cut at T-joints",
                  counted(before - std::min(before, open.size()), "open edge"), tolerance, open.size(),
                  counted(joined, "corner"), counted(cut, "triangle")));
}

}  // namespace

MeshReport repair(TriangleMesh& mesh, std::vector<std::string>& notes) {
  VERISIM_ASSERT(is_whole(mesh));
  MeshReport report = examine(mesh, false);
  if (report.not_finite) return report;  // nothing can be decided about such a mesh
  weld(mesh);
  Dropped dropped;
  drop_useless_triangles(mesh, dropped);
  note_dropped(dropped, notes);
  close_joints(mesh, notes);
  const std::size_t turned = orient_consistently(mesh);
  if (turned > 0) notes.push_back(counted(turned, "triangle") + " turned to run like their neighbours");
  report = examine(mesh, false);
  // Only a closed surface has an outside.
  if (report.open_edges == 0 && report.nonmanifold_edges == 0 && report.misoriented_edges == 0) {
    const std::size_t shells = orient_outward(mesh);
    if (shells > 0) notes.push_back(counted(shells, "shell") + " turned inside out, so that the material is inside");
    report.inside_out = !mesh.triangles.empty() && mass_properties_of(mesh).volume < 0;
  }
  weld(mesh);  // drops the vertices that no triangle uses any more
  return report;
}

}  // namespace verisim

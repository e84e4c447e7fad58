#include "engine/geometry/recover.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/region_edges.hpp"
#include "engine/geometry/recover/region_faces.hpp"
#include "engine/geometry/recover/region_search.hpp"

namespace verisim {

namespace {

/// Relative to the mesh's extent: rounding to single precision, to six digits, to five. Facts about files, no
/// heuristics: recover_thresholds_test halves and doubles the tolerance all the same.
constexpr std::array<double, 3> kUsualTolerances = {3e-7, 4e-6, 4.5e-5};

double extent_of(const TriangleMesh& mesh) {
  double farthest = bounds_of(mesh).size().norm();
  for (const Vector3d& p : mesh.vertices) farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
  return farthest;
}

/// Description length of a segmentation: one word per surface, and one per triangle on no surface.
std::size_t description_length(const std::vector<recover::Region>& regions) {
  std::size_t length = regions.size();
  for (const recover::Region& region : regions) {
    if (std::holds_alternative<OtherSurface>(region.surface)) length += region.triangles.size();
  }
  return length;
}

/// True if of the area that is not on planes most is on curved surfaces. With too small a tolerance it is not.
bool are_mostly_curved(const recover::CanonicalMesh& mesh, const std::vector<recover::Region>& regions) {
  double round = 0, other = 0;
  for (const recover::Region& region : regions) {
    if (std::holds_alternative<Plane>(region.surface)) continue;
    double& sum = std::holds_alternative<OtherSurface>(region.surface) ? other : round;
    for (const std::uint32_t t : region.triangles) sum += mesh.areas[t];
  }
  return round >= other;
}

std::vector<recover::Region> find_regions(const recover::CanonicalMesh& mesh, double tolerance,
                                          const RecoverOptions& options) {
  return recover::find_regions(mesh, tolerance, options.round_step_max, options.thresholds);
}

struct Segmentation {
  std::vector<recover::Region> regions;
  double tolerance = 0;
};

/// Segmentation with the smallest tolerance, unless a larger one makes the description shorter by description_gain. Too
/// small a tolerance breaks surfaces into pieces; too large a one finds surfaces where there are none. A larger one is
/// not tried if most of the area that is not flat is on surfaces: then the rest is a free form.
Segmentation best_segmentation(const recover::CanonicalMesh& mesh, double extent, const RecoverOptions& options) {
  Segmentation best;
  for (const double usual : kUsualTolerances) {
    Segmentation next{find_regions(mesh, usual * extent, options), usual * extent};
    if (best.tolerance == 0 ||
        options.thresholds.description_gain * static_cast<double>(description_length(next.regions)) <
            static_cast<double>(description_length(best.regions)))
      best = std::move(next);
    if (are_mostly_curved(mesh, best.regions)) break;
  }
  return best;
}

std::string note_on(const Part& part) {
  std::array<std::size_t, kSurfaceNames.size()> counts{};
  for (const Face& face : part.faces) ++counts[face.surface.index()];
  std::string found;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) found += fmt::format("{}{} {}", found.empty() ? "" : ", ", counts[i], kSurfaceNames[i]);
  }
  return fmt::format("faces recovered from its triangles: {}", found);
}

}  // namespace

void recover_brep(Part& part, const RecoverOptions& options) {
  VERISIM_ASSERT(!part.has_brep());
  VERISIM_ASSERT(is_whole(part.mesh));
  for (const Vector3d& v : part.mesh.vertices) VERISIM_ASSERT(is_finite(v));
  VERISIM_ASSERT(is_not_negative(options.tolerance));
  VERISIM_ASSERT(options.round_step_max > 0);
  VERISIM_ASSERT(options.round_step_max < pinned::kPi);
  if (part.mesh.triangles.empty()) return;
  const recover::CanonicalMesh mesh = recover::canonical(part.mesh);
  const double given = options.tolerance;
  const auto [regions, tolerance] = given > 0 ? Segmentation{find_regions(mesh, given, options), given}
                                              : best_segmentation(mesh, extent_of(part.mesh), options);
  std::vector<std::uint32_t> face_of(mesh.triangles.size(), kNoFace);
  for (std::uint32_t r = 0; r < regions.size(); ++r) {
    part.faces.push_back(recover::face_of(mesh, regions[r]));
    for (const std::uint32_t t : regions[r].triangles) face_of[t] = r;
  }
  part.edges = recover::edges_between(mesh, regions, tolerance, options.thresholds);
  for (std::uint32_t e = 0; e < part.edges.size(); ++e) {
    for (const std::uint32_t f : part.edges[e].faces) part.faces[f].edges.push_back(e);
  }
  part.mesh.face_of_triangle.clear();
  for (const std::uint32_t t : mesh.of_given)
    part.mesh.face_of_triangle.push_back(t == recover::kNone ? kNoFace : face_of[t]);
  part.notes.push_back(note_on(part));
}

}  // namespace verisim

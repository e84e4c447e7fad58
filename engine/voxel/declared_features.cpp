#include "engine/voxel/declared_features.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/analytic_surface.hpp"
#include "engine/geometry/entity_check.hpp"
#include "engine/geometry/entity_row.hpp"

namespace verisim {

namespace {

/// "plane", "circle" …, and what is wrong with it.
struct Doubt {
  const char* name;
  std::optional<std::string> fault;

  Doubt(const Face& face) : name(kSurfaceNames[face.surface.index()]), fault(fault_of(face.surface)) {
    if (std::holds_alternative<OtherSurface>(face.surface)) fault = "has no equation; declare a plane or a round one";
    const auto* torus = std::get_if<Torus>(&face.surface);
    if (!fault && torus != nullptr && torus->minor_radius > torus->major_radius) {
      fault = fmt::format("has a minor radius of {} m but it must not be above the major one, {} m",
                          torus->minor_radius, torus->major_radius);
    }
  }
  Doubt(const Edge& edge) : name(kCurveNames[edge.curve.index()]), fault(fault_of(edge.curve)) {
    if (std::holds_alternative<OtherCurve>(edge.curve)) fault = "has no equation; declare a line, circle or ellipse";
  }
};

/// A ball has no direction, whatever its entity says; which way an x axis points, and which side is a hole, is not
/// declared.
struct KeyOf {
  DeclaredFeatures::Key operator()(const Face& face) const {
    EntityRow row = row_of(face.surface);
    if (std::holds_alternative<Sphere>(face.surface)) std::fill_n(row.begin() + 3, 3, 0.0);
    return of(face.surface.index(), row);
  }
  DeclaredFeatures::Key operator()(const Edge& edge) const {
    return of(kSurfaceNames.size() + edge.curve.index(), row_of(edge.curve));
  }
  static DeclaredFeatures::Key of(std::size_t kind, const EntityRow& r) {
    return {static_cast<double>(kind), r[0], r[1], r[2], r[3], r[4], r[5], r[9], r[10]};
  }
};

void check(const std::string& owner, const DeclaredFeatures::Entity& entity) {
  const auto [name, fault] = std::visit([](const auto& e) { return Doubt(e); }, entity);
  if (fault) fail(ErrorKind::input, "'{}': a declared {} {}", owner, name, *fault);
}

}  // namespace

DeclaredFeatures::Place DeclaredFeatures::place_of(const std::string& owner, const Entity& entity) {
  check(owner, entity);
  const bool is_edge = std::holds_alternative<Edge>(entity);
  const auto next = static_cast<Place>(is_edge ? 2 * edges_.size() + 1 : 2 * faces_.size());
  const Key key = std::visit(KeyOf{}, entity);
  const auto [found, is_new] = places_.try_emplace(key, next);
  if (!is_new) return found->second;
  if (is_edge) {
    edges_.push_back(std::get<Edge>(entity));
  } else {
    faces_.push_back(std::get<Face>(entity));
    used_.push_back(false);
    outwardness_.push_back(0);
  }
  return next;
}

FeatureSetId DeclaredFeatures::add(const std::string& owner, std::span<const Entity> set) {
  std::vector<Place> places;
  for (const Entity& entity : set) places.push_back(place_of(owner, entity));
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  if (const std::optional<FeatureSetId> known = sets_.find(places)) return *known;
  if (size() == FeatureSets::kMostSets)
    fail(ErrorKind::input, "'{}': more than {} different sets are declared; use fewer", owner, FeatureSets::kMostSets);
  return sets_.intern(places);
}

/// Adds a voxel's inward normal to the evidence for a hole. Where faces meet, a voxel is weak or wrong evidence. On the
/// axis of a curved face it is none: every direction leads away from it.
void DeclaredFeatures::add_normal(std::size_t face, const Vector3d& p, const Vector3d& inward) {
  const AnalyticSurface surface = *AnalyticSurface::from(faces_[face].surface);
  if (!std::isfinite(surface.curvature_bound(p, 0))) return;
  const Vector3d away = surface.side() * surface.at(p).normal;
  outwardness_[face] += away.dot(inward);
  std::visit(
      [&](auto& s) {
        if constexpr (requires { s.hole; }) s.hole = outwardness_[face] > 0;
      },
      faces_[face].surface);
}

/// The circle in the set that lies on the cylinder, perpendicular to its axis; null if there is none.
const Circle* DeclaredFeatures::rim_of(const Cylinder& cylinder, std::span<const Place> set) const {
  constexpr double kSame = 1e-9;  // m and rad: what was declared by the same numbers
  for (const Place place : set) {
    if (place % 2 == 0) continue;
    const auto* circle = std::get_if<Circle>(&edges_[place / 2].curve);
    if (circle == nullptr || std::abs(circle->radius - cylinder.radius) > kSame) continue;
    if (circle->normal.cross(cylinder.direction).norm() > kSame) continue;
    if ((circle->center - cylinder.point).cross(cylinder.direction).norm() <= kSame) return circle;
  }
  return nullptr;
}

/// Extends the face's bounds to a voxel. Along an axis to all of the voxel, or to the rim if its set has one. Around an
/// axis the face is taken as closed.
void DeclaredFeatures::extend(std::size_t face, std::span<const Place> set, const Vector3d& p, double half_side) {
  Face& f = faces_[face];
  const auto include = [&](std::array<double, 2>& range, double low, double high) {
    range[0] = used_[face] ? std::min(range[0], low) : low;
    range[1] = used_[face] ? std::max(range[1], high) : high;
  };
  const auto widen = [&](std::array<double, 2>& range, double at) { include(range, at - half_side, at + half_side); };
  constexpr std::array<double, 2> kAround = {0, 2 * pinned::kPi};
  const AnalyticSurface surface = *AnalyticSurface::from(f.surface);
  const double u = surface.parameters(p)[0], v = surface.parameters(p)[1];
  std::visit(Overloaded{[&](const Plane&) {
                          widen(f.u_range, u);
                          widen(f.v_range, v);
                        },
                        [&](const Cylinder& s) {
                          f.u_range = kAround;
                          if (const Circle* rim = rim_of(s, set)) {
                            const double end = surface.parameters(rim->center)[1];
                            include(f.v_range, end, end);
                          } else {
                            widen(f.v_range, v);
                          }
                        },
                        [&](const Cone&) {
                          f.u_range = kAround;
                          widen(f.v_range, v);
                        },
                        [&](const Sphere&) {
                          f.u_range = kAround;
                          f.v_range = {-0.5 * pinned::kPi, 0.5 * pinned::kPi};
                        },
                        [&](const Torus&) { f.u_range = f.v_range = kAround; },
                        [](const OtherSurface&) { VERISIM_ASSERT(!"refused when it was added"); }},
             f.surface);
}

void DeclaredFeatures::assign(const VoxelBody& body, std::uint32_t voxel, FeatureSetId id) {
  VERISIM_ASSERT(voxel < body.voxmap.surface_count);
  VERISIM_ASSERT(id <= size());
  VERISIM_ASSERT(body.shell.size() == body.voxmap.surface_count);
  VERISIM_ASSERT(of_voxel_.empty() || of_voxel_.size() == body.voxmap.surface_count);
  if (of_voxel_.empty()) of_voxel_.assign(body.voxmap.surface_count, 0);
  of_voxel_[voxel] = id;
  if (id == 0) return;
  const Pointshell& shell = body.shell;
  const Vector3d p = shell.reference + Vector3d(shell.x[voxel], shell.y[voxel], shell.z[voxel]);
  const std::span<const Place> set = sets_[id];
  for (const Place place : set) {
    if (place % 2 != 0) continue;
    const std::size_t face = place / 2;
    add_normal(face, p, Vector3d(shell.nx[voxel], shell.ny[voxel], shell.nz[voxel]));
    extend(face, set, p, 0.5 * body.voxmap.voxel_size);
    used_[face] = true;
  }
}

std::vector<EntityNumber> DeclaredFeatures::numbered(FeatureSetId id, EntityNumber first_face,
                                                     EntityNumber first_edge) const {
  VERISIM_ASSERT(id <= size());
  VERISIM_ASSERT(first_face + faces_.size() <= first_edge);
  std::vector<EntityNumber> entities;
  for (const Place place : sets_[id]) {
    entities.push_back(place % 2 == 0 ? first_face + place / 2 : first_edge + place / 2);
  }
  std::ranges::sort(entities);
  return entities;
}

}  // namespace verisim

#include "engine/voxel/declared_features.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {

namespace {

constexpr double kUnitLength = 1e-9;  // a direction's length may differ from one by this

/// An entity in one form for all kinds.
struct Numbers {
  int kind = 0;
  Vector3d point = Vector3d::Zero(), direction = Vector3d::UnitZ();
  double first = 1, second = 1;  // lengths or angles that must be above zero
};

struct NumbersOf {
  Numbers operator()(const Plane& s) const { return {0, s.point, s.normal}; }
  Numbers operator()(const Cylinder& s) const { return {1, s.point, s.direction, s.radius}; }
  Numbers operator()(const Cone& s) const { return {2, s.point, s.direction, 1 + s.radius, s.half_angle}; }
  Numbers operator()(const Sphere& s) const { return {3, s.center, Vector3d::UnitZ(), s.radius}; }
  Numbers operator()(const Torus& s) const { return {4, s.center, s.direction, s.major_radius, s.minor_radius}; }
  Numbers operator()(const OtherSurface&) const { return {5}; }
  Numbers operator()(const Line& c) const { return {6, c.point, c.direction}; }
  Numbers operator()(const Circle& c) const { return {7, c.center, c.normal, c.radius}; }
  Numbers operator()(const Ellipse& c) const { return {8, c.center, c.normal, c.major_radius, c.minor_radius}; }
  Numbers operator()(const OtherCurve&) const { return {9}; }
};

Numbers numbers_of(const DeclaredFeatures::Entity& entity) {
  if (const auto* edge = std::get_if<Edge>(&entity)) return std::visit(NumbersOf{}, edge->curve);
  return std::visit(NumbersOf{}, std::get<Face>(entity).surface);
}

void check(const std::string& owner, const Numbers& n) {
  if (!n.point.allFinite() || !n.direction.allFinite() || !std::isfinite(n.first + n.second)) {
    fail(ErrorKind::input, "'{}': a declared entity has a number that is not finite; give all of its fields", owner);
  }
  if (std::abs(n.direction.norm() - 1) > kUnitLength) {
    fail(ErrorKind::input, "'{}': a declared entity's normal has length {}; give one of length 1", owner,
         n.direction.norm());
  }
  if (!(n.first > 0 && n.second > 0)) {
    fail(ErrorKind::input, "'{}': a declared entity has a radius or angle of {} but it must be above 0", owner,
         std::min(n.first, n.second));
  }
}

/// Checks of a curved face beyond the bounds of single numbers.
void check_shape(const std::string& owner, const Surface& surface) {
  if (const auto* cone = std::get_if<Cone>(&surface); cone != nullptr && cone->half_angle >= 0.5 * pinned::kPi) {
    fail(ErrorKind::input, "'{}': a declared cone has a half angle of {} rad but it must be below pi/2, 90 degrees",
         owner, cone->half_angle);
  }
  if (const auto* torus = std::get_if<Torus>(&surface); torus != nullptr && torus->minor_radius > torus->major_radius) {
    fail(ErrorKind::input,
         "'{}': a declared torus has a minor radius of {} m but it must not be above the major one, {} m", owner,
         torus->minor_radius, torus->major_radius);
  }
}

}  // namespace

DeclaredFeatures::Place DeclaredFeatures::place_of(const std::string& owner, const Entity& entity) {
  const Numbers n = numbers_of(entity);
  check(owner, n);
  if (const auto* face = std::get_if<Face>(&entity)) check_shape(owner, face->surface);
  const bool is_edge = std::holds_alternative<Edge>(entity);
  const auto next = static_cast<Place>(is_edge ? 2 * edges_.size() + 1 : 2 * faces_.size());
  const Key key = {static_cast<double>(n.kind),
                   n.point.x(),
                   n.point.y(),
                   n.point.z(),
                   n.direction.x(),
                   n.direction.y(),
                   n.direction.z(),
                   n.first,
                   n.second};
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

/// Adds a voxel's inward normal to the evidence for a hole. Where faces meet, a voxel is weak or wrong evidence.
void DeclaredFeatures::add_normal(std::size_t face, const Vector3d& p, const Vector3d& inward) {
  Surface& surface = faces_[face].surface;
  const auto from_axis = [&](const Vector3d& point, const Vector3d& direction) {
    const Vector3d arm = p - point;
    return Vector3d((arm - arm.dot(direction) * direction).normalized());
  };
  const auto add = [&](bool& hole, const Vector3d& away) {
    outwardness_[face] += away.dot(inward);
    hole = outwardness_[face] > 0;
  };
  if (auto* cylinder = std::get_if<Cylinder>(&surface)) {
    add(cylinder->hole, from_axis(cylinder->point, cylinder->direction));
  } else if (auto* cone = std::get_if<Cone>(&surface)) {
    add(cone->hole, from_axis(cone->point, cone->direction) - pinned::tan(cone->half_angle) * cone->direction);
  } else if (auto* sphere = std::get_if<Sphere>(&surface)) {
    add(sphere->hole, (p - sphere->center).normalized());
  }
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
  if (const auto* plane = std::get_if<Plane>(&f.surface)) {
    widen(f.u_range, (p - plane->point).dot(plane->x_axis));
    widen(f.v_range, (p - plane->point).dot(plane->normal.cross(plane->x_axis)));
    return;
  }
  f.u_range = {0, 2 * pinned::kPi};
  if (const auto* cylinder = std::get_if<Cylinder>(&f.surface)) {
    const auto along = [&](const Vector3d& q) { return (q - cylinder->point).dot(cylinder->direction); };
    if (const Circle* rim = rim_of(*cylinder, set)) {
      include(f.v_range, along(rim->center), along(rim->center));
    } else {
      widen(f.v_range, along(p));
    }
  } else if (const auto* cone = std::get_if<Cone>(&f.surface)) {
    widen(f.v_range, (p - cone->point).dot(cone->direction));
  } else if (std::holds_alternative<Sphere>(f.surface)) {
    f.v_range = {-0.5 * pinned::kPi, 0.5 * pinned::kPi};
  } else {
    f.v_range = {0, 2 * pinned::kPi};
  }
}

void DeclaredFeatures::assign(const VoxelBody& body, std::uint32_t voxel, FeatureSetId id) {
  VERISIM_ASSERT(voxel < body.voxmap.surface_count && id <= size() && body.shell.voxel.empty());
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
  std::vector<EntityNumber> entities;
  for (const Place place : sets_[id]) {
    entities.push_back(place % 2 == 0 ? first_face + place / 2 : first_edge + place / 2);
  }
  std::ranges::sort(entities);
  return entities;
}

}  // namespace verisim

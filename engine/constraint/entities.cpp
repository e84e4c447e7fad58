#include "engine/constraint/entities.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

constexpr std::size_t kSetsMax = 65534;  ///< the last id is kept for "no pair" in the memo
constexpr double kDeclaredHalf = 0.5;    ///< m to each side of a plane or line of which nothing else is known

bool finite(const Vector3d& v) {
  return v.allFinite();
}
bool unit(const Vector3d& v) {
  return std::abs(v.squaredNorm() - 1) < 1e-6;
}
bool positive(double x) {
  return std::isfinite(x) && x > 0;
}
bool has_length(const std::array<double, 2>& range) {
  return std::isfinite(range[0]) && std::isfinite(range[1]) && range[1] > range[0];
}

Role role_of(bool hole) {
  return hole ? Role::hole : Role::pin;
}

// Every shape says for itself whether it has a size.
bool sound(const Bounded<Plane>& f) {
  return finite(f.shape.point) && unit(f.shape.normal) && unit(f.shape.x_axis) && has_length(f.u) && has_length(f.v);
}
bool sound(const Bounded<Cylinder>& f) {
  return finite(f.shape.point) && unit(f.shape.direction) && positive(f.shape.radius) && has_length(f.v);
}
bool sound(const Bounded<Cone>& f) {
  constexpr double kSteepest = 1.5707;  // just under pi/2, where a cone becomes a plane
  return finite(f.shape.point) && unit(f.shape.direction) && std::isfinite(f.shape.radius) && f.shape.radius >= 0 &&
         positive(f.shape.half_angle) && f.shape.half_angle < kSteepest && has_length(f.v);
}
bool sound(const Bounded<Sphere>& f) {
  return finite(f.shape.center) && positive(f.shape.radius);
}
bool sound(const Bounded<Torus>& f) {
  return finite(f.shape.center) && unit(f.shape.direction) && positive(f.shape.major_radius) &&
         positive(f.shape.minor_radius);
}
bool sound(const Bounded<Line>& e) {
  return finite(e.shape.point) && unit(e.shape.direction) && has_length(e.u);
}
bool sound(const Bounded<Circle>& e) {
  return finite(e.shape.center) && unit(e.shape.normal) && positive(e.shape.radius) && has_length(e.u);
}
bool sound(const Bounded<Ellipse>& e) {
  return finite(e.shape.center) && unit(e.shape.normal) && positive(e.shape.major_radius) &&
         positive(e.shape.minor_radius) && has_length(e.u);
}

template <typename Shape>
Entity surface_if_sound(const Bounded<Shape>& f) {
  if (sound(f)) return f;
  return Bounded<OtherSurface>();
}
template <typename Shape>
Entity curve_if_sound(const Bounded<Shape>& e) {
  if (sound(e)) return e;
  return Bounded<OtherCurve>();
}

/// The role of the round face that an edge bounds; unknown if it bounds none, or a pin and a hole at once.
Role role_beside(const Edge& edge, std::span<const Face> faces) {
  Role role = Role::unknown;
  for (const std::uint32_t number : edge.faces) {
    if (number >= faces.size()) continue;
    const Role next = std::visit(
        [](const auto& surface) {
          if constexpr (requires { surface.hole; }) return role_of(surface.hole);
          return Role::unknown;
        },
        faces[number].surface);
    if (next == Role::unknown) continue;
    if (role != Role::unknown && role != next) return Role::unknown;
    role = next;
  }
  return role;
}

}  // namespace

Entity entity_of(const Face& face) {
  return std::visit(
      [&](const auto& surface) -> Entity {
        using Shape = std::decay_t<decltype(surface)>;
        if constexpr (std::is_same_v<Shape, OtherSurface>) {
          return Bounded<OtherSurface>();
        } else {
          Role role = Role::unknown;
          if constexpr (requires { surface.hole; }) role = role_of(surface.hole);
          return surface_if_sound(Bounded<Shape>{surface, face.u_range, face.v_range, role});
        }
      },
      face.surface);
}

Entity entity_of(const Edge& edge, std::span<const Face> faces) {
  return std::visit(
      [&](const auto& curve) -> Entity {
        using Shape = std::decay_t<decltype(curve)>;
        if constexpr (std::is_same_v<Shape, OtherCurve>) {
          return Bounded<OtherCurve>();
        } else {
          return curve_if_sound(Bounded<Shape>{curve, edge.t_range, {0, 0}, role_beside(edge, faces)});
        }
      },
      edge.curve);
}

Entity entity_declared(const Surface& surface) {
  Face face;
  face.surface = surface;
  face.u_range = face.v_range = {-kDeclaredHalf, kDeclaredHalf};
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) {
    face.v_range = {-2 * cylinder->radius, 2 * cylinder->radius};
  }
  if (const auto* cone = std::get_if<Cone>(&surface)) face.v_range = {0, 2 * cone->radius};
  return entity_of(face);
}

Entity entity_declared(const Curve& curve) {
  Edge edge;
  edge.curve = curve;
  edge.t_range = {0, 2 * pinned::kPi};
  if (std::holds_alternative<Line>(curve)) edge.t_range = {-kDeclaredHalf, kDeclaredHalf};
  return entity_of(edge, {});
}

namespace {
std::vector<Entity> entities_of(const Part& part) {
  std::vector<Entity> all;
  all.reserve(part.faces.size() + part.edges.size());
  for (const Face& face : part.faces) all.push_back(entity_of(face));
  for (const Edge& edge : part.edges) all.push_back(entity_of(edge, part.faces));
  return all;
}
}  // namespace

EntitySets::EntitySets(const Part& part, std::span<const std::vector<std::uint32_t>> sets)
    : EntitySets(entities_of(part), sets) {}

EntitySets::EntitySets(std::vector<Entity> entities, std::span<const std::vector<std::uint32_t>> sets)
    : entities_(std::move(entities)) {
  if (sets.size() > kSetsMax) {
    fail(ErrorKind::input, "feature sets: {} different ones, but ids reach to {}; use larger voxels", sets.size(),
         kSetsMax);
  }
  first_.reserve(sets.size() + 1);
  first_.push_back(0);
  if (sets.empty()) first_.push_back(0);
  for (const auto& set : sets) {
    for (const std::uint32_t number : set) {
      if (number >= entities_.size()) {
        fail(ErrorKind::input, "feature sets: entity {} of a part that has {}; use the part's own faces and edges",
             number, entities_.size());
      }
      numbers_.push_back(number);
    }
    first_.push_back(static_cast<std::uint32_t>(numbers_.size()));
  }
}

}  // namespace verisim

#include "engine/constraint/entities.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/entity_check.hpp"

namespace verisim {
namespace {

constexpr std::size_t kSetsMax = 65536;  ///< ids of FeatureSetId

using Range = std::array<double, 2>;

double middle(const Range& range) {
  return (range[0] + range[1]) / 2;
}
double half(const Range& range) {
  return (range[1] - range[0]) / 2;
}
Role role_of(bool hole) {
  return hole ? Role::hole : Role::pin;
}

// Each sound shape with its bounds: moved to the middle of its bounded part, or replaced by OtherSurface or OtherCurve
// if that part has no size. `u`, `v` are the face's ranges, `t` the edge's.

Entity bounded(Plane s, const Range& u, const Range& v) {
  if (!is_positive(half(u)) || !is_positive(half(v))) return Bounded<OtherSurface>();
  s.point += middle(u) * s.x_axis + middle(v) * s.normal.cross(s.x_axis);
  return Bounded<Plane>{s, std::min(half(u), half(v))};
}
Entity bounded(Cylinder s, const Range& /*u*/, const Range& v) {
  if (!is_positive(half(v))) return Bounded<OtherSurface>();
  s.point += middle(v) * s.direction;
  return Bounded<Cylinder>{s, half(v), 0, role_of(s.hole)};
}
Entity bounded(Cone s, const Range& /*u*/, const Range& v) {
  constexpr double kSteepest = 1.5707;  // just under pi/2, where a cone becomes a plane
  if (!is_positive(half(v)) || s.half_angle >= kSteepest) return Bounded<OtherSurface>();
  const double tangent = pinned::tan(s.half_angle);
  s.point += middle(v) * s.direction;
  s.radius += middle(v) * tangent;
  return Bounded<Cone>{s, half(v), tangent, role_of(s.hole)};
}
Entity bounded(const Sphere& s, const Range& /*u*/, const Range& /*v*/) {
  return Bounded<Sphere>{s, 0, 0, role_of(s.hole)};
}
Entity bounded(const Torus& s, const Range& /*u*/, const Range& /*v*/) {
  return Bounded<Torus>{s, s.minor_radius, 0, role_of(s.hole)};
}
Entity bounded(const OtherSurface& /*s*/, const Range& /*u*/, const Range& /*v*/) {
  return Bounded<OtherSurface>();
}

Entity bounded(Line s, const Range& t, Role role) {
  if (!is_positive(half(t))) return Bounded<OtherCurve>();
  s.point += middle(t) * s.direction;
  return Bounded<Line>{s, half(t), 0, role};
}
Entity bounded(const Circle& s, const Range& t, Role role) {
  if (!is_positive(half(t))) return Bounded<OtherCurve>();
  return Bounded<Circle>{s, s.radius, 0, role};
}
Entity bounded(const Ellipse& s, const Range& t, Role role) {
  if (!is_positive(half(t))) return Bounded<OtherCurve>();
  return Bounded<Ellipse>{s, s.major_radius, 0, role};
}
Entity bounded(const OtherCurve& /*s*/, const Range& /*t*/, Role /*role*/) {
  return Bounded<OtherCurve>();
}

/// The role of the curved face that an edge bounds; unknown if it bounds none, or both a pin and a hole.
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

/// May it bound a plane (EntitySets::rounds_at)?
bool is_round(const Entity& e) {
  constexpr Overloaded is_round_shape{[](const Plane&) { return false; },   [](const Cylinder&) { return true; },
                                      [](const Cone&) { return true; },     [](const Sphere&) { return false; },
                                      [](const Torus&) { return false; },   [](const OtherSurface&) { return false; },
                                      [](const Line&) { return false; },    [](const Circle&) { return true; },
                                      [](const Ellipse&) { return false; }, [](const OtherCurve&) { return false; }};
  return std::visit([&](const auto& bounded) { return is_round_shape(bounded.shape); }, e);
}

}  // namespace

Entity entity_of(const Face& face) {
  if (fault_of(face.surface)) return Bounded<OtherSurface>();
  return std::visit([&](const auto& surface) { return bounded(surface, face.u_range, face.v_range); }, face.surface);
}

Entity entity_of(const Edge& edge, std::span<const Face> faces) {
  if (fault_of(edge.curve)) return Bounded<OtherCurve>();
  return std::visit([&](const auto& curve) { return bounded(curve, edge.t_range, role_beside(edge, faces)); },
                    edge.curve);
}

std::vector<Entity> EntitySets::entities_of(std::span<const Face> faces, std::span<const Edge> edges) {
  std::vector<Entity> all;
  all.reserve(faces.size() + edges.size());
  for (const Face& face : faces) all.push_back(entity_of(face));
  for (const Edge& edge : edges) all.push_back(entity_of(edge, faces));
  return all;
}

void EntitySets::add(std::span<const std::uint32_t> set, std::size_t sets) {
  if (sets > kSetsMax) {
    fail(ErrorKind::input, "feature sets: {} different ones, but ids reach to {}; use larger voxels", sets, kSetsMax);
  }
  first_.push_back(static_cast<std::uint32_t>(numbers_.size()));
  for (const std::uint32_t number : set) {
    if (number >= entities_.size()) {
      fail(ErrorKind::input, "feature sets: entity {} of a part that has {}; use the part's own faces and edges",
           number, entities_.size());
    }
    numbers_.push_back(number);
  }
}

void EntitySets::find_curved_neighbors() {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t id = 0; id < size(); ++id) {
    const auto members = set(static_cast<FeatureSetId>(id));
    for (const std::uint32_t plane : members) {
      if (!std::holds_alternative<Bounded<Plane>>(entities_[plane])) continue;
      for (const std::uint32_t other : members) {
        if (is_round(entities_[other])) pairs.emplace_back(plane, other);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  first_neighbor_.assign(entities_.size() + 1, 0);
  for (const auto& [plane, round] : pairs) {
    ++first_neighbor_[plane + 1U];
    neighbors_.push_back(round);
  }
  std::partial_sum(first_neighbor_.begin(), first_neighbor_.end(), first_neighbor_.begin());
}

}  // namespace verisim

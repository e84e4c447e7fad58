#include "engine/exact/conforming_normals.hpp"

#include <span>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

constexpr std::array<double, 7> kLeans = {0.008, 0.016, 0.032, 0.064,
                                          0.13,  0.34,  0.86};  // rad, from the closest normal
constexpr std::size_t kSides = 8;                               // of a lean
static_assert(2 * kTurns.size() <= ConformingNormals::kMax);
static_assert(kSides * kLeans.size() <= ConformingNormals::kMax);

constexpr std::size_t kFirstOfRing = 1, kWide = 6;  // of kTurns

/// Cosine and sine of an angle.
struct Turn {
  double c, s;
};

/// Of all angles once: a group asks for 20 of them in every step.
template <std::size_t N>
std::array<Turn, N> turns_of(const std::array<double, N>& angles) {
  std::array<Turn, N> turns;
  for (std::size_t i = 0; i < N; ++i) turns[i] = {pinned::cos(angles[i]), pinned::sin(angles[i])};
  return turns;
}

const auto kTurnsAbout = turns_of(kTurns);
const auto kLeansOut = turns_of(kLeans);
const auto kSidesRound = [] {
  std::array<double, 2 * kSides> angles;
  for (std::size_t i = 0; i < angles.size(); ++i)
    angles[i] = pinned::kFullTurn * static_cast<double>(i) / static_cast<double>(angles.size());
  return turns_of(angles);
}();

/// Normals that turn with the closest one about an axis.
void turn_about(const Vector3d& axis, const Vector3d& normal, std::span<const Turn> turns, ConformingNormals& found) {
  const Vector3d along = normal.dot(axis) * axis;
  const Vector3d across = normal - along;
  const Vector3d side = axis.cross(across);
  for (const Turn& turn : turns)
    for (const double sense : {-1.0, 1.0})
      found.normals[found.count++] = (along + turn.c * across + sense * turn.s * side).normalized();
}

/// Normals on circles about the closest one.
void lean_to_all_sides(const Vector3d& normal, ConformingNormals& found) {
  const Vector3d first = normal.unitOrthogonal();
  const Vector3d second = normal.cross(first);
  std::size_t begin = 0;  // every other circle is turned by half a side
  for (const Turn& lean : kLeansOut) {
    for (std::size_t i = begin; i < kSidesRound.size(); i += 2) {
      const Vector3d side = kSidesRound[i].c * first + kSidesRound[i].s * second;
      found.normals[found.count++] = lean.c * normal + lean.s * side;
    }
    begin = 1 - begin;
  }
}

}  // namespace

std::optional<HollowPlace> hollow_place(const AnalyticSurface& surface, const Vector3d& p) {
  const Meridian& meridian = surface.meridian();
  if (surface.side() > 0 || meridian.kind == SurfaceKind::plane) return std::nullopt;
  HollowPlace place{.pivot = surface.point(), .axis = surface.axis()};
  const Vector3d arm = p - surface.point();
  const Vector3d across = arm - arm.dot(place.axis) * place.axis;
  const double rho = across.norm();
  place.radius = rho;
  switch (meridian.kind) {
    case SurfaceKind::plane:
    case SurfaceKind::cylinder:
      break;
    case SurfaceKind::cone:
      place.pivot += meridian.apex() * place.axis;
      break;
    case SurfaceKind::sphere:
      place.radius = arm.norm();
      place.is_in_ball = true;
      break;
    case SurfaceKind::torus:
      if (rho == 0) return std::nullopt;
      place.pivot += meridian.ring / rho * across;
      place.radius = (p - place.pivot).norm();
      place.axis = place.axis.cross(across) / rho;
      place.is_in_tube = true;
      break;
  }
  return place;
}

ConformingNormals conforming_normals(const HollowPlace& place, const Vector3d& normal, bool touches) {
  ConformingNormals found;
  if (place.is_in_ball) {
    lean_to_all_sides(normal, found);
  } else {
    const std::size_t first = !place.is_in_tube ? 0 : touches ? kFirstOfRing : kWide;
    turn_about(place.axis, normal, std::span(kTurnsAbout).subspan(first), found);
  }
  return found;
}

}  // namespace verisim::exact

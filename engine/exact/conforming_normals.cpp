#include "engine/exact/conforming_normals.hpp"

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

constexpr std::array<double, 5> kLeans = {0.02, 0.05, 0.13, 0.34, 0.86};  // rad, from the closest normal
constexpr int kSides = 8;                                                 // of a lean
static_assert(2 * kTurns.size() <= ConformingNormals::kMax);
static_assert(kSides * kLeans.size() <= ConformingNormals::kMax);

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
  std::array<double, kSides> angles;
  for (int i = 0; i < kSides; ++i) angles[static_cast<std::size_t>(i)] = pinned::kFullTurn * i / kSides;
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
  for (const Turn& lean : kLeansOut) {
    for (const Turn& turn : kSidesRound) {
      const Vector3d side = turn.c * first + turn.s * second;
      found.normals[found.count++] = lean.c * normal + lean.s * side;
    }
  }
}

}  // namespace

ConformingNormals conforming_normals(const AnalyticSurface& surface, const Vector3d& p, const SurfaceAt& at) {
  ConformingNormals found;
  const Meridian& meridian = surface.meridian();
  if (surface.side() > 0 || meridian.kind == SurfaceKind::plane) return found;
  const Vector3d& axis = surface.axis();
  found.pivot = surface.point();
  const Vector3d arm = p - surface.point();
  const Vector3d across = arm - arm.dot(axis) * axis;
  switch (meridian.kind) {
    case SurfaceKind::plane:
      break;
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
      if (meridian.kind == SurfaceKind::cone) found.pivot += meridian.apex() * axis;
      found.radius = across.norm();
      turn_about(axis, at.normal, kTurnsAbout, found);
      break;
    case SurfaceKind::sphere:
      found.radius = arm.norm();
      lean_to_all_sides(at.normal, found);
      break;
    case SurfaceKind::torus: {
      const double rho = across.norm();
      if (rho == 0) return found;
      found.pivot += meridian.ring / rho * across;
      found.radius = (p - found.pivot).norm();
      // A ring lies on many places of a tube at once. With the first three it takes 15 to 20 % longer, and of 16 held
      // rings 3 go to and fro by more than 1 mN (4.5 mN at most), without them 5 (7.7 mN).
      turn_about(axis.cross(across) / rho, at.normal, std::span(kTurnsAbout).subspan(3), found);
      break;
    }
  }
  return found;
}

}  // namespace verisim::exact

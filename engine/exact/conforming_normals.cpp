#include "engine/exact/conforming_normals.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::exact {
namespace {

constexpr std::array<double, 8> kLeans = {0.008, 0.016, 0.032, 0.064,
                                          0.128, 0.256, 0.512, 1.024};  // rad, from the closest normal
constexpr std::size_t kSides = 8;                                       // of a lean
static_assert(2 * kTurns.size() <= ConformingNormals::kMax);
static_assert(kSides * kLeans.size() <= ConformingNormals::kMax);

constexpr std::size_t kFirstOfRing = 2, kWide = 7;  // of kTurns

double square(double x) {
  return x * x;
}

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

/// Of kTurns. The narrow ones grow with the square of the angle. The others are those of even stiffness. What fits
/// without a clearance is pressed from all round, and rests in the middle if no direction is preferred: the sums of the
/// normals, and of their squares, are those of normals all round. That says how stiff two of them are.
std::array<double, kTurns.size()> find_parts_of_turns() {
  constexpr std::size_t narrow = 7, side = 11, back = 13;  // the last narrow one, across, and opposite
  std::array<double, kTurns.size()> parts{};
  for (std::size_t i = 0; i <= narrow; ++i) parts[i] = square(kTurns[i] / kTurnOfOne);
  const double even = 2 * parts[narrow] / (kTurns[narrow + 1] - kTurns[narrow - 1]);  // 1/rad
  for (std::size_t i = narrow + 1; i < back; ++i) parts[i] = even * (kTurns[i + 1] - kTurns[i - 1]) / 2;
  parts[side] = parts[back] = 0;
  double sum = 0, sum_of_doubled = 0;  // of cosines
  for (std::size_t i = 0; i < kTurns.size(); ++i) {
    sum += parts[i] * kTurnsAbout[i].c;
    sum_of_doubled += parts[i] * (2 * square(kTurnsAbout[i].c) - 1);
  }
  const double c = kTurnsAbout[side].c;
  parts[side] = -(sum + sum_of_doubled) / (c + 2 * c * c - 1);
  parts[back] = sum + parts[side] * c;
  return parts;
}
const auto kPartsOfTurns = find_parts_of_turns();

/// Normals that turn with the closest one about an axis.
/// @param first, end  of kTurns
void turn_about(const Vector3d& axis, const Vector3d& normal, std::size_t first, std::size_t end,
                ConformingNormals& found) {
  const Vector3d along = normal.dot(axis) * axis;
  const Vector3d across = normal - along;
  const Vector3d side = axis.cross(across);
  for (std::size_t i = first; i < end; ++i) {
    const Turn& turn = kTurnsAbout[i];
    for (const double sense : {-1.0, 1.0}) {
      found.parts[found.count] = kPartsOfTurns[i];
      found.normals[found.count++] = (along + turn.c * across + sense * turn.s * side).normalized();
    }
  }
  found.part_of_closest = std::min(1.0, kPartsOfTurns[first]);
}

/// Normals on circles about the closest one.
void lean_to_all_sides(const Vector3d& normal, ConformingNormals& found) {
  const Vector3d first = normal.unitOrthogonal();
  const Vector3d second = normal.cross(first);
  std::size_t begin = 0;  // every other circle is turned by half a side
  for (std::size_t k = 0; k < kLeans.size(); ++k) {
    const Turn& lean = kLeansOut[k];
    for (std::size_t i = begin; i < kSidesRound.size(); i += 2) {
      const Vector3d side = kSidesRound[i].c * first + kSidesRound[i].s * second;
      found.parts[found.count] = square(kLeans[k] / kLeanOfOne);
      found.normals[found.count++] = lean.c * normal + lean.s * side;
    }
    begin = 1 - begin;
  }
  found.part_of_closest = square(kLeans.front() / kLeanOfOne);
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

ConformingNormals conforming_normals(const HollowPlace& place, const Vector3d& normal, bool touches, bool stays) {
  ConformingNormals found;
  if (place.is_in_ball) {
    lean_to_all_sides(normal, found);
  } else if (place.is_in_tube) {
    turn_about(place.axis, normal, touches ? kFirstOfRing : kWide, stays ? kWide : kTurns.size(), found);
  } else {
    turn_about(place.axis, normal, 0, kTurns.size(), found);
  }
  return found;
}

}  // namespace verisim::exact

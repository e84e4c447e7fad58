#include "engine/geometry/entity_row.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

EntityRow make_row(const Vector3d& point, const Vector3d& direction, const Vector3d& x_axis, double first,
                   double second) {
  EntityRow row{};
  std::copy_n(point.data(), 3, row.begin());
  std::copy_n(direction.data(), 3, row.begin() + 3);
  std::copy_n(x_axis.data(), 3, row.begin() + 6);
  row[9] = first;
  row[10] = second;
  return row;
}

struct ToRow {
  EntityRow operator()(const Plane& s) const { return make_row(s.point, s.normal, s.x_axis, 0, 0); }
  EntityRow operator()(const Cylinder& s) const { return make_row(s.point, s.direction, s.x_axis, s.radius, 0); }
  EntityRow operator()(const Cone& s) const { return make_row(s.point, s.direction, s.x_axis, s.radius, s.half_angle); }
  EntityRow operator()(const Sphere& s) const { return make_row(s.center, s.direction, s.x_axis, s.radius, 0); }
  EntityRow operator()(const Torus& s) const {
    return make_row(s.center, s.direction, s.x_axis, s.major_radius, s.minor_radius);
  }
  EntityRow operator()(const OtherSurface&) const { return EntityRow{}; }
  EntityRow operator()(const Line& c) const { return make_row(c.point, c.direction, Vector3d::Zero(), 0, 0); }
  EntityRow operator()(const Circle& c) const { return make_row(c.center, c.normal, c.x_axis, c.radius, 0); }
  EntityRow operator()(const Ellipse& c) const {
    return make_row(c.center, c.normal, c.x_axis, c.major_radius, c.minor_radius);
  }
  EntityRow operator()(const OtherCurve&) const { return EntityRow{}; }
};

/// One function per kind: a kind without one does not compile.
struct FromRow {
  const EntityRow& r;
  bool hole;

  template <typename Kind>
  using As = std::type_identity<Kind>;

  [[nodiscard]] Vector3d at(std::size_t column) const { return {r[column], r[column + 1], r[column + 2]}; }

  Plane operator()(As<Plane>) const { return {at(0), at(3), at(6)}; }
  Cylinder operator()(As<Cylinder>) const { return {at(0), at(3), at(6), r[9], hole}; }
  Cone operator()(As<Cone>) const { return {at(0), at(3), at(6), r[9], r[10], hole}; }
  Sphere operator()(As<Sphere>) const { return {at(0), at(3), at(6), r[9], hole}; }
  Torus operator()(As<Torus>) const { return {at(0), at(3), at(6), r[9], r[10], hole}; }
  OtherSurface operator()(As<OtherSurface>) const { return {}; }
  Line operator()(As<Line>) const { return {at(0), at(3)}; }
  Circle operator()(As<Circle>) const { return {at(0), at(3), at(6), r[9]}; }
  Ellipse operator()(As<Ellipse>) const { return {at(0), at(3), at(6), r[9], r[10]}; }
  OtherCurve operator()(As<OtherCurve>) const { return {}; }
};

template <typename Variant>
Variant from_row(std::size_t kind, const FromRow& make) {
  VERISIM_ASSERT(kind < std::variant_size_v<Variant>);
  Variant result;
  const auto take = [&]<std::size_t... index>(std::index_sequence<index...>) {
    const auto take_one = [&]<std::size_t i>() {
      if (i == kind) result = make(std::type_identity<std::variant_alternative_t<i, Variant>>{});
    };
    (take_one.template operator()<index>(), ...);
  };
  take(std::make_index_sequence<std::variant_size_v<Variant>>{});
  return result;
}

}  // namespace

EntityRow row_of(const Surface& surface) {
  return std::visit(ToRow{}, surface);
}

EntityRow row_of(const Curve& curve) {
  return std::visit(ToRow{}, curve);
}

bool is_hole(const Surface& surface) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.hole; }) return s.hole;
        return false;
      },
      surface);
}

Surface surface_from(std::size_t kind, const EntityRow& row, bool hole) {
  return from_row<Surface>(kind, FromRow{row, hole});
}

Curve curve_from(std::size_t kind, const EntityRow& row) {
  return from_row<Curve>(kind, FromRow{row, false});
}

}  // namespace verisim

// A surface or curve as one row of numbers, the same columns for all kinds: what tables hold, and what tells two
// entities apart.
#pragma once

#include <array>
#include <cstddef>

#include "engine/geometry/entity.hpp"

namespace verisim {

/// Point or centre (3), direction or normal (3), x axis (3), then two sizes: radius or major radius; minor radius, of a
/// cone the half angle. m and rad; 0 where a kind has no such number. Of OtherSurface and OtherCurve: zeros.
using EntityRow = std::array<double, 11>;

[[nodiscard]] EntityRow row_of(const Surface& surface);
[[nodiscard]] EntityRow row_of(const Curve& curve);
/// Is the material outside of the round surface? No for planes and other surfaces.
[[nodiscard]] bool is_hole(const Surface& surface);

/// The surface of a row: kind is its index in Surface. @pre kind < std::variant_size_v<Surface>
[[nodiscard]] Surface surface_from(std::size_t kind, const EntityRow& row, bool hole);
/// @pre kind < std::variant_size_v<Curve>
[[nodiscard]] Curve curve_from(std::size_t kind, const EntityRow& row);

}  // namespace verisim

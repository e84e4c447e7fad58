#include "engine/wii/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/virtual_remote.hpp"

namespace verisim::wii {
namespace {

/// Share of heads, drawn evenly from [-x, x] x [-y, y] x [d1, d2], of which the ideal remote sees both LEDs.
Counted count_trackable(const FieldOfView& fov, double spacing, double d1, double d2, std::uint64_t count,
                        std::uint64_t seed) {
  VERISIM_ASSERT(count > 0);
  VERISIM_ASSERT(is_not_negative(spacing));
  VERISIM_ASSERT(is_not_negative(d1));
  VERISIM_ASSERT(std::isfinite(d2));
  VERISIM_ASSERT(d1 <= d2);
  RemoteSettings settings;
  settings.fov = fov;
  settings.leds = {Led{{spacing / 2, 0, 0}}, Led{{-spacing / 2, 0, 0}}};
  VirtualRemote remote(settings, seed, "coverage");
  const RandomStream place(seed, "coverage/place");
  const double x = d2 * pinned::tan(fov.horizontal / 2);
  const double y = d2 * pinned::tan(fov.vertical / 2);
  std::uint64_t seen = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto uniform = [&](std::uint64_t i) { return place.uniform(3 * k + i); };
    Situation s;
    s.X_WH.position = {x * (2 * uniform(0) - 1), y * (2 * uniform(1) - 1), d1 + (d2 - d1) * uniform(2)};
    seen += remote.sense(k, s).led_in_view == 3U ? 1 : 0;
  }
  const double fraction = static_cast<double>(seen) / static_cast<double>(count);
  const double box = 4 * x * y;
  return {box * fraction, box * std::sqrt(fraction * (1 - fraction) / static_cast<double>(count))};
}

}  // namespace

double trackable_area(const FieldOfView& fov, double spacing, double d) {
  VERISIM_ASSERT(is_not_negative(spacing));
  VERISIM_ASSERT(is_not_negative(d));
  const double width = 2 * d * pinned::tan(fov.horizontal / 2) - spacing;
  return std::max(0.0, width) * 2 * d * pinned::tan(fov.vertical / 2);
}

double trackable_volume_as_printed(const FieldOfView& fov, double spacing, double d1, double d2) {
  return (trackable_area(fov, spacing, d2) * d2 - trackable_area(fov, spacing, d1) * d1) / 3;
}

double trackable_volume(const FieldOfView& fov, double spacing, double d1, double d2) {
  VERISIM_ASSERT(d1 <= d2);
  const double th = pinned::tan(fov.horizontal / 2);
  const double tv = pinned::tan(fov.vertical / 2);
  VERISIM_ASSERT(2 * d1 * th >= spacing);
  return 4.0 / 3 * th * tv * (d2 * d2 * d2 - d1 * d1 * d1) - spacing * tv * (d2 * d2 - d1 * d1);
}

Counted count_trackable_area(const FieldOfView& fov, double spacing, double d, std::uint64_t count,
                             std::uint64_t seed) {
  return count_trackable(fov, spacing, d, d, count, seed);
}

Counted count_trackable_volume(const FieldOfView& fov, double spacing, double d1, double d2, std::uint64_t count,
                               std::uint64_t seed) {
  const Counted area = count_trackable(fov, spacing, d1, d2, count, seed);
  return {area.value * (d2 - d1), area.standard_error * (d2 - d1)};
}

}  // namespace verisim::wii

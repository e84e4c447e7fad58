#include "engine/wii/tracker.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/trackers.hpp"

namespace verisim::wii {
namespace {

using Maker = std::unique_ptr<Tracker> (*)(const TrackerSettings&);
struct Entry {
  std::string_view name;
  Maker make;
};
/// To add a tracker: a factory in trackers.hpp, a row here.
constexpr std::array kTrackers = {
    Entry{"geometric", make_geometric}, Entry{"vrpn-compatible", make_vrpn_compatible},
    Entry{"three-led", make_three_led}, Entry{"scaat", make_scaat},
    Entry{"stereo", make_stereo},
};

void require_positive(const char* what, double value, double max) {
  if (!(value > 0 && value < max))
    fail(ErrorKind::input, "tracker settings: {} is {} but must lie between 0 and {}; correct it", what, value, max);
}

}  // namespace

void check_settings(const TrackerSettings& settings) {
  require_positive("horizontal field of view [rad]", settings.fov.horizontal, pinned::kPi);
  require_positive("vertical field of view [rad]", settings.fov.vertical, pinned::kPi);
  require_positive("pixel_sigma", settings.pixel_sigma, kWidth);
  require_positive("gravity_sigma [rad]", settings.gravity_sigma, pinned::kPi);
  require_positive("gravity_time_constant [s]", settings.gravity_time_constant, 1e6);
  require_positive("yaw_sigma [rad]", settings.yaw_sigma, pinned::kPi);
  require_positive("pitch_sigma [rad]", settings.pitch_sigma, pinned::kPi);
  const LedLayout& leds = settings.leds;
  if (leds.count < 2 || leds.count > kLedsMax)
    fail(ErrorKind::input, "leds: {} given but trackers use 2 to {}; name them as '# leds: x y z; x y z'", leds.count,
         kLedsMax);
  for (int i = 0; i < leds.count; ++i)
    if (!(leds.p_H[static_cast<std::size_t>(i)].norm() < 1))
      fail(ErrorKind::input, "leds: number {} is not within 1 m of the head; positions are in metres", i + 1);
  const double across = (leds.p_H[0] - leds.p_H[1]).head<2>().norm();
  if (!(across >= 0.01))
    fail(ErrorKind::input, "leds: the first two are {} m apart seen from the front but must be 0.01 m; reorder them",
         across);
  if (!is_placement(settings.X_R1R2))
    fail(ErrorKind::input, "tracker settings: the second remote's placement is not finite with a unit quaternion");
}

const std::vector<std::string>& tracker_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : kTrackers) all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerSettings& settings) {
  for (const Entry& entry : kTrackers) {
    if (entry.name != name) continue;
    check_settings(settings);
    return entry.make(settings);
  }
  const std::string near = nearest_name(std::string(name), tracker_names());
  fail(ErrorKind::input, "tracker '{}' is not known{}; choose one of {}", name,
       near.empty() ? "" : fmt::format(", did you mean '{}'?", near), fmt::join(tracker_names(), ", "));
}

}  // namespace verisim::wii

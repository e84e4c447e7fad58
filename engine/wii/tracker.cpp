#include "engine/wii/tracker.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/trackers.hpp"

namespace verisim::wii {
namespace {

constexpr std::array kNumberWords = {"no", "one", "two", "three", "four"};
static_assert(kNumberWords.size() == kLedsMax + 1);

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
  if (settings.X_R1R2 && !is_placement(*settings.X_R1R2))
    fail(ErrorKind::input, "tracker settings: the second remote's placement is not finite with a unit quaternion");
}

namespace {

bool has_remotes(const TrackerEntry& entry, const TrackerSettings& settings) {
  return entry.remotes == 1 || settings.X_R1R2;
}
bool has_leds(const TrackerEntry& entry, const TrackerSettings& settings) {
  return settings.leds.count >= entry.leds_min;
}

/// ", or choose one of …": those that these settings suffice for; empty if there are none.
std::string other_choices(const TrackerSettings& settings, Trackers among) {
  std::vector<std::string_view> names;
  for (const TrackerEntry& other : among)
    if (has_remotes(other, settings) && has_leds(other, settings)) names.push_back(other.name);
  return names.empty() ? "" : fmt::format(", or choose one of {}", fmt::join(names, ", "));
}

void check_needs(const TrackerEntry& entry, const TrackerSettings& settings, Trackers among) {
  if (!has_remotes(entry, settings))
    fail(ErrorKind::input, "tracker {}: one remote is described but it needs two; say where a second one stands{}",
         entry.name, other_choices(settings, among));
  if (!has_leds(entry, settings))
    fail(ErrorKind::input, "tracker {}: {} LEDs are described but it needs {}; add to '# leds:'{}", entry.name,
         settings.leds.count, kNumberWords.at(static_cast<std::size_t>(entry.leds_min)),
         other_choices(settings, among));
}

}  // namespace

Trackers trackers() {
  static const std::array kTable = {
      TrackerEntry{.name = "geometric", .make = make_geometric},
      TrackerEntry{.name = "vrpn-compatible", .make = make_vrpn_compatible},
      TrackerEntry{.name = "three-led", .make = make_three_led, .leds_min = 3, .leds = LedLayout::triangle()},
      TrackerEntry{.name = "scaat", .make = make_scaat, .judged_with_triangle = true},
      TrackerEntry{.name = "stereo", .make = make_stereo, .remotes = 2},
  };
  return kTable;
}

std::vector<std::string> tracker_names(Trackers among) {
  std::vector<std::string> names;
  for (const TrackerEntry& entry : among) names.emplace_back(entry.name);
  return names;
}

const TrackerEntry& find_tracker(std::string_view name, Trackers among) {
  for (const TrackerEntry& entry : among)
    if (entry.name == name) return entry;
  const std::vector<std::string> known = tracker_names(among);
  const std::string near = nearest_name(std::string(name), known);
  fail(ErrorKind::input, "tracker '{}' is not known{}; choose one of {}", name,
       near.empty() ? "" : fmt::format(", did you mean '{}'?", near), fmt::join(known, ", "));
}

std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerSettings& settings, Trackers among) {
  const TrackerEntry& entry = find_tracker(name, among);
  check_settings(settings);
  check_needs(entry, settings, among);
  return entry.make(settings);
}

}  // namespace verisim::wii

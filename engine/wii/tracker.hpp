// Head trackers: from the channels of a Wii Remote to the pose of the head, one interface for all.
//
// A tracker is fed by channels alone, recorded or simulated. It reports the pose X_LH of the head in levelled
// coordinates L (gravity.hpp), whether that report may be used, and how sure it is. Rules that hold for every tracker
// except vrpn-compatible, which does what VRPN does:
//   - Nothing is valid before the first data; until then the pose is NaN.
//   - A valid pose is 0.2 to 5 m away. It has moved since the last valid one by at most 5 m/s and turned by at most
//     15 rad/s, or `reacquired` says that it stands elsewhere for a reason (first lock, after a loss, confirmed by a
//     second report, or found to be half a turn from where it seemed to be).
//   - A report that is not valid repeats the last estimate (scaat: its prediction).
//   - Time that stands still or goes back by up to 1 s is no news; further back is a new recording, and starts anew.
//   - No allocation and bounded work per update; nothing throws after make_tracker.
// Sources: dissertation section 2.7 and 2.9, issue "The virtual Wii Remote and a tracker that deserves it".
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/wii/pinhole.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

inline constexpr int kLedsMax = 4;

/// The infrared LEDs on the glasses, head coordinates H: origin midway between the first two, +x the wearer's right, +y
/// up, +z backwards [m].
struct LedLayout {
  std::array<Vector3d, kLedsMax> p_H = {Vector3d{0.075, 0, 0}, Vector3d{-0.075, 0, 0}, Vector3d::Zero(),
                                        Vector3d::Zero()};
  int count = 2;

  /// Glasses of this project with a third LED above and in front of the other two: yaw moves it sideways by 6 cm per
  /// rad against them, which is what tells yaw from distance.
  [[nodiscard]] static LedLayout triangle() {
    LedLayout layout;
    layout.p_H[2] = {0, 0.04, -0.06};
    layout.count = 3;
    return layout;
  }
};

/// What a tracker may know. Noise figures are assumptions: they set the covariance (and the gains of scaat).
struct TrackerSettings {
  LedLayout leds;
  FieldOfView fov;
  double pixel_sigma = 0.4;  ///< pixel; rounding alone is 1/sqrt(12) = 0.29, with 0.3 px of noise 0.42
  /// rad of tilt that no averaging removes; rounding to 104 counts per g is 0.0028. What readings scatter is learned.
  double gravity_sigma = 0.003;
  double gravity_time_constant = 0.1;  ///< s, smoothing of the accelerometer
  double yaw_sigma = 9 * kDegree;      ///< how far heads turn: what two LEDs cannot see
  double pitch_sigma = 5 * kDegree;    ///< how far heads nod
  std::optional<Pose> X_R1R2;          ///< the second remote in coordinates of the first; none: there is no second
  Thresholds thresholds = {};
};

struct Report {
  double t = std::numeric_limits<double>::quiet_NaN();  ///< s, of the data that it rests on
  bool valid = false;
  bool news = false;        ///< rests on data that no report before rested on; false in heartbeats and refused input
  bool reacquired = false;  ///< valid, but not a continuation of the last valid report
  Pose pose;                ///< X_LH
  Matrix6d covariance;      ///< of position [m^2], then of a rotation vector in L [rad^2]
};

class Tracker {
 public:
  virtual ~Tracker() = default;
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One report of remote number `remote` (0, or 1 where the tracker needs two) at its time [s]. Any input is survived.
  virtual const Report& update(double t, std::span<const double> channels, int remote) = 0;
  const Report& update(double t, std::span<const double> channels) { return update(t, channels, 0); }
  /// Asked at time t without new data: the last report, not news, and not valid once it is older than 0.5 s.
  virtual const Report& heartbeat(double t) = 0;
};

/// All that is known of a tracker before it is made: one row of the table of trackers.
struct TrackerEntry {
  std::string_view name;
  std::unique_ptr<Tracker> (*make)(const TrackerSettings&) =
      nullptr;                        ///< called only with settings that meet the needs
  int remotes = 1;                    ///< that it needs: 1 or 2
  int leds_min = 2;                   ///< LEDs that it needs
  LedLayout leds = {};                ///< glasses that suit it, where a user names none
  bool judged_with_triangle = false;  ///< validate also runs it as NAME/3, with the triangle of LEDs
};
using Trackers = std::span<const TrackerEntry>;

/// The trackers of this project: geometric, vrpn-compatible, three-led, scaat, stereo. Every function that looks for
/// one by its name takes a table, so that others can be tried beside them (README: to add a tracker).
[[nodiscard]] Trackers trackers();
[[nodiscard]] std::vector<std::string> tracker_names(Trackers among = trackers());
/// Error(input) for a name that is not in the table; it lists those that are.
[[nodiscard]] const TrackerEntry& find_tracker(std::string_view name, Trackers among = trackers());

/// Error(input) for settings that are not positive and finite, or first two LEDs less than 1 cm apart across.
void check_settings(const TrackerSettings& settings);

/// Error(input) for an unknown name, settings that are not positive and finite, first two LEDs less than 1 cm apart
/// across, or needs that are not met: too few LEDs, no second remote.
[[nodiscard]] std::unique_ptr<Tracker> make_tracker(std::string_view name, const TrackerSettings& settings,
                                                    Trackers among = trackers());

}  // namespace verisim::wii

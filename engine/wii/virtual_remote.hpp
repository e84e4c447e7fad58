// A Wii Remote that exists as numbers: what its sensor and accelerometer would send for a given pose of a head.
//
// Every imperfection is a named parameter that is off by default (the default is the ideal device of
// reference/wii/README.md: exact pinhole, whole pixels, exact accelerometer, 100 reports/s). Random numbers come from
// counter-based streams named after the remote: a report depends on its number, never on what was drawn before, and one
// imperfection can be switched without moving any other. The true pose rides along for whoever judges; trackers are
// given the channels alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/wii/pinhole.hpp"
#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// Where everything is at one moment. World coordinates W: right-handed, +y opposed to gravity.
struct Situation {
  Pose X_WR;                                   ///< the remote
  Vector3d acceleration_W = Vector3d::Zero();  ///< of the remote [m/s^2]
  Pose X_WH;                                   ///< the head
};

/// One infrared LED on the head.
struct Led {
  Vector3d p_H = Vector3d::Zero();  ///< m
  Vector3d axis_H = {0, 0, -1};     ///< unit, where it shines: forward
  double power = 1;                 ///< of a fresh one, 1 m away: blob size 4
};

/// An occluder: a ball that hides LEDs and lamps behind it. The wearer's own head is one.
struct Ball {
  Vector3d centre = Vector3d::Zero();  ///< m, W (or H, if on_head)
  double radius = 0;                   ///< m
  bool on_head = false;
};

/// A light that is not an LED: clutter in the image.
struct Lamp {
  Vector3d p_W = Vector3d::Zero();  ///< m
  double power = 1;
  double begin = 0;  ///< s
  double end = std::numeric_limits<double>::infinity();
};

/// LED `led` (all of them: -1) is dark from `begin` to before `end`.
struct Outage {
  int led = -1;
  double begin = 0;
  double end = 0;
};

/// From time t on, what was in slot a comes in slot b, and the other way round.
struct SlotExchange {
  double t = 0;
  int a = 0;
  int b = 1;
};

enum class SlotRule {
  own,         ///< blob of LED i in slot i, lamps in what is left: the reference recordings' way
  first_free,  ///< a blob that enters takes the lowest free slot and keeps it until it leaves
};

struct RemoteSettings {
  FieldOfView fov;
  /// Up to 32; trackers take up to kLedsMax of them, a report shows at most four.
  std::vector<Led> leds = {Led{{0.075, 0, 0}}, Led{{-0.075, 0, 0}}};

  // Image                            off        on
  bool whole_pixels = true;   // false      true: rounded to the sensor's 10 bits
  int subpixels = 8;          // 8          1, 2 or 4: low sensitivity; positions are whole multiples of 8 / subpixels
  double subpixel_error = 0;  // pixel; 0   0.2: amplitude of the error with the period of a base pixel (1/128 width)
  double distortion_k1 = 0;   // 1; 0       -0.05: radial, factor 1 + k1 r^2 + k2 r^4 with r = tan(angle off the axis)
  double distortion_k2 = 0;   // 1; 0       0.01
  double pixel_noise = 0;     // pixel; 0   0.3: standard deviation, before rounding

  // Light
  double battery = 1;           // 1          0.2: power of the LEDs relative to fresh cells
  double half_power_angle = 0;  // rad; 0     20 deg: emission falls to half there, and to nothing behind
  double intensity_min = 0;     // 1; 0       0.05: power / distance^2 that is still seen
  std::vector<Ball> balls;
  std::vector<Lamp> lamps;
  std::vector<Outage> outages;
  SlotRule slot_rule = SlotRule::own;
  std::vector<SlotExchange> exchanges;

  // Accelerometer
  int accelerometer_bits = 0;  // 0: exact   8: 26 counts per g, 10: 104 counts per g (ORACLES "Wii hardware")
  Vector3d accelerometer_bias = Vector3d::Zero();                        // g, accelerometer axes
  double accelerometer_noise = 0;                                        // g; 0   0.01: standard deviation per axis
  double accelerometer_limit = std::numeric_limits<double>::infinity();  // g; 3.6

  // Reports
  double rate = 100;  // 1/s
  double jitter = 0;  // 0          0.2: of a period, either way, uniform; below 0.5
  double loss = 0;    // 0          0.02: fraction of reports that never arrive
};

/// One report and, beside it, the truth.
struct SensedReport {
  double t = 0;              ///< s
  Channels channels{};       ///< all that a tracker may see
  Pose X_LH;                 ///< true pose in levelled coordinates
  unsigned led_in_view = 0;  ///< bit i: the channels hold LED i
};

/// The true levelled pose X_LH of a situation. @pre the remote is turned by a rotation
[[nodiscard]] Pose levelled_pose(const Situation& situation);

class VirtualRemote {
 public:
  /// Error(input) for settings outside their range, more LEDs than slots under SlotRule::own included.
  VirtualRemote(RemoteSettings settings, std::uint64_t seed, std::string_view name);

  /// When report k is taken, jitter included. Grows with k.
  [[nodiscard]] double report_time(std::uint64_t k) const;
  /// Whether report k never arrives.
  [[nodiscard]] bool lost(std::uint64_t k) const;
  /// Report k, of the situation at its time. Slots remember who held them: call with growing k.
  /// @pre remote and head are somewhere finite, turned by rotations
  [[nodiscard]] SensedReport sense(std::uint64_t k, const Situation& situation);

  [[nodiscard]] const RemoteSettings& settings() const { return settings_; }

 private:
  static constexpr int kNobody = -1;
  struct Spot {
    int source = kNobody;  ///< LED i, or first_lamp() + lamp
    Blob blob;
  };

  [[nodiscard]] int first_lamp() const { return std::max(kLedsMax, static_cast<int>(settings_.leds.size())); }
  [[nodiscard]] bool hidden(const Situation& situation, const Vector3d& p_W) const;
  [[nodiscard]] double led_intensity(std::size_t led, double t, const Situation& situation) const;
  [[nodiscard]] bool image(std::uint64_t k, int source, const Vector3d& p_R, double intensity, Blob& blob) const;
  [[nodiscard]] Vector3d accelerometer(std::uint64_t k, const Situation& situation) const;
  void find_spots(std::uint64_t k, double t, const Situation& situation);
  void assign_slots();
  void write_slots(double t, Channels& channels) const;

  RemoteSettings settings_;
  Pinhole pinhole_;
  RandomStream pixel_;
  RandomStream acceleration_;
  RandomStream jitter_;
  RandomStream loss_;
  std::vector<Spot> spots_;                                                ///< of the current report
  std::array<int, kSlots> holder_ = {kNobody, kNobody, kNobody, kNobody};  ///< source in each slot
};

}  // namespace verisim::wii

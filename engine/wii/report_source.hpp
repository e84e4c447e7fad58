// Reports of a Wii Remote one after another: recorded ones, or those of a virtual remote that watches a head move along
// a trajectory.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/wii/trajectories.hpp"

namespace verisim::wii {

/// A recording as the trackers take it.
struct Recording {
  std::vector<double> t;           ///< s, growing
  std::vector<Channels> channels;  ///< as many
  std::vector<Pose> truth;         ///< X_LH, as many; or empty: unknown
  TrackerSettings settings;        ///< LEDs and field of view
  Pose X_WR;                       ///< where the remote was …
  bool placed = false;             ///< … if that is known
};

class ReportSource {
 public:
  virtual ~ReportSource() = default;
  ReportSource() = default;
  ReportSource(const ReportSource&) = delete;
  ReportSource& operator=(const ReportSource&) = delete;

  /// The next report, its time counted from the first one's; false at the end. X_LH is NaN where it is not known, and
  /// led_in_view is 0 for recorded ones. No allocation after the first call.
  virtual bool next(SensedReport& report) = 0;
  /// What a tracker of these reports may know.
  [[nodiscard]] virtual const TrackerSettings& settings() const = 0;
  [[nodiscard]] virtual double duration() const = 0;  ///< s; 0: without end
};

/// @pre as many channels as times; as many poses, or none
[[nodiscard]] std::unique_ptr<ReportSource> make_recorded_source(Recording recording);

struct VirtualSourceOptions {
  std::string name = "remote";         ///< of the random streams
  std::string trajectory = "natural";  ///< (trajectories.hpp)
  std::string sensor = "wiimote";      ///< (validate.hpp, sensor_cases)
  LedLayout leds = {};                 ///< unless the set-up or the motion names some
  std::uint64_t seed = 1;
  SetUp set_up = {};
  std::optional<Trajectory> motion = {};  ///< recorded, in place of the trajectory
};
/// Goes on for ever, before the last pose of a motion that ends; report 0 is at time 0 (jitter aside). Error(input) for
/// names that are not known, settings that no virtual remote takes.
[[nodiscard]] std::unique_ptr<ReportSource> make_virtual_source(const VirtualSourceOptions& options);

}  // namespace verisim::wii

// Trackers against the virtual Wii Remote: errors, availability, latency, consistency of the covariance, time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/wii/trajectories.hpp"

namespace verisim::wii {

/// A named way for the sensor to be imperfect.
struct SensorCase {
  std::string name;
  std::string what;
  RemoteSettings settings;  ///< its leds, outages and exchanges are replaced by the run's
};
/// ideal, noisy, wiimote, low-sensitivity, low-battery, lamp, accelerometer, 8-bit.
[[nodiscard]] const std::vector<SensorCase>& sensor_cases();
/// Error(input) for a name that is not one of them.
[[nodiscard]] const SensorCase& sensor_case(const std::string& name);

/// Of the valid reports of one run, error = estimate - truth in L.
struct ErrorFigures {
  double rms = 0;                        ///< m, deg
  double p95 = 0;                        ///< m, deg
  double max = 0;                        ///< m, deg
  Vector3d rms_axis = Vector3d::Zero();  ///< m, deg (about x: pitch, y: yaw, z: roll)
};

/// One row of the table.
struct ValidationRow {
  std::string tracker, trajectory, sensor;
  int reports = 0;  ///< that arrived
  int valid = 0;
  ErrorFigures position;      ///< m
  ErrorFigures orientation;   ///< deg
  double availability = 0;    ///< fraction that is valid of reports with two or more LEDs in view, start included
  double false_validity = 0;  ///< fraction that is valid of reports without any LED in view for over 0.1 s
  double latency = 0;         ///< s by which the estimate trails the truth, -sum(e . v) / sum(v . v); 0 without motion
  /// Normalised estimation error squared of the position over its three degrees of freedom: 1 if the covariance is
  /// right, above if it promises too much. Errors repeat from report to report (rounding stands still with the head),
  /// so the chi-square bounds count only as many independent samples as the autocorrelation of the series leaves.
  double nees = 0;
  double nees_lower = 0;        ///< 2.5 % bound of the mean: below it the covariance is larger than the errors need
  double nees_upper = 0;        ///< 97.5 % bound of the mean
  double within_95 = 0;         ///< fraction of errors inside their own 95 % ellipsoid
  bool consistent = false;      ///< nees <= nees_upper: never too sure; of several seeds: with each
  double orientation_nees = 0;  ///< the same of the orientation
  double orientation_nees_lower = 0;  ///< likewise
  double orientation_nees_upper = 0;  ///< likewise
  int reacquired = 0;                 ///< reports that said so
  double longest_return = 0;          ///< s from an LED pair's return to the next valid report, worst
  double update_ns = 0;               ///< wall clock per update, median of blocks; not reproducible
  int seeds = 1;                      ///< figures are means over so many; the largest are the largest of all
  std::pair<double, double> position_rms_95 = {};     ///< m, 95 % interval of its mean over the seeds (Student's t)
  std::pair<double, double> orientation_rms_95 = {};  ///< deg
};
/// What a tracker that states no covariance leaves unknown is NaN: nees, within_95 and their bounds.

struct ValidationOptions {
  std::vector<std::string> trackers;      ///< empty: all that suit (default_trackers)
  std::vector<std::string> trajectories;  ///< empty: all, unless motions are recorded
  std::vector<std::string> sensors;       ///< empty: ideal and wiimote
  Trackers known = wii::trackers();       ///< the table that the names above are looked up in
  std::uint64_t seed = 1;
  int seeds = 1;                     ///< seed, seed + 1, …: rows are their means
  bool start_poses = false;          ///< each seed begins from a pose of its own (from_start_pose)
  SetUp set_up = {};                 ///< of every run
  TrackerSettings tracker;           ///< of every tracker; each adds the LEDs and the second remote that it needs
  std::vector<Trajectory> recorded;  ///< further motions; alone, if no others are named
  bool measure_time = true;
};

/// How far off one report was.
struct ErrorSample {
  double t = 0;  ///< s
  bool valid = false;
  double error = 0;     ///< m, of the position
  double bound_95 = 0;  ///< m: longest half axis of the ellipsoid that should hold 95 % of the errors
};

/// One run of a tracker over its own glasses (TrackerEntry::leds); "NAME/3" is that tracker with the triangle of LEDs.
/// One that needs two remotes gets a second 0.5 m beside the first, turned towards the head.
[[nodiscard]] ValidationRow validate_one(const std::string& tracker, const Trajectory& path, const SensorCase& sensor,
                                         const ValidationOptions& options, std::vector<ErrorSample>* history = nullptr);
/// The mean of one row's figures over several seeds, with intervals. @pre there are two or more, of one combination
[[nodiscard]] ValidationRow mean_of_seeds(const std::vector<ValidationRow>& rows);
/// All trackers of the table, and NAME/3 of those that say so (TrackerEntry).
[[nodiscard]] std::vector<std::string> default_trackers(Trackers known);
/// Whether a tracker can be run over the glasses that the set-up, or else the motion, names: NAME/3 has its own.
[[nodiscard]] bool suits_glasses(const std::string& tracker, const Trajectory& path, const ValidationOptions& options);
/// Every combination, trackers innermost; where no trackers are named, those that suit the glasses: about 1 ms per
/// simulated second each. Error(input) for a name that is not known.
[[nodiscard]] std::vector<ValidationRow> validate(const ValidationOptions& options);

/// The table as text for a terminal, or as CSV with every figure.
[[nodiscard]] std::string table_of(const std::vector<ValidationRow>& rows);
[[nodiscard]] std::string csv_of(const std::vector<ValidationRow>& rows);
/// Per sensor one table in Markdown: a line per trajectory, a column per tracker, each position rms in cm with the
/// availability beside it.
[[nodiscard]] std::string markdown_of(const std::vector<ValidationRow>& rows);

}  // namespace verisim::wii

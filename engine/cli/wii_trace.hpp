// A wii trace as the trackers take it: channels by name, and what its header says of glasses, sensor and place.
#pragma once

#include <string>
#include <vector>

#include "engine/record/trace.hpp"
#include "engine/wii/tracker.hpp"

namespace verisim::cli {

struct WiiSample {
  double t = 0;  ///< s
  wii::Channels channels{};
};

struct WiiRecording {
  std::vector<WiiSample> samples;
  wii::TrackerSettings settings;  ///< LEDs and field of view, from "# leds:" and "# fov_deg:", else the defaults
  Pose X_WR;                      ///< from "# remote_pose:"
  bool placed = false;            ///< the trace says where its remote was
  std::vector<Pose> truth;        ///< X_LH; empty unless the trace knows it
};

/// "t", then the 16 channels by their names in a trace.
[[nodiscard]] std::vector<std::string> wii_trace_columns();
/// What the header of a trace called `name` says of glasses and sensor. Error(input) for a line that does not hold the
/// numbers it should.
[[nodiscard]] wii::TrackerSettings settings_of(const std::string& name, const Trace& trace);
/// A trace that is in memory. Error(input) as settings_of, and for a missing column.
[[nodiscard]] WiiRecording recording_of(const std::string& name, const Trace& trace);
/// Reads a trace file. Error(input) as parse_trace and recording_of.
[[nodiscard]] WiiRecording read_wii_recording(const std::string& file, const TraceLimits& limits);

}  // namespace verisim::cli

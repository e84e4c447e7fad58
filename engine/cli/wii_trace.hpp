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

/// Reads a trace file. Error(input) as parse_trace, and for a header line that does not hold the numbers it should.
[[nodiscard]] WiiRecording read_wii_recording(const std::string& file, const TraceLimits& limits);

}  // namespace verisim::cli

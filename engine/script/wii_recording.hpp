// A wii trace as the trackers take it: channels by name, and what its header says of glasses, sensor and place.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/record/trace.hpp"
#include "engine/simulation/inputs.hpp"
#include "engine/wii/report_source.hpp"

namespace verisim {

/// "t", then the 16 channels by their names in a trace.
[[nodiscard]] std::vector<std::string> wii_trace_columns();
/// What header lines of a file called `name` ("leds", "fov_deg", "remote_pose") say of a set-up. Error(input) for a
/// line that does not hold the numbers it should.
[[nodiscard]] wii::SetUp wii_set_up_of(const std::string& name, const std::map<std::string, std::string>& header);
/// The other way round, as a trace's header has them.
[[nodiscard]] std::map<std::string, std::string> wii_header_of(const wii::SetUp& set_up);
/// What the header of a trace called `name` says of glasses and sensor ("# leds:", "# fov_deg:"), else the defaults.
/// Error(input) for a line that does not hold the numbers it should.
[[nodiscard]] wii::TrackerSettings wii_settings_of(const std::string& name, const Trace& trace);
/// The poses of a trace of any kind, columns px … qw; none without all of these columns.
[[nodiscard]] std::vector<Pose> trace_poses(const Trace& trace);
/// Channels, true poses if there are columns px … qw, and "# remote_pose:". Error(input) as wii_settings_of, and for a
/// missing column.
[[nodiscard]] wii::Recording wii_recording_of(const std::string& name, const Trace& trace);
/// Reads a trace file. Error(input) as parse_trace and wii_recording_of.
[[nodiscard]] wii::Recording read_wii_recording(Inputs& inputs, const std::string& name, const TraceLimits& limits);

}  // namespace verisim

// Plays the virtual remote over VRPN and hears what a tracker elsewhere makes of it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/vrpn/connection.hpp"
#include "engine/vrpn/socket.hpp"
#include "engine/wii/tracker.hpp"
#include "engine/wii/virtual_remote.hpp"

namespace verisim::cli {

struct WireOptions {
  std::string analog = "WiiMote0";
  std::string host = "127.0.0.1";
  std::uint16_t port = vrpn::kDefaultPort;
  bool no_udp = false;

  /// --channels, --serve-host, --serve-port, --no-udp.
  void add(CLI::App& command);
};

/// A tracker's poses as they come over VRPN: those of sensor 0, their times counted from the begin. VRPN tells no
/// validity: a pose is valid; nor a covariance: it is NaN. Of poses with equal times the last one counts.
class HeardPoses {
 public:
  void begin(vrpn::Timestamp t) { begin_ = t; }  ///< else the first pose's time
  void take(const vrpn::Received& message);      ///< anything but poses is passed over
  [[nodiscard]] const std::vector<wii::Report>& reports() const { return reports_; }
  [[nodiscard]] int count_left_out() const { return of_others_ + not_finite_ + overtaken_; }
  [[nodiscard]] std::string left_out() const;  ///< how many, and why; empty if none

 private:
  std::optional<vrpn::Timestamp> begin_;
  std::vector<wii::Report> reports_;
  int of_others_ = 0, not_finite_ = 0, overtaken_ = 0;
};

/// Serves the samples' channels at their own pace once the other side has connected to them and its tracker answers;
/// takes the tracker's poses (HeardPoses), their times counted from the begin of the samples. How many were left out,
/// and why, is said on stderr, like progress. Error(io) if the other side does not come in time, Error(interrupted).
[[nodiscard]] std::vector<wii::Report> hear_tracker(const std::string& remote_name, const WireOptions& options,
                                                    double patience_s, const std::vector<wii::SensedReport>& samples);

}  // namespace verisim::cli

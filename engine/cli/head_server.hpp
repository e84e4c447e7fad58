// A head tracker and the channels that feed it, as two VRPN devices: a tracker and an analog of 16 channels.
#pragma once

#include <string>

#include "engine/vrpn/server.hpp"
#include "engine/wii/virtual_remote.hpp"

namespace verisim::cli {

struct HeadDevices {
  std::string tracker = "Tracker0";
  std::string analog = "WiiMote0";
  std::string truth;  ///< a second tracker with the true poses; empty: none
};

class HeadServer {
 public:
  /// Error(io) if the port is taken, Error(usage) for a name that cannot travel.
  HeadServer(const vrpn::Address& at, HeadDevices devices);

  /// Sends the channels, and the pose if the report is valid and new. VRPN cannot mark a pose as invalid, so an invalid
  /// pose is not sent, and a heartbeat is never mistaken for data.
  /// The true pose goes to the device `truth`, if there is one.
  void publish(vrpn::Timestamp time, const wii::SensedReport& sensed, const wii::Report& report);

  [[nodiscard]] vrpn::Server& server() { return server_; }

 private:
  void publish_pose(const std::string& device, vrpn::Timestamp time, const Pose& pose);

  HeadDevices devices_;
  vrpn::Server server_;
};

}  // namespace verisim::cli

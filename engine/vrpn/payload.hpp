// Payloads of messages: names, poses, analog channels, texts (reference/vrpn_wire, "System messages", "Tracker",
// "Analog", "Text"). Decoders return nothing for a malformed payload. Pure functions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "engine/vrpn/bytes.hpp"

namespace verisim::vrpn {

inline constexpr std::size_t kNameMax = 95;       ///< bytes of a sender's or type's name
inline constexpr std::size_t kChannelsMax = 128;  ///< of one analog device
inline constexpr std::size_t kTextMax = 1023;

/// Names of the types used here. Each side has its own numbers for them.
inline constexpr std::string_view kPing = "vrpn_Base ping_message";
inline constexpr std::string_view kPong = "vrpn_Base pong_message";
inline constexpr std::string_view kText = "vrpn_Base text_message";
inline constexpr std::string_view kPose = "vrpn_Tracker Pos_Quat";
inline constexpr std::string_view kToRoom = "vrpn_Tracker To_Room";
inline constexpr std::string_view kUnitToSensor = "vrpn_Tracker Unit_To_Sensor";
inline constexpr std::string_view kWorkspace = "vrpn_Tracker Workspace";
inline constexpr std::string_view kRequestToRoom = "vrpn_Tracker Request_Tracker_To_Room";
inline constexpr std::string_view kRequestUnitToSensor = "vrpn_Tracker Request_Unit_To_Sensor";
inline constexpr std::string_view kRequestWorkspace = "vrpn_Tracker Request_Tracker_Workspace";
inline constexpr std::string_view kAnalog = "vrpn_Analog Channel";

/// Can it be described: 1 to kNameMax bytes, no NUL?
[[nodiscard]] bool is_name(std::string_view name);
/// A sender's or type's description: the name's length with its NUL, the name, NUL. @pre is_name(name)
[[nodiscard]] Bytes encode_name(std::string_view name);
[[nodiscard]] std::optional<std::string_view> decode_name(View payload);

struct Placement {
  std::array<double, 3> position{};               ///< m
  std::array<double, 4> rotation = {0, 0, 0, 1};  ///< x, y, z, w
};
/// A sensor in its tracker's coordinates: kPose and kUnitToSensor.
struct SensorPose {
  std::int32_t sensor = 0;  ///< from 0
  Placement placement;
};
[[nodiscard]] Bytes encode(const SensorPose& pose);  ///< @pre pose.sensor >= 0
/// Surplus bytes are ignored; the numbers may be anything.
[[nodiscard]] std::optional<SensorPose> decode_pose(View payload);

/// kToRoom.
[[nodiscard]] Bytes encode(const Placement& placement);
/// kWorkspace: the corners of a box [m].
[[nodiscard]] Bytes encode_box(const std::array<double, 3>& low, const std::array<double, 3>& high);

/// kAnalog: all channels of a device.
struct Analog {
  std::array<double, kChannelsMax> values{};
  std::size_t count = 0;
  [[nodiscard]] std::span<const double> channels() const { return std::span(values).first(count); }
};
/// @pre at most kChannelsMax
[[nodiscard]] Bytes encode_analog(std::span<const double> channels);
/// The number of channels is the payload's first number, which must be whole. Surplus bytes are ignored.
[[nodiscard]] std::optional<Analog> decode_analog(View payload);

/// kText.
struct Text {
  std::uint32_t severity = 0;  ///< 0 normal, 1 warning, 2 error
  std::uint32_t level = 0;
  std::string text;  ///< printable ASCII; other received characters become question marks
};
[[nodiscard]] std::optional<Text> decode_text(View payload);

/// The datagram by which a client asks for a connection: host, blank, port, NUL.
struct ConnectionRequest {
  std::string host;
  std::uint16_t port = 0;  ///< 1024 or above
};
[[nodiscard]] Bytes encode(const ConnectionRequest& request);  ///< @pre a host is named
/// As in stock VRPN: a host of letters, digits and dots, white space, an integer; text after it is ignored.
[[nodiscard]] std::optional<ConnectionRequest> decode_request(View datagram);

}  // namespace verisim::vrpn

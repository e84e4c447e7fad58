#include "engine/vrpn/payload.hpp"

#include <algorithm>
#include <charconv>

#include "engine/base/error.hpp"

namespace verisim::vrpn {
namespace {

constexpr int kPortMin = 1024;  // stock refuses to connect to lower ones
constexpr int kPortMax = 65535;
constexpr std::size_t kRequestMax = 199;

void put_placement(Bytes& out, const Placement& placement) {
  for (const double x : placement.position) put_float64(out, x);
  for (const double x : placement.rotation) put_float64(out, x);
}

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

bool is_host_character(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
}

}  // namespace

bool is_name(std::string_view name) {
  return !name.empty() && name.size() <= kNameMax && name.find('\0') == std::string_view::npos;
}

Bytes encode_name(std::string_view name) {
  VERISIM_ASSERT(is_name(name));
  Bytes payload;
  put_uint32(payload, static_cast<std::uint32_t>(name.size() + 1));
  put_text(payload, name);
  return payload;
}

std::optional<std::string_view> decode_name(View payload) {
  Reader reader(payload);
  const std::uint32_t length = reader.uint32();
  const View characters = reader.rest();
  if (!reader.ok() || length == 0 || length > kNameMax + 1 || characters.size() != length) return {};
  const std::string_view name = text_before_nul(characters);
  if (name.size() + 1 != length) return {};
  return name;
}

Bytes encode(const SensorPose& pose) {
  VERISIM_ASSERT(pose.sensor >= 0);
  Bytes payload;
  put_int32(payload, pose.sensor);
  put_int32(payload, 0);
  put_placement(payload, pose.placement);
  return payload;
}

std::optional<SensorPose> decode_pose(View payload) {
  Reader reader(payload);
  SensorPose pose;
  pose.sensor = static_cast<std::int32_t>(reader.uint32());
  (void)reader.uint32();  // to the alignment of a double
  for (double& x : pose.placement.position) x = reader.float64();
  for (double& x : pose.placement.rotation) x = reader.float64();
  if (!reader.ok()) return {};
  return pose;
}

Bytes encode(const Placement& placement) {
  Bytes payload;
  put_placement(payload, placement);
  return payload;
}

Bytes encode_box(const std::array<double, 3>& low, const std::array<double, 3>& high) {
  Bytes payload;
  for (const double x : low) put_float64(payload, x);
  for (const double x : high) put_float64(payload, x);
  return payload;
}

Bytes encode_analog(std::span<const double> channels) {
  VERISIM_ASSERT(channels.size() <= kChannelsMax);
  Bytes payload;
  put_float64(payload, static_cast<double>(channels.size()));
  for (const double x : channels) put_float64(payload, x);
  return payload;
}

std::optional<Analog> decode_analog(View payload) {
  Reader reader(payload);
  Analog analog;
  const double count = reader.float64();
  if (!reader.ok() || !(count >= 0 && count <= kChannelsMax)) return {};
  analog.count = static_cast<std::size_t>(count);
  if (static_cast<double>(analog.count) != count) return {};
  for (double& x : std::span(analog.values).first(analog.count)) x = reader.float64();
  if (!reader.ok()) return {};
  return analog;
}

std::optional<Text> decode_text(View payload) {
  Reader reader(payload);
  Text text;
  text.severity = reader.uint32();
  text.level = reader.uint32();
  if (!reader.ok()) return {};
  text.text = text_before_nul(reader.rest()).substr(0, kTextMax);
  std::replace_if(
      text.text.begin(), text.text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

Bytes encode(const ConnectionRequest& request) {
  VERISIM_ASSERT(!request.host.empty());
  Bytes datagram;
  put_text(datagram, fmt::format("{} {}", request.host, request.port));
  return datagram;
}

std::optional<ConnectionRequest> decode_request(View datagram) {
  const std::string_view text = text_before_nul(datagram);
  if (text.size() > kRequestMax) return {};
  const auto host_end = std::find_if_not(text.begin(), text.end(), is_host_character);
  const auto port_begin = std::find_if_not(host_end, text.end(), is_blank);
  if (host_end == text.begin() || port_begin == host_end) return {};
  int port = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(end - (text.end() - port_begin), end, port);
  if (parsed.ec != std::errc() || port < kPortMin || port > kPortMax) return {};
  return ConnectionRequest{std::string(text.begin(), host_end), static_cast<std::uint16_t>(port)};
}

}  // namespace verisim::vrpn

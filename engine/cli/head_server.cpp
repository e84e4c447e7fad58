#include "engine/cli/head_server.hpp"

#include "engine/base/error.hpp"
#include "engine/vrpn/payload.hpp"
#include "engine/wii/admission.hpp"

namespace verisim::cli {
namespace {

std::string checked_name(const std::string& name) {
  if (name.empty() || name.size() > vrpn::kNameMax || name.find('@') != std::string::npos)
    fail(ErrorKind::usage, "device name '{}': must have 1 to {} characters, none of them @", name, vrpn::kNameMax);
  return name;
}

/// Error(usage) for two devices of one name, too.
std::vector<std::string> names_of(const HeadDevices& devices) {
  std::vector<std::string> names = {checked_name(devices.tracker), checked_name(devices.analog)};
  if (!devices.truth.empty()) names.push_back(checked_name(devices.truth));
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (names[i] == names[j])
        fail(ErrorKind::usage, "device name '{}': is given to two devices; rename one", names[i]);
  return names;
}

/// Levelled coordinates are the room's; the sensor is the head itself; it may be wherever a report can be.
void answer(const vrpn::Received& request, const vrpn::Server::Reply& reply) {
  constexpr double kReach = wii::kDistanceMax;
  if (request.type == vrpn::kRequestToRoom) reply(vrpn::kToRoom, vrpn::encode(vrpn::Placement{}));
  if (request.type == vrpn::kRequestUnitToSensor) reply(vrpn::kUnitToSensor, vrpn::encode(vrpn::SensorPose{}));
  if (request.type == vrpn::kRequestWorkspace)
    reply(vrpn::kWorkspace, vrpn::encode_box({-kReach, -kReach, 0}, {kReach, kReach, kReach}));
}

}  // namespace

HeadServer::HeadServer(const vrpn::Address& at, HeadDevices devices)
    : devices_(std::move(devices)),
      server_(at, names_of(devices_),
              {std::string(vrpn::kPose), std::string(vrpn::kAnalog), std::string(vrpn::kToRoom),
               std::string(vrpn::kUnitToSensor), std::string(vrpn::kWorkspace)}) {
  server_.on_request([this](const vrpn::Received& request, const vrpn::Server::Reply& reply) {
    if (request.sender != devices_.analog) answer(request, reply);
  });
}

void HeadServer::publish(vrpn::Timestamp time, const wii::SensedReport& sensed, const wii::Report& report) {
  server_.publish(devices_.analog, vrpn::kAnalog, time, vrpn::encode_analog(sensed.channels));
  if (!devices_.truth.empty()) publish_pose(devices_.truth, time, sensed.X_LH);
  if (report.valid && report.news) publish_pose(devices_.tracker, time, report.pose);
}

void HeadServer::publish_pose(const std::string& device, vrpn::Timestamp time, const Pose& pose) {
  const Vector3d& p = pose.position;
  const auto& q = pose.rotation.coeffs();
  const vrpn::SensorPose sensor{0, {{p.x(), p.y(), p.z()}, {q[0], q[1], q[2], q[3]}}};
  server_.publish(device, vrpn::kPose, time, vrpn::encode(sensor));
}

}  // namespace verisim::cli
